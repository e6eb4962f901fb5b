//! Experiment: the motion of a joint that shows the parameters of a moving joint best.
//!
//! A plan is a number of parts, each a member of a small family (`family.rs`): slow triangles of growing amplitude, several speeds
//! both ways, a chirp, a swing of a pendulum. Chosen are those whose Fisher information
//! (`information.rs`) has the largest determinant:
//!
//! ```text
//! log det(1 + sum of the parts' S'S)  largest        over all choices of so many parts, each once
//! ```
//!
//! S are the sensitivities of the real-time model's motor torque and output angle, over the noise and times the prior that
//! `identify --moving` has. What no parameter explains, such as friction that varies over the angle, comes back when a motion is
//! repeated: a member that is there twice would be no second witness. Every part starts at rest, loaded by nothing before. The standard error of a parameter is the root
//! of its diagonal element of the inverse, times its prior.

mod family;
mod information;

use nalgebra::DMatrix;
use strainwave::Error;

use crate::io::gear_file::GearFile;
use crate::io::log::{CommandedMotion, Time};
use family::{INTERVAL, Kind, PART, family};
pub use information::Parameter;

/// Most parts of a plan: a kind has no more members.
pub const MOST_PARTS: usize = 5;

/// A chosen motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Angles of the output (rad), every 10 ms.
    pub position: Vec<f64>,
    /// Its parts for people.
    pub parts: Vec<String>,
    /// What is known of each parameter before, as a standard deviation in its unit.
    pub priors: Vec<(Parameter, f64)>,
    /// Its errors.
    pub errors: StandardErrors,
    /// The best that the members of one kind alone reach in the same time, by its name.
    pub plain: Vec<(&'static str, StandardErrors)>,
}

/// What a motion tells of the parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct StandardErrors {
    /// Logarithm of the information's determinant, in that of the priors.
    pub log_determinant: f64,
    /// Standard error of each parameter, in its unit.
    pub errors: Vec<(Parameter, f64)>,
}

impl StandardErrors {
    fn of(information: &DMatrix<f64>, priors: &[(Parameter, f64)]) -> Option<Self> {
        let cholesky = (information + DMatrix::identity(priors.len(), priors.len())).cholesky()?;
        let log_determinant = 2.0 * cholesky.l().diagonal().iter().map(|entry| entry.ln()).sum::<f64>();
        let inverse = cholesky.inverse();
        let error = |(place, (parameter, prior)): (usize, &(Parameter, f64))| {
            (*parameter, prior * inverse[(place, place)].sqrt())
        };
        Some(Self { log_determinant, errors: priors.iter().enumerate().map(error).collect() })
    }
}

impl Plan {
    /// The plan as a file of `pil --trajectory` has it.
    pub fn motion(&self) -> CommandedMotion {
        CommandedMotion {
            time: Time::every(INTERVAL, self.position.len()),
            position: self.position.clone(),
            velocity: None,
            acceleration: None,
            load: None,
        }
    }

    /// Time stamps, rounded to the digits that they have (s).
    pub fn stamps(&self) -> Vec<f64> {
        (0..self.position.len()).map(|row| (row as f64 * INTERVAL * 1e3).round() / 1e3).collect()
    }
}

/// Chooses a plan of so many parts, 1..=[`MOST_PARTS`], within `range` (rad) either way of where the joint stands; `progress` is called
/// with the fraction done.
///
/// # Errors
/// A gear that cannot be built, or a family of which no member is within the joint's limits.
pub fn plan(gear: &GearFile, range: f64, count: usize, mut progress: impl FnMut(f64)) -> Result<Plan, Error> {
    let parts = family(gear, range);
    let priors = information::priors(gear);
    let mut informed = Vec::with_capacity(parts.len());
    for (done, part) in parts.iter().enumerate() {
        progress(done as f64 / parts.len() as f64);
        informed.push(information::information(gear, &part.trajectory(), &priors)?);
    }
    let best = |places: &[usize]| best(places, &informed, &priors, count);
    let all: Vec<_> = (0..parts.len()).collect();
    let (chosen, errors) = best(&all).ok_or(Error::OutOfRange("range"))?;
    let plain = Kind::ALL.into_iter().filter_map(|kind| {
        let places: Vec<_> = (0..parts.len()).filter(|place| parts[*place].kind == kind).collect();
        Some((kind.name(), best(&places)?.1))
    });
    let plain = plain.collect();
    let position = chosen.iter().flat_map(|place| parts[*place].position.clone()).chain([0.0]).collect();
    let titles = chosen.iter().map(|place| parts[*place].title()).collect();
    Ok(Plan { position, parts: titles, priors, errors, plain })
}

/// The choice of `count` of these places, of all where there are fewer, of the largest determinant.
fn best(
    places: &[usize],
    informed: &[DMatrix<f64>],
    priors: &[(Parameter, f64)],
    count: usize,
) -> Option<(Vec<usize>, StandardErrors)> {
    let sum = |chosen: &[usize]| {
        let zero = DMatrix::zeros(priors.len(), priors.len());
        chosen.iter().fold(zero, |sum, place| sum + &informed[*place])
    };
    let measured = choices(places, count.min(places.len()))
        .into_iter()
        .filter_map(|chosen| Some((StandardErrors::of(&sum(&chosen), priors)?, chosen)));
    let most = measured.max_by(|(a, _), (b, _)| a.log_determinant.total_cmp(&b.log_determinant));
    most.map(|(errors, chosen)| (chosen, errors))
}

/// Every choice of `count` of these places, each in the places' order.
fn choices(places: &[usize], count: usize) -> Vec<Vec<usize>> {
    if count == 0 {
        return vec![Vec::new()];
    }
    let starting = |first: usize| {
        choices(&places[first + 1..], count - 1)
            .into_iter()
            .map(move |rest| [vec![places[first]], rest].concat())
    };
    (0..places.len()).flat_map(starting).collect()
}

/// Length of a plan of so many parts (s).
pub fn duration(parts: usize) -> f64 {
    PART * parts as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::Trajectory;

    #[test]
    fn choices_are_all_and_each_once() {
        assert_eq!(choices(&[3, 5, 7], 2), [[3, 5], [3, 7], [5, 7]]);
        assert_eq!(choices(&[1, 2, 3, 4, 5, 6, 7], 3).len(), 35);
    }

    /// It tells more than each kind alone, and every error is at most what was known before; the motion is one that the joint
    /// can follow, within its range.
    #[test]
    fn a_plan_tells_more_than_any_kind_alone() {
        let gear = GearFile::default_gear();
        let plan = plan(&gear, 0.5, 2, |_| ()).unwrap();
        assert_eq!((plan.parts.len(), plan.plain.len()), (2, 4));
        for (name, plain) in &plan.plain {
            assert!(plan.errors.log_determinant >= plain.log_determinant, "{name}: {plan:?}");
        }
        for ((parameter, error), (_, prior)) in plan.errors.errors.iter().zip(information::priors(&gear)) {
            assert!(*error < prior && *error > 0.0, "{}: {error} of {prior}", parameter.name());
        }
        assert!(plan.position.iter().all(|angle| angle.abs() <= 0.5));
        assert_eq!((plan.position[0], plan.position[plan.position.len() - 1]), (0.0, 0.0));
        let trajectory = Trajectory::of(&plan.motion());
        assert_eq!(trajectory.require_within(&gear), Ok(()));
        assert!(trajectory.warnings(&gear).is_empty());
    }
}
