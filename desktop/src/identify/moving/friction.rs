//! Friction at the wave generator, from the motor's torque over its motion.
//!
//! ```text
//! tau_motor = g0 + g1*r*theta + F*curve(omega)*sliding(omega) + V*Fv*omega + M*(J_wg + r^2*J_fs)*domega
//! curve(omega) = Fc + (Fs - Fc)*exp(-|omega|/vs)            sliding(omega) = tanh(omega/SLIDING)
//! ```
//!
//! F, V, M >= 0 are factors on what the base gear says, with the prior 1 +- 1; g0 and g1 (N m, N m/rad) are the load's
//! weight along the path, free up to the gear's peak torque. F and V are put into the gear, in the directions that the motor
//! moved in; M is not: the load that it weighs is the base gear's affair. Noise: [`UNKNOWN`] of the Coulomb level, alike over [`ALIKE`].
//!
//! Motion with the torque's sign the other way round is separated by friction alone, which never drives.

use nalgebra::{DMatrix, DVector};

use super::super::Error;
use super::super::covariance::Covariance;
use super::super::least_squares::Factor;
use super::EVERY;
use crate::identify::replay::ReplayRow;
use crate::identify::reversal::travel;
use crate::io::gear_file::{Backward, Friction, GearFile};
use crate::io::log::BOTH_DIRECTIONS;
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Speed from which on the contact slides (rad/s).
const SLIDING: f64 = 0.3;
/// Fraction of the Coulomb level that friction varies by around the curve.
const UNKNOWN: f64 = 0.2;
/// Time over which this is alike (s).
const ALIKE: f64 = 0.1;
/// Half of the time over which speeds and accelerations are taken (s).
const HALF_SPAN: f64 = 0.024;
/// Sum of squares with the torque as logged, over that with its sign changed, from which on the sign is wrong.
const REVERSED: f64 = 2.0;

/// Motor's motion below which a way back is the encoder's noise (rad).
const NOISE: f64 = 0.02;

/// Factors on the input friction of the base gear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearntFriction {
    /// F
    pub level: f64,
    /// V
    pub viscous: f64,
    /// The motor moved forwards, and backwards; in the other direction the base gear's friction stays.
    pub directions: [bool; 2],
}

impl LearntFriction {
    /// Keys of the gear file whose factor ends at 0, where its search does; with the factor.
    pub fn limits(&self) -> Vec<(&'static str, f64)> {
        let factors = [
            ("friction.input.coulomb_nm", self.level),
            ("friction.input.viscous_nm_s_per_rad", self.viscous),
        ];
        factors.into_iter().filter(|(_, factor)| *factor == 0.0).collect()
    }

    /// The side with its levels and viscous friction multiplied.
    fn put_into(&self, side: &mut Friction) {
        let backwards = side.backwards();
        let times = |value: Option<f64>, factor: f64, moved: bool| {
            value.map(|value| if moved { value * factor } else { value })
        };
        let [forward, backward] = self.directions;
        if forward != backward || side.backward.is_some() {
            side.backward = Some(Backward {
                coulomb: times(backwards.coulomb, self.level, backward),
                static_level: times(backwards.static_level, self.level, backward),
                viscous: times(backwards.viscous, self.viscous, backward),
                ..side.backward.take().unwrap_or_default()
            });
        }
        side.coulomb = times(side.coulomb, self.level, forward);
        side.static_level = times(side.static_level, self.level, forward);
        side.viscous = times(side.viscous, self.viscous, forward);
    }
}

/// Puts the learnt friction into the gear.
pub(super) fn learn(gear: &mut GearFile, rows: &[ReplayRow]) -> Result<LearntFriction, Error> {
    let (factors, squares) = fit(gear, rows, 1.0)?;
    let (_, reversed) = fit(gear, rows, -1.0)?;
    if squares > REVERSED * reversed {
        return Err(Error::ReversedTorque { ratio: squares / reversed, most: REVERSED });
    }
    let [level, viscous, _] = factors;
    let found = LearntFriction { level, viscous, directions: directions(rows) };
    found.put_into(&mut gear.friction.input);
    Ok(found)
}

/// The motor moved forwards, and backwards.
fn directions(rows: &[ReplayRow]) -> [bool; 2] {
    let path = travel(&rows.iter().map(|row| row.motor).collect::<Vec<_>>(), NOISE);
    path.map(|one| one >= BOTH_DIRECTIONS * path.iter().sum::<f64>())
}

/// F, V, M, and the sum of squares with the priors'.
fn fit(gear: &GearFile, rows: &[ReplayRow], sign: f64) -> Result<([f64; 3], f64), Error> {
    let rows = equations(gear, rows, sign);
    let factor = Factor::of(rows);
    let prior = DVector::from_vec(vec![0.0, 0.0, 1.0, 1.0, 1.0]);
    let x = factor.solve(&DMatrix::identity(5, 5), &prior, 2)?;
    let pulled: f64 = x.iter().zip(&prior).map(|(x, p)| (x - p).powi(2)).sum();
    Ok(([x[2], x[3], x[4]], factor.squares(&x) + pulled))
}

/// Standard deviation of a row's torque where rows count as independent (N m).
pub(crate) fn torque_noise(gear: &GearFile) -> f64 {
    let alike = (ALIKE / (EVERY as f64 * CONTROL_PERIOD)).sqrt();
    let coulomb = gear.friction.input.coulomb.unwrap_or_default();
    UNKNOWN * coulomb.max(gear.sensors.motor_torque_noise) * alike
}

/// Rows [g0, g1, F, V, M | tau], each of unit noise and each unknown of unit prior.
fn equations(gear: &GearFile, rows: &[ReplayRow], sign: f64) -> DMatrix<f64> {
    let friction = &gear.friction.input;
    let r: f64 = gear.gear.signed_ratio().value();
    let inertia = gear.inertia.wave_generator + r * r * gear.inertia.flexspline;
    let weight = r * gear.gear.peak_torque;
    let noise = torque_noise(gear);
    let span = (HALF_SPAN / CONTROL_PERIOD) as usize;
    let used: Vec<_> = (span..rows.len().saturating_sub(span)).step_by(EVERY).collect();
    DMatrix::from_fn(used.len(), 6, |row, column| {
        let at = |k: usize| rows[k].motor;
        let (before, now, after) = (at(used[row] - span), at(used[row]), at(used[row] + span));
        let speed = (after - before) / (2.0 * HALF_SPAN);
        let value = match column {
            0 => weight,
            1 => weight * rows[used[row]].rigid,
            2 => curve(friction, speed) * (speed / SLIDING).tanh(),
            3 => friction.viscous.unwrap_or_default() * speed,
            4 => inertia * (after - 2.0 * now + before) / (HALF_SPAN * HALF_SPAN),
            _ => sign * rows[used[row]].motor_torque,
        };
        value / noise
    })
}

fn curve(friction: &Friction, speed: f64) -> f64 {
    let coulomb = friction.coulomb.unwrap_or_default();
    let more = friction.static_level.unwrap_or(coulomb) - coulomb;
    coulomb + more * (-speed.abs() / friction.stribeck_velocity.unwrap_or(f64::INFINITY)).exp()
}

/// Names of F and V in the covariance.
pub const LEVEL: &str = "friction levels";
/// As [`LEVEL`].
pub const VISCOUS: &str = "viscous friction";

/// Of g0 and g1, in the weight's prior, and the factors F, V and M.
pub(super) fn covariance(gear: &GearFile, rows: &[ReplayRow]) -> Option<Covariance> {
    let names = ["weight", "weight over the angle", LEVEL, VISCOUS, "inertia"].map(String::from).to_vec();
    let unit = DMatrix::identity(names.len(), names.len());
    let places: Vec<_> = (0..names.len()).collect();
    let unknowns = Factor::of(equations(gear, rows, 1.0)).covariance(&unit, &places)?;
    Some(Covariance::of_sums(names, &unit, &unknowns))
}
