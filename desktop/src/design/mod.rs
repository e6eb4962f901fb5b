//! From the joint file to gains that have margins: the loops that the controller closes, linear, over the box that a joint
//! may lie in.
//!
//! ```text
//! torque loop        broken at the motor's torque command:  L = -C_u P            u = C_u y,  y = P u
//! disturbance loop   broken at the observer's d:            L = -(C_dy P*S*C_ud + C_dd),  S = 1/(1 - C_uy P)
//! ```
//!
//! P is the joint ([`plant`]) in a corner of the box ([`corners`]), C the controller slot by slot ([`controller`]) as its
//! fundamental answers a sine ([`response`]). Where the plant is the model the observer sees nothing of what the motor does,
//! and the second L is 0; what is left of it is T*Delta, T what the path makes of a load and Delta what of it comes back by
//! what is not known of stiffness, torque constant, rotor, load and drive. |T| < 1/|Delta| is |L| < 1.
//!
//! Each loop has margins ([`margins`]) for either set of sensors, with the gains of a motor that moves and of one that
//! stands, the disturbance path passing everything or (within its dead zone) nothing. Margins say how far a stable loop is
//! from an unstable one; that it is stable the poles say ([`poles`]). The delay margin is beyond what is declared: the
//! corner's own delay counts in it.
//!
//! A function that cannot be given the margins is scaled down to the largest level that has them, or to none
//! ([`levels()`]). Where the joint without these functions misses a bound already, they must not make it worse.
//!
//! K. Zhou, J. Doyle, K. Glover, "Robust and optimal control" (1996), chapter 9 (small gain).

pub mod controller;
pub mod corners;
pub mod levels;
pub mod margins;
pub mod plant;
pub mod poles;
pub mod report;
pub mod response;
pub mod sweep;

pub use levels::{Levels, levels};

use nalgebra::Complex;
use strainwave::Error;

use crate::bench::SensorSet;
use crate::gear_file::GearFile;
use crate::joint::{CONTROL_PERIOD, feedback_params};
use crate::{compensation, observer_design};
use controller::{Controller, Parts};
use corners::{Corner, Point};
use margins::{Margins, margins};
use plant::Plant;
use response::{Answer, Response};

type C64 = Complex<f64>;

/// Which gains the observer has, and with them which friction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// The motor moves, friction slides.
    Moving,
    /// It stands, friction is a spring.
    Standing,
}

impl Mode {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Moving, Self::Standing];
}

/// A controller at one operating point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Variant {
    /// What it reads.
    pub set: SensorSet,
    /// Its gains.
    pub mode: Mode,
    /// Where on the line.
    pub point: Point,
    /// The disturbance path passes everything, or nothing.
    pub passes: bool,
}

impl Variant {
    fn all(set: SensorSet) -> Vec<Self> {
        let mut all = Vec::new();
        for mode in Mode::ALL {
            for point in Point::ALL {
                all.extend([false, true].map(|passes| Self { set, mode, point, passes }));
            }
        }
        all
    }
}

/// Which loop is broken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Break {
    /// At the motor's torque command.
    Torque,
    /// At the observer's d, where the disturbance path reads it.
    Disturbance,
}

impl Break {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Torque, Self::Disturbance];

    /// As in a figure's name.
    pub fn name(self) -> &'static str {
        ["torque", "disturbance"][self as usize]
    }
}

/// What is judged: the loops, with a disturbance path that passes everything or nothing.
pub const LOOPS: [(Break, bool); 3] =
    [(Break::Torque, false), (Break::Torque, true), (Break::Disturbance, true)];

/// Frequencies (rad/s): 200 a decade where the modes of joint and load are, fewer elsewhere.
pub fn frequencies() -> Vec<f64> {
    let decades = |from: f64, to: f64, each: f64| {
        let count = ((to / from).log10() * each).round();
        (0..count as usize).map(move |k| from * (to / from).powf(k as f64 / count))
    };
    let nyquist = std::f64::consts::PI / CONTROL_PERIOD;
    decades(0.1, 10.0, 20.0)
        .chain(decades(10.0, 3000.0, 200.0))
        .chain(decades(3000.0, nyquist, 40.0))
        .collect()
}

/// All that the linear controllers of a joint are made of.
///
/// # Errors
/// As [`observer_design::observer_params`].
pub fn parts(file: &GearFile, levels: &Levels) -> Result<Parts, Error> {
    Ok(Parts { observer: observer_design::observer_params(file)?, ..Parts::without_observer(file, levels) })
}

impl Parts {
    fn without_observer(file: &GearFile, levels: &Levels) -> Self {
        Self {
            observer: strainwave::compensator::estimate::observer::ObserverParams {
                moving: Default::default(),
                standing: Default::default(),
                stir: 0.0,
                output_encoder_delay: 0,
                output_encoder_period: 1,
                output_count: 0.0,
                uncertainty: strainwave::compensator::estimate::observer::deviation::Uncertainty {
                    friction: 0.0,
                    stiffness: 0.0,
                    inertia: 0.0,
                },
            },
            feedback: feedback_params(file),
            disturbance: compensation::disturbance_params_at(file, levels),
            output_feedback: compensation::output_feedback_params_at(file, levels),
        }
    }

    /// The same with other levels.
    #[must_use]
    pub fn at(&self, file: &GearFile, levels: &Levels) -> Self {
        Self { observer: self.observer, ..Self::without_observer(file, levels) }
    }
}

/// -C P.
fn torque_loop(c: &Answer, p: &[C64; plant::OUTPUTS]) -> C64 {
    -(0..4).map(|k| c[0][k] * p[k]).sum::<C64>()
}

/// What of d_in comes back as d.
fn disturbance_loop(c: &Answer, p: &[C64; plant::OUTPUTS]) -> C64 {
    let torque = c[0][4] / (1.0 + torque_loop(c, p));
    -(c[1][4] + torque * (0..4).map(|k| c[1][k] * p[k]).sum::<C64>())
}

/// One margin at its worst.
#[derive(Clone, Debug)]
pub struct Worst {
    /// The least margin, the largest |L| of `size`.
    pub value: f64,
    /// Where.
    pub at: Option<(Variant, Corner)>,
}

/// Margins of one loop and set over the box.
#[derive(Clone, Debug)]
pub struct Judged {
    /// Sensors.
    pub set: SensorSet,
    /// Loop.
    pub broken: Break,
    /// The disturbance path passes everything, or nothing.
    pub passes: bool,
    /// (dB)
    pub gain: Worst,
    /// (dB)
    pub gain_down: Worst,
    /// (degrees)
    pub phase: Worst,
    /// Beyond the declared delay (control periods).
    pub delay: Worst,
    /// Least |1 + L|.
    pub modulus: Worst,
    /// Largest |L|.
    pub size: Worst,
}

impl Judged {
    fn new(set: SensorSet, broken: Break, passes: bool) -> Self {
        let worst = |value| Worst { value, at: None };
        let most = worst(f64::INFINITY);
        Self {
            set,
            broken,
            passes,
            gain: most.clone(),
            gain_down: most.clone(),
            phase: worst(180.0),
            delay: most.clone(),
            modulus: most,
            size: worst(0.0),
        }
    }

    fn add(&mut self, m: &Margins, size: f64, variant: Variant, corner: &Corner) {
        let at = Some((variant, *corner));
        let least = |worst: &mut Worst, value: f64| {
            if value < worst.value {
                *worst = Worst { value, at };
            }
        };
        least(&mut self.gain, m.gain);
        least(&mut self.gain_down, m.gain_down);
        least(&mut self.phase, m.phase.to_degrees());
        least(&mut self.delay, m.delay / CONTROL_PERIOD + corner.delay as f64);
        least(&mut self.modulus, m.modulus);
        if size > self.size.value {
            self.size = Worst { value: size, at };
        }
    }
}

/// Frequencies and the controllers' answers at them.
struct Answers {
    frequencies: Vec<f64>,
    variants: Vec<(Variant, Vec<Answer>, Option<Vec<Answer>>)>,
}

fn answers(file: &GearFile, parts: &Parts, sets: &[SensorSet]) -> Answers {
    let frequencies = frequencies();
    let mut variants = Vec::new();
    for variant in sets.iter().flat_map(|set| Variant::all(*set)) {
        let of = |open| {
            let response = Response::new(&variant.controller(file, parts), open);
            frequencies.iter().map(|w| response.at(*w)).collect::<Vec<_>>()
        };
        let open = if variant.passes { Some(of(true)) } else { None };
        variants.push((variant, of(false), open));
    }
    Answers { frequencies, variants }
}

impl Variant {
    /// The controller.
    pub fn controller(&self, file: &GearFile, parts: &Parts) -> Controller {
        Controller::new(file, parts, self.set, self.mode, self.point.stiffness(file), self.passes)
    }
}

/// Margins of every loop over some corners of each mode; every `each`-th of them.
pub fn judge(file: &GearFile, parts: &Parts, sets: &[SensorSet], each: usize) -> Vec<Judged> {
    let answers = answers(file, parts, sets);
    let omegas = &answers.frequencies;
    let mut judged: Vec<Judged> =
        sets.iter().flat_map(|set| LOOPS.map(|(broken, passes)| Judged::new(*set, broken, passes))).collect();
    for mode in Mode::ALL {
        for corner in Corner::all(mode).iter().step_by(each) {
            let plant = Plant::new(file, corner);
            let p: Vec<_> = omegas.iter().map(|w| plant.at(*w)).collect();
            let there = |v: &Variant| v.mode == mode && v.point == corner.point;
            for (variant, closed, open) in answers.variants.iter().filter(|(v, ..)| there(v)) {
                let mut add = |broken, answers: &[Answer], of: fn(&Answer, &[C64; 4]) -> C64| {
                    let each = omegas.iter().zip(answers.iter().zip(&p));
                    let points: Vec<_> = each.map(|(w, (c, p))| (*w, of(c, p))).collect();
                    let size = points.iter().map(|(_, l)| l.norm()).fold(0.0, f64::max);
                    let mine = judged
                        .iter_mut()
                        .find(|j| (j.set, j.broken, j.passes) == (variant.set, broken, variant.passes));
                    if let Some(mine) = mine {
                        mine.add(&margins(&points), size, *variant, corner);
                    }
                };
                add(Break::Torque, closed, torque_loop);
                if let Some(open) = open {
                    add(Break::Disturbance, open, disturbance_loop);
                }
            }
        }
    }
    judged
}

/// L of the torque loop of one variant in one corner at w (rad/s).
pub fn open_loop(
    file: &GearFile,
    parts: &Parts,
    variant: Variant,
    corner: &Corner,
    omegas: &[f64],
) -> Vec<C64> {
    let response = Response::new(&variant.controller(file, parts), false);
    let plant = Plant::new(file, corner);
    omegas.iter().map(|w| torque_loop(&response.at(*w), &plant.at(*w))).collect()
}
