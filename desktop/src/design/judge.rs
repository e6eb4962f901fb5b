//! The worst margin of a loop over the box that a joint may lie in.

use super::corners::Corner;
use super::loops::{Break, Loop, frequencies};
use super::margins::margins;
use super::mode::Mode;
use super::parts::Parts;
use super::plant::Plant;
use super::poles;
use super::response::{Answer, Response};
use super::variant::Variant;
use crate::io::gear_file::GearFile;
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// A margin where it is worst.
#[derive(Clone, Copy, Debug)]
pub struct Worst {
    /// The least margin, or the largest |L|.
    pub value: f64,
    /// Variant and corner of the worst case.
    pub at: Option<(Variant, Corner)>,
}

impl Worst {
    const fn from(value: f64) -> Self {
        Self { value, at: None }
    }

    fn least(&mut self, value: f64, at: (Variant, Corner)) {
        if value < self.value {
            *self = Self { value, at: Some(at) };
        }
    }

    fn largest(&mut self, value: f64, at: (Variant, Corner)) {
        if value > self.value {
            *self = Self { value, at: Some(at) };
        }
    }
}

/// Margins of one loop over the box.
#[derive(Clone, Copy, Debug)]
pub struct Judged {
    /// Which.
    pub of: Loop,
    /// (dB)
    pub gain: Worst,
    /// (degrees)
    pub phase: Worst,
    /// Beyond the corner's own delay (control periods).
    pub delay: Worst,
    /// Largest |L|.
    pub size: Worst,
}

impl Judged {
    fn new(of: Loop) -> Self {
        Self {
            of,
            gain: Worst::from(f64::INFINITY),
            phase: Worst::from(180.0),
            delay: Worst::from(f64::INFINITY),
            size: Worst::from(0.0),
        }
    }
}

/// Controllers' answers at the frequencies, once for all corners.
struct Answers {
    variant: Variant,
    of: Loop,
    at: Vec<Answer>,
}

fn answers(file: &GearFile, parts: &Parts, loops: &[Loop], omegas: &[f64]) -> Vec<Answers> {
    let mut answers = Vec::new();
    for of in loops {
        for variant in Variant::all(of.set, of.passes) {
            let open = of.broken == Break::Disturbance;
            let response = Response::new(&variant.controller(file, parts), open);
            answers.push(Answers { variant, of: *of, at: omegas.iter().map(|w| response.at(*w)).collect() });
        }
    }
    answers
}

/// Margins of some loops over every `each`-th corner of the box; `progress` is called with the fraction done.
pub fn judge(
    file: &GearFile,
    parts: &Parts,
    loops: &[Loop],
    each: usize,
    mut progress: impl FnMut(f64),
) -> Vec<Judged> {
    let omegas = frequencies();
    let answers = answers(file, parts, loops, &omegas);
    let mut judged: Vec<_> = loops.iter().map(|of| Judged::new(*of)).collect();
    let corners: Vec<_> = all_corners(file, each).collect();
    for (done, (mode, corner)) in corners.iter().enumerate() {
        let plant = Plant::new(file, corner);
        let p: Vec<_> = omegas.iter().map(|w| plant.at(*w)).collect();
        let here = |a: &&Answers| a.variant.mode == *mode && a.variant.point == corner.point;
        for answer in answers.iter().filter(here) {
            let points: Vec<_> = omegas
                .iter()
                .zip(answer.at.iter().zip(&p))
                .map(|(w, (c, p))| (*w, answer.of.open(c, p)))
                .collect();
            let (at, found) = ((answer.variant, *corner), margins(&points));
            for mine in judged.iter_mut().filter(|j| j.of == answer.of) {
                mine.gain.least(found.gain, at);
                mine.phase.least(found.phase.to_degrees(), at);
                mine.delay.least(found.delay / CONTROL_PERIOD, at);
                mine.size.largest(found.size, at);
            }
        }
        progress(done as f64 / corners.len() as f64);
    }
    judged
}

/// Every `each`-th corner of both modes.
fn all_corners(file: &GearFile, each: usize) -> impl Iterator<Item = (Mode, Corner)> {
    let of = move |mode| Corner::all(file, mode).into_iter().step_by(each).map(move |corner| (mode, corner));
    Mode::ALL.into_iter().flat_map(of)
}

/// A closed loop that is not stable.
#[derive(Clone, Copy, Debug)]
pub struct Unstable {
    /// Which.
    pub variant: Variant,
    /// Corner.
    pub corner: Corner,
    /// Growth rate (1/s); unknown where its poles are not found.
    pub growth: Option<f64>,
}

/// Corners in which the closed loop is not stable by its poles, of every `each`-th.
pub fn unstable(
    file: &GearFile,
    parts: &Parts,
    loops: &[Loop],
    each: usize,
    mut progress: impl FnMut(f64),
) -> Vec<Unstable> {
    let corners: Vec<_> = all_corners(file, each).collect();
    let mut found = Vec::new();
    for (done, (mode, corner)) in corners.iter().enumerate() {
        for of in loops.iter().filter(|of| of.broken == Break::Torque) {
            let variant = Variant { set: of.set, mode: *mode, point: corner.point, passes: of.passes };
            let closed = poles::eigenvalues(&variant.controller(file, parts), &Plant::new(file, corner));
            if closed.as_deref().is_none_or(|all| !poles::is_stable(all)) {
                found.push(Unstable {
                    variant,
                    corner: *corner,
                    growth: closed.as_deref().map(poles::growth),
                });
            }
        }
        progress(done as f64 / corners.len() as f64);
    }
    found
}
