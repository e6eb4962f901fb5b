//! Friction at the wave generator, from the motor's torque over its motion, by the friction block's own law.
//!
//! | file | |
//! | --- | --- |
//! | `motion` | the motion, as the block sees it |
//! | `unknowns` | what is unknown of block, load and start, with priors and ranges |
//! | `rollout` | the block over the motion: the motor's torque |
//! | `fit` | bounded, robust least squares of the unknowns, with their covariance |
//! | `choice` | which unknowns the log carries, by cross-validation |
//! | `spectrum` | waves of the residual over the motor's angle |
//! | `verdict` | value, standard error and verdict of each parameter |
//!
//! What the log does not carry keeps the base gear's value. Levels, viscous friction, Stribeck speed and ripple are put into the gear
//! in the directions that the motor moved in. Weight, inertia and waves are not: the load is the base gear's affair, and
//! a torque that is no friction has no place in the block.
//!
//! Motion with the torque's sign the other way round is separated by friction alone, which never drives.

mod choice;
mod fit;
mod motion;
mod rollout;
mod spectrum;
#[cfg(test)]
mod strokes;
mod unknowns;
mod verdict;

use nalgebra::DMatrix;

use self::choice::{choose, first, is_at_limit};
use self::fit::{Fit, Solution};
use self::motion::Motion;
use self::rollout::Rollout;
pub use self::spectrum::Wave;
pub use self::unknowns::Parameter;
use self::unknowns::{Change, Unknown};
pub use self::verdict::{LearntParameter, Verdict};
use super::super::Error;
use super::super::covariance::Covariance;
use super::EVERY;
use crate::identify::replay::ReplayRow;
use crate::identify::reversal::travel;
use crate::io::gear_file::GearFile;
use crate::io::log::BOTH_DIRECTIONS;
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Fraction of the Coulomb level that friction varies by around its law, before a log tells.
const UNKNOWN: f64 = 0.2;
/// Time over which this is alike (s).
const ALIKE: f64 = 0.1;
/// Sum of squares with the torque as logged, over that with its sign changed, from which on the sign is wrong.
const REVERSED: f64 = 2.0;
/// Motor's motion below which a way back is the encoder's noise (rad).
const NOISE: f64 = 0.02;

/// Input friction of a joint.
#[derive(Clone, Debug, PartialEq)]
pub struct LearntFriction {
    /// Factor on the base gear's levels.
    pub level: f64,
    /// Factor on its viscous friction.
    pub viscous: f64,
    /// The motor moved forwards, and backwards; in the other direction the base gear's friction stays.
    pub directions: [bool; 2],
    /// Every parameter.
    pub parameters: Vec<LearntParameter>,
    /// Waves of the torque that have no place in the block, with their amplitudes (N m).
    pub waves: Vec<(Wave, f64)>,
    /// Standard deviation of the torque's residual (N m).
    pub residual: f64,
    /// Of what was fitted, each in units of its prior.
    pub covariance: Covariance,
}

impl LearntFriction {
    /// What the torque has and the gear file has no key for, a line each.
    pub fn beyond(&self) -> impl Iterator<Item = String> {
        self.waves.iter().map(|(wave, amplitude)| {
            let kind = if wave.reverses { "friction" } else { "torque" };
            format!(
                "{kind} of order {} of the motor's angle: {amplitude:.2e} N m; the gear file has no key for it",
                wave.order
            )
        })
    }

    /// Keys of the gear file whose factor ends where its search does; with the factor.
    pub fn limits(&self) -> Vec<(&'static str, f64)> {
        let at_limit = |parameter: Parameter| {
            let own = self.parameters.iter().find(|own| own.parameter == parameter);
            own.is_some_and(|own| own.verdict == Verdict::AtLimit)
        };
        let factors = [
            (Parameter::Coulomb, "friction.input.coulomb_nm", self.level),
            (Parameter::Viscous, "friction.input.viscous_nm_s_per_rad", self.viscous),
        ];
        let ended = factors.into_iter().filter(|(parameter, ..)| at_limit(*parameter));
        ended.map(|(_, key, factor)| (key, factor)).collect()
    }
}

/// Puts the learnt friction into the gear.
pub(super) fn learn(gear: &mut GearFile, rows: &[ReplayRow]) -> Result<LearntFriction, Error> {
    let motion = Motion::of(gear, rows)?;
    let rollout = Rollout { gear, motion: &motion, directions: directions(rows) };
    let torque: Vec<_> = motion.rows().map(|step| step.torque).collect();
    let (unknowns, solution) = factors(rollout, &torque)?;
    let turned: Vec<_> = torque.iter().map(|torque| -torque).collect();
    let ratio = solution.cost / factors(rollout, &turned)?.1.cost;
    if ratio > REVERSED {
        return Err(Error::ReversedTorque { ratio, most: REVERSED });
    }
    let choice = choose(rollout, &torque, (unknowns, solution))?;
    let parameters = verdict::parameters(rollout, &torque, &choice)?;
    let (unknowns, solution) = (&choice.model.unknowns, &choice.model.solution);
    let z: Vec<_> = unknowns.iter().zip(&solution.z).map(|(unknown, z)| ended(*unknown, *z)).collect();
    let change = Change::of(unknowns, &z);
    let found = LearntFriction {
        level: change.level,
        viscous: change.viscous,
        directions: rollout.directions,
        parameters,
        waves: waves(unknowns, &z, gear.friction.input.coulomb.unwrap_or_default()),
        residual: solution.noise.deviation,
        covariance: covariance(rollout, &torque, unknowns, solution)?,
    };
    change.put_into(&mut gear.friction.input, found.directions);
    Ok(found)
}

/// Of the unknowns that the log carries, by name.
fn covariance(
    rollout: Rollout<'_>,
    torque: &[f64],
    unknowns: &[Unknown],
    solution: &Solution,
) -> Result<Covariance, Error> {
    let matrix = Fit { rollout, torque, unknowns }.covariance(&solution.z, solution)?;
    let names = unknowns.iter().map(|unknown| unknown.name()).collect();
    Ok(Covariance::of_sums(names, &DMatrix::identity(unknowns.len(), unknowns.len()), &matrix))
}

/// A value next to the end of its range is that end: the solver stays within.
fn ended(unknown: Unknown, z: f64) -> f64 {
    if is_at_limit(unknown, z) {
        unknown.range().into_iter().min_by(|a, b| (a - z).abs().total_cmp(&(b - z).abs())).unwrap_or(z)
    } else {
        z
    }
}

/// Coulomb and viscous factors with what is beside them.
fn factors(rollout: Rollout<'_>, torque: &[f64]) -> Result<(Vec<Unknown>, Solution), Error> {
    let unknowns = first(&rollout);
    let fit = Fit { rollout, torque, unknowns: &unknowns };
    let solution = fit.plain(&vec![0.0; unknowns.len()], torque_noise(rollout.gear))?;
    Ok((unknowns, solution))
}

fn waves(unknowns: &[Unknown], z: &[f64], scale: f64) -> Vec<(Wave, f64)> {
    let cosine = |of: Wave| {
        let place = unknowns.iter().position(|unknown| *unknown == Unknown::Cosine(of));
        place.map_or(0.0, |place| z[place])
    };
    let sines = unknowns.iter().zip(z).filter_map(|(unknown, z)| match unknown {
        Unknown::Sine(wave) => Some((*wave, *z)),
        _ => None,
    });
    sines.map(|(wave, sine)| (wave, scale * sine.hypot(cosine(wave)))).collect()
}

/// The motor moved forwards, and backwards.
fn directions(rows: &[ReplayRow]) -> [bool; 2] {
    let path = travel(&rows.iter().map(|row| row.motor).collect::<Vec<_>>(), NOISE);
    path.map(|one| one >= BOTH_DIRECTIONS * path.iter().sum::<f64>())
}

/// Standard deviation of a row's torque where rows count as independent, before a log tells (N m).
pub(crate) fn torque_noise(gear: &GearFile) -> f64 {
    let alike = (ALIKE / (EVERY as f64 * CONTROL_PERIOD)).sqrt();
    let coulomb = gear.friction.input.coulomb.unwrap_or_default();
    UNKNOWN * coulomb.max(gear.sensors.motor_torque_noise) * alike
}
