//! Sensitivity of the joints to each tuned constant ([`crate::design::tuned`]): halved, and doubled.
//!
//! Joints: the default gear with either set of sensors, and training joints of the catalogue, half of them with an output
//! encoder, each in the order of their seeds. Never a joint that claims are judged on. Every joint runs S1 to S5 as in
//! [`super::catalogue`], first with every constant as it is, then with one of them scaled at a time, rebuilt from its gear file; the
//! baselines run once, as they are. Of each constant and factor:
//!
//! | figure | definition |
//! | --- | --- |
//! | `shake`, `worse` | runs as in [`super::catalogue`] |
//! | `stop` | runs that diverge, or end with the drive off by a fault, and do neither with the constant as it is |
//! | `refused` | joints that cannot be built: their parameters are out of range; their runs count for nothing else |
//! | `error` | rms output error of a run over that with the constant as it is, median |
//! | `farthest` | the same of the run in which it is farthest from 1, by its logarithm |
//!
//! A constant of the plant's sensors or of a baseline is none of these: only the compensator is built again.

mod summary;

use strainwave::Error;
use strainwave::compensator::tuned::Tuned;

use crate::catalogue::{Joint, Set};
use crate::io::gear_file::GearFile;
use crate::io::gear_file::SensorSet;
use crate::plant::unknowns::Which;
use crate::verify::catalogue::Outcome;
use crate::verify::compensator::each;
pub use summary::Report;

/// Training joints when nothing else is said.
pub const SEEDS: u64 = 24;
/// Most training joints.
pub const MOST_SEEDS: u64 = crate::catalogue::joints::COUNT;

/// By what a constant is scaled.
pub const FACTORS: [f32; 2] = [0.5, 2.0];

/// Every run with one constant scaled.
#[derive(Clone, Debug)]
pub struct Effect {
    /// The constant.
    pub constant: Tuned,
    /// By each of [`FACTORS`], a joint each.
    pub scaled: [Vec<Outcome>; 2],
}

/// The default gear with either set of sensors.
fn default_joints() -> impl Iterator<Item = Joint> {
    let seeds = Set::Training.first()..;
    SensorSet::ALL.into_iter().zip(seeds).map(|(sensors, seed)| {
        let mut known = GearFile::default_gear();
        let output = (sensors == SensorSet::Both).then(|| known.sensors.output_bits());
        known.sensors.output_encoder_bits = output;
        known.sensors.output_encoder_zero = output.map(|_| 0.0);
        Joint { seed, known, unknown: Which::BOX }
    })
}

/// The default gear's joints, and so many training joints of the catalogue.
fn joints(count: u64) -> Vec<Joint> {
    let [motor, both] = [count.div_ceil(2), count / 2];
    let mut left = [motor, both];
    let training = Set::Training.joints().into_iter().filter(|joint| {
        let left = &mut left[SensorSet::of(&joint.known) as usize];
        let takes = *left > 0;
        *left = left.saturating_sub(1);
        takes
    });
    default_joints().chain(training).collect()
}

/// Scales each of the constants, on so many training joints and on the default gear; `progress` is called with the fraction done.
///
/// Constants are scaled for the whole process: nothing else may be built or run meanwhile.
///
/// # Errors
/// A joint that no plant or baseline can be built for.
///
/// # Panics
/// Where a constant is scaled already.
pub fn measure(constants: &[Tuned], seeds: u64, mut progress: impl FnMut(f64)) -> Result<Report, Error> {
    let parts = (1 + FACTORS.len() * constants.len()) as f64;
    let mut done = 0.0;
    let mut part = |fraction: f64| progress((done + fraction) / parts);
    let joints = joints(seeds);
    let unscaled = each(&joints, Outcome::of, &mut part).into_iter().collect::<Result<Vec<_>, _>>()?;
    let mut effects = Vec::with_capacity(constants.len());
    for constant in constants {
        let mut scaled = FACTORS.map(|_| Vec::new());
        for (outcomes, factor) in scaled.iter_mut().zip(FACTORS) {
            done += 1.0;
            let mut part = |fraction: f64| progress((done + fraction) / parts);
            let _scaled = constant.scale(factor).expect("one constant is scaled at a time");
            let again = each(&unscaled, Outcome::again, &mut part);
            *outcomes = again.into_iter().collect::<Result<_, _>>()?;
        }
        effects.push(Effect { constant: *constant, scaled });
    }
    Ok(Report { unscaled, effects })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_the_joints_have_an_output_encoder_and_none_is_judged() {
        let joints = joints(5);
        let with_output = joints.iter().filter(|joint| SensorSet::of(&joint.known) == SensorSet::Both);
        assert_eq!((joints.len(), with_output.count()), (7, 3));
        assert!(joints.iter().all(|joint| Set::Training.seeds().contains(&joint.seed)));
    }
}
