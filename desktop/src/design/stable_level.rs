//! The largest fraction of a gain with which a joint is stable in corners of its box.
//!
//! The corners are those in which the motor's acceleration by a torque is the farthest from the file's, with the slowest drive, without
//! a mode behind the flange or with one. Stable is the whole loop, by its poles ([`poles`]), with the observer's gains of a motor that moves; the
//! disturbance path's dead zone passes nothing. What is unstable without the gain too is none of its doing.

use super::corners::Corner;
use super::mode::Mode;
use super::parts::Parts;
use super::plant::Plant;
use super::poles;
use super::variant::Variant;
use crate::io::gear_file::{GearFile, SensorSet};

/// Growth of the error (1/s) that counts as none: an integrator of the observer that drifts, and rounding.
pub(super) const NONE: f64 = 1.0;
/// Halvings of the range in which the level lies.
const HALVINGS: u32 = 5;

/// The corners of a joint, and a plant for each.
pub(super) struct Corners<'a> {
    file: &'a GearFile,
    plants: Vec<(Corner, Plant)>,
}

impl<'a> Corners<'a> {
    /// Without a mode behind the flange, with friction that slides, or is a spring of so much of the file's presliding distance.
    pub(super) fn of(file: &'a GearFile, presliding: Option<f64>) -> Self {
        let rigid = farthest(file).filter(|corner| corner.link.is_none());
        Self::at(file, rigid.map(|corner| Corner { presliding, ..corner }))
    }

    /// With a mode behind the flange, and friction that slides.
    pub(super) fn linked(file: &'a GearFile) -> Self {
        Self::at(file, farthest(file).filter(|corner| corner.link.is_some()))
    }

    fn at(file: &'a GearFile, corners: impl Iterator<Item = Corner>) -> Self {
        Self { file, plants: corners.map(|corner| (corner, Plant::new(file, &corner))).collect() }
    }

    /// Growth of the closed loop's fastest mode (1/s) with these sensors, in each of the corners.
    fn each(&self, set: SensorSet, parts: &Parts) -> impl Iterator<Item = f64> {
        self.plants.iter().map(move |(corner, plant)| {
            let variant = Variant { set, mode: Mode::Moving, point: corner.point, passes: false };
            let found = poles::eigenvalues(&variant.controller(self.file, parts), plant);
            found.map_or(f64::INFINITY, |all| poles::growth(&all))
        })
    }

    /// The same in the worst corner.
    pub(super) fn growth(&self, set: SensorSet, parts: &Parts) -> f64 {
        self.each(set, parts).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Largest factor on the gain, at most `most`, with which every corner is stable; `scaled` has the parts with the gain times a factor.
    pub(super) fn level(&self, set: SensorSet, most: f64, scaled: impl Fn(f64) -> Parts) -> f64 {
        // Stops at the first corner that grows faster.
        let bears = |factor: f64, growth: f64| self.each(set, &scaled(factor)).all(|found| found <= growth);
        if bears(most, NONE) {
            return most;
        }
        let without = self.growth(set, &scaled(0.0)).max(0.0) + NONE;
        if bears(most, without) {
            return most;
        }
        let [mut least, mut most] = [0.0, most];
        for _ in 0..HALVINGS {
            let middle = 0.5 * (least + most);
            *(if bears(middle, without) { &mut least } else { &mut most }) = middle;
        }
        least
    }
}

/// Those in which the motor's acceleration by a torque is the farthest from the file's, with the slowest drive.
fn farthest(file: &GearFile) -> impl Iterator<Item = Corner> {
    let (delay, bandwidth) = (file.drive.delay as usize, file.drive.least_current_loop);
    Corner::all(file, Mode::Moving).into_iter().filter(move |corner| {
        (corner.rotor - 1.0) * (corner.constant - 1.0) <= 0.0
            && (corner.delay, corner.bandwidth) == (delay, bandwidth)
    })
}

/// With the feedback of the measured angle of a joint at rest, whose motor the observer takes for one that moves.
pub(super) fn resting(parts: &Parts) -> Parts {
    let mut resting = *parts;
    let gains = &mut resting.measured_feedback;
    (gains.proportional, gains.derivative) = (gains.proportional_at_rest, gains.derivative_at_rest);
    resting
}
