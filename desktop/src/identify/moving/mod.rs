//! Identification from a moving joint's log with both encoders: friction and kinematic error.
//!
//! ```text
//! theta_out - r*theta_motor = c + e(theta_motor) - phi + E(r*theta_motor) + n
//! ```
//!
//! | unknown | what it is |
//! | --- | --- |
//! | c | offset of the encoders (rad) |
//! | e | kinematic error, orders [`ORDERS`] of the motor's angle relative to the flexspline, and relative to the case |
//! | E | error of the output encoder's scale, as eccentricity makes it, orders 1 and 2 a revolution of the output |
//! | phi | torsion that the observer finds with the base gear's stiffness, from the motor side (rad) |
//! | n | what is in no column: noise that is alike over a short path and a short time |
//!
//! In this order: friction from the motor's torque over its motion (`friction/`); with it, for every observer of
//! [`WANDERS`], its torsion and the regularised least squares of the above (`residual.rs`); the observer with the least sum of
//! squares is kept. The wander says how much of the motor torque that friction does not explain winds the gear up: where
//! friction is not known to a fraction of the rated torque, hardly any.
//!
//! The stiffness stays the base gear's. What winds a moving joint up is the load's torque, which is not in the log: stiffness,
//! the load's inertia and its weight are known only together, and a factor on the stiffness ends wherever its range does. A
//! held joint's log identifies it.
//!
//! The first part of the motor's path trains, the rest is predicted; a path holds few revolutions, so every unknown has a
//! prior of catalogue size and an order that the path does not show is not learnt. A path that does not show the order of
//! the two lobes shows friction alone, and e and E stay the base gear's; so does a log without an output encoder, with which the
//! observer stays, too. The two kinds of orders beat
//! once in a revolution of the output: over less than half a beat they are one, and counted relative to the flexspline.
//!
//! C. Rasmussen, C. Williams, "Gaussian Processes for Machine Learning", MIT Press (2006), section 2.7, for the
//! columns with priors under correlated noise.

mod friction;
mod regression;
mod residual;

use strainwave::Error as ParameterError;

use super::Error;
use super::covariance::Covariance;
use super::sequence::span;
use super::{HELD_LOG, MOVING_LOG, NotIdentified};
use crate::bench::controller::HostCompensator;
use crate::design::joint::joint_params;
use crate::identify::replay::{Judgement, ReplayRow, replay, time_of_path};
use crate::io::gear_file::{GearFile, KinematicError};
use crate::io::log::MeasuredLog;
pub(crate) use friction::torque_noise;
pub use friction::{LearntFriction, LearntParameter, Parameter, Verdict, Wave};
pub(crate) use regression::Regression;
pub use residual::{BEATS, Kind, ORDERS, Residual};
pub(crate) use residual::{OFFSET, alike, error_prior};

/// Wanders of the external torque that are tried, in rated torques and the square root of a second: an observer's that is
/// designed without a log, and none over any log. One between would be followed more slowly than a log moves, and
/// drift through it.
pub const WANDERS: [f64; 2] = [0.45, 1e-7];
/// Presliding distances that the motor has to turn by: beyond one friction is at its level.
const PRESLIDINGS: f64 = 2.0;
/// Largest motion of the output beside the gear's ratio (rad): what a gear file may say of its encoder's eccentricity.
const BESIDE: f64 = 0.01;
/// Every how many control periods a row is used: 4 ms.
pub(crate) const EVERY: usize = 40;

/// Learnt gear, with its prediction errors.
#[derive(Clone, Debug, PartialEq)]
pub struct LearntGear {
    /// The base gear with what was learnt.
    pub gear: GearFile,
    /// Time up to which the log trained (s).
    pub learnt: f64,
    /// Span of the motor's angle until then (revolutions).
    pub revolutions: f64,
    /// The kinematic error and that of the output encoder were learnt; else they are the base gear's.
    pub errors: bool,
    /// The input friction.
    pub friction: LearntFriction,
    /// Rms residual of the trained rows (rad); `None` without a measured output, of which it is.
    pub training_rms: Option<f64>,
    /// Prediction error on the remainder by the observer in the firmware's precision; `None` without one, or without a measured output.
    pub judgement: Option<Judgement>,
    /// The same of the base gear.
    pub base_judgement: Option<Judgement>,
    /// The log through the observer of the learnt gear.
    pub rows: Vec<ReplayRow>,
    /// The log through the observer of the base gear.
    pub base_rows: Vec<ReplayRow>,
    /// Of sines and cosines of the kinematic error and of the output encoder's scale (rad), and of the encoders' offset.
    pub error_covariance: Option<Covariance>,
}

impl LearntGear {
    /// The log had an output encoder.
    pub fn has_output(&self) -> bool {
        self.training_rms.is_some()
    }

    /// What the log does not show.
    pub fn not_identified(&self) -> Vec<NotIdentified> {
        let friction = |direction: &str| NotIdentified {
            what: format!("friction {direction}"),
            why: "the part that trains does not move so",
            helps: MOVING_LOG,
        };
        let stiffness = NotIdentified {
            what: "stiffness".into(),
            why: "a moving joint's log does not tell it from the load",
            helps: HELD_LOG,
        };
        let directions = self.friction.directions.iter().zip(["forwards", "backwards"]);
        let kept = directions.filter(|(moved, _)| !**moved).map(|(_, direction)| friction(direction));
        let errors = NotIdentified {
            what: "kinematic error".into(),
            why: if self.has_output() {
                "the part that trains does not show the order of the two lobes"
            } else {
                "the log has no column theta_out_rad"
            },
            helps: MOVING_LOG,
        };
        kept.chain((!self.errors).then_some(errors)).chain([stiffness]).collect()
    }
}

/// Learns from the first `training` of the motor's path, 0.2..=1; `progress` is called with the fraction done.
///
/// # Errors
/// [`Error`] when the motor moves too little, the output not by the gear's ratio, or the torque counts
/// against the motion; a gear that no compensator can be built from.
pub fn learn_gear(
    base: &GearFile,
    log: &MeasuredLog,
    training: f64,
    progress: impl FnMut(f64),
) -> Result<LearntGear, Error> {
    if !(0.2..=1.0).contains(&training) {
        return Err(ParameterError::OutOfRange("training").into());
    }
    let learnt = time_of_path(log, training);
    let rows = observe(base, log, learnt)?;
    require_travel(base, &rows)?;
    let measured = log.output_position.is_some();
    if measured {
        require_ratio(&rows)?;
    }
    let revolutions = residual::revolutions(&rows);
    let errors = measured && residual::shows_errors(revolutions);
    let mut gear = if errors { without_errors(base) } else { base.clone() };
    let friction = friction::learn(&mut gear, &rows)?;
    let mut residual = None;
    if measured {
        let (found, observer) = best_observer(&gear, log, learnt, progress)?;
        gear = observer;
        if errors {
            found.put_into(&mut gear);
        }
        residual = Some(found);
    }
    let [rows, base_rows] = [observe_log(&gear, log)?, observe_log(base, log)?];
    let rest = measured && rows.last().is_some_and(|last| last.time > learnt);
    let judge = |rows: &[ReplayRow]| rest.then(|| Judgement::of(rows, learnt));
    Ok(LearntGear {
        learnt,
        revolutions,
        errors,
        friction,
        training_rms: residual.as_ref().map(|found| found.rms),
        judgement: judge(&rows),
        base_judgement: judge(&base_rows),
        gear,
        rows,
        base_rows,
        error_covariance: residual.and_then(|found| found.covariance),
    })
}

/// The observer whose output leaves the least sum of squares, and what it leaves.
fn best_observer(
    gear: &GearFile,
    log: &MeasuredLog,
    learnt: f64,
    mut progress: impl FnMut(f64),
) -> Result<(Residual, GearFile), Error> {
    let mut best: Option<(Residual, GearFile)> = None;
    let observers = observers(gear);
    for (done, gear) in observers.iter().enumerate() {
        progress(done as f64 / observers.len() as f64);
        let found = Residual::solve(gear, &observe(gear, log, learnt)?)?;
        if best.as_ref().is_none_or(|(best, _)| found.squares < best.squares) {
            best = Some((found, gear.clone()));
        }
    }
    best.ok_or(ParameterError::OutOfRange("gear").into())
}

/// The motor goes beyond presliding.
fn require_travel(gear: &GearFile, rows: &[ReplayRow]) -> Result<(), Error> {
    let travel = span(&rows.iter().map(|row| row.motor).collect::<Vec<_>>());
    let least = PRESLIDINGS * gear.friction.input.presliding.unwrap_or_default();
    if travel < least { Err(Error::TooLittleTravel { travel, least }) } else { Ok(()) }
}

/// The output follows the motor by the gear's ratio.
fn require_ratio(rows: &[ReplayRow]) -> Result<(), Error> {
    let mean = |of: fn(&ReplayRow) -> f64| rows.iter().map(of).sum::<f64>() / rows.len() as f64;
    let (rigid, measured) = (mean(|row| row.rigid), mean(|row| row.measured));
    let along = |row: &ReplayRow| (row.rigid - rigid, row.measured - measured);
    let (squares, products) =
        rows.iter().map(along).fold((0.0, 0.0), |(squares, products), (rigid, measured)| {
            (squares + rigid * rigid, products + rigid * measured)
        });
    let factor = products / squares;
    let moved = span(&rows.iter().map(|row| row.rigid).collect::<Vec<_>>());
    let beside = (factor - 1.0).abs() * moved;
    if beside > BESIDE { Err(Error::WrongRatio { factor, most: BESIDE }) } else { Ok(()) }
}

/// Learns the input friction alone, from all of a log.
///
/// # Errors
/// As [`learn_gear`].
pub fn learn_friction(base: &GearFile, log: &MeasuredLog) -> Result<(GearFile, LearntFriction), Error> {
    let mut gear = without_errors(base);
    let rows = observe(&gear, log, f64::INFINITY)?;
    let friction = friction::learn(&mut gear, &rows)?;
    Ok((gear, friction))
}

/// The gear with each of the observers that are tried; those that cannot be built are left out.
fn observers(gear: &GearFile) -> Vec<GearFile> {
    let with = |wander: f64| {
        let mut one = gear.clone();
        one.compensation.external_torque_wander = Some(wander * gear.gear.rated_torque);
        one
    };
    WANDERS.map(with).into_iter().filter(is_sound).collect()
}

/// A gear file may say it, and a compensator can be built from it.
fn is_sound(gear: &GearFile) -> bool {
    gear.check().is_ok() && joint_params::<f32>(gear).is_ok_and(|joint| joint.build().is_ok())
}

/// The gear of an ideal mesh, its output encoder centred.
pub(crate) fn without_errors(gear: &GearFile) -> GearFile {
    let mut ideal = gear.clone();
    ideal.kinematic_error = KinematicError::default();
    ideal.sensors.output_encoder_error = Vec::new();
    ideal
}

/// A log through the observer of a gear, in the firmware's precision.
pub(crate) fn observe_log(gear: &GearFile, log: &MeasuredLog) -> Result<Vec<ReplayRow>, Error> {
    observe(gear, log, f64::INFINITY)
}

/// The log through the observer in the firmware's precision, up to `until` (s).
fn observe(gear: &GearFile, log: &MeasuredLog, until: f64) -> Result<Vec<ReplayRow>, Error> {
    let mut controller = HostCompensator::build(&joint_params(gear)?)?;
    replay(&mut controller, gear, log, until, |_| ()).map_err(|error| Error::Solver(error.to_string()))
}
