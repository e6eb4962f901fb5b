//! The gear as the filter sees it: linear, in units that make its numbers of one size.
//!
//! ```text
//! x = [theta_wg, omega_wg, theta_fs, omega_fs, d, s or b],   x(k+1) = A x + w,   y = C x + v
//! phi   = r*theta_wg - theta_fs,                             tau_t = K1*phi + c*dphi + s
//! ```
//!
//! A is one semi-implicit Euler step of the observer's period, as in the observer itself; friction enters as noise,
//! but for its viscous part.
//!
//! Noise: encoders by their resolution (q/sqrt(12)) plus jitter in counts of a 19-bit encoder; motor torque and
//! strain gauge by the gear file; a fraction of the Coulomb friction of either side, renewed every control period; an
//! external torque that wanders ([`WANDER`]). s wanders by what the stiffness takes of that, b by what a brake takes of
//! it, r times.

use std::f64::consts::FRAC_1_SQRT_2;

use nalgebra::{DMatrix, DVector, RowDVector};
use strainwave::compensator::schedule::{OBSERVER_PERIODS, SLOW_PERIODS};
use strainwave::compensator::tuned::ENCODER_NOISE;

use crate::design::tuned::{FRICTION_NOISE, WANDER};
use crate::io::gear_file::{Friction, GearFile};
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Control periods of a period of the observer, and its duration (s).
const PERIODS: f64 = OBSERVER_PERIODS as f64;
pub(super) const DT: f64 = PERIODS * CONTROL_PERIOD;

/// Process and measurement noise of the filter's model.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unknown {
    /// Random walk of the external torque in a second, as a fraction of the rated torque.
    pub wander: f64,
    /// Fraction of the Coulomb friction that is renewed every control period.
    pub friction: f64,
    /// Noise of the motor's encoder besides its resolution, in counts of 2^19 a revolution: of each reading that the observer
    /// looks at, the mean of two.
    pub jitter: f64,
    /// Of the output's: in slow motion the error of a count is no noise but a wave that follows the angle, so that
    /// its readings are averaged over a time in which many counts pass. Of readings in every control period. With more of
    /// it the estimate follows the motor's encoder alone, and vibrates where friction holds the output.
    pub output_jitter: f64,
}

impl Unknown {
    /// Of a motor that moves: the design's, or where the file has a wander and encoder noise of its own, those.
    pub(super) fn of_file(file: &GearFile) -> Self {
        let own = file.compensation.external_torque_wander.map(|wander| wander / file.gear.rated_torque);
        let counts = |noise: Option<f64>| noise.map(|noise| noise / resolution(19));
        Self {
            wander: own.unwrap_or(WANDER.get()),
            friction: FRICTION_NOISE.get(),
            jitter: counts(file.sensors.motor_encoder_noise).unwrap_or(ENCODER_NOISE.get() * FRAC_1_SQRT_2),
            output_jitter: counts(file.sensors.output_encoder_noise).unwrap_or(ENCODER_NOISE.get()),
        }
    }
}

/// Least noise of a torque, as a fraction of the rated one: a torque that is exactly known has no filter.
const LEAST_NOISE: f64 = 1e-3;
/// Torsion that makes the unit of each state (rad).
const UNIT: f64 = 1e-5;

/// Meaning of the sixth state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sixth {
    /// There is none: it would not be observable.
    None,
    /// s: the motor moves.
    Stiffness,
    /// b: the motor stands.
    Held,
}

/// One sensor: how it reads the state, and the variance of its noise.
#[derive(Clone, Debug)]
pub(super) struct Sensor {
    pub row: RowDVector<f64>,
    pub variance: f64,
}

/// The linearised gear in scaled states.
#[derive(Clone, Debug)]
pub(super) struct Linearised {
    pub transition: DMatrix<f64>,
    pub noise: DMatrix<f64>,
    /// SI units of each state's unit.
    pub units: DVector<f64>,
    /// Motor encoder, strain gauge, output encoder.
    pub sensors: [Sensor; 3],
    /// Torsion (rad) and transmitted torque (N m).
    pub torsion: RowDVector<f64>,
    pub transmitted: RowDVector<f64>,
}

/// Standard deviation of an encoder's noise (rad).
fn encoder_noise(bits: u32, jitter: f64) -> f64 {
    (resolution(bits).powi(2) / 12.0 + (jitter * resolution(19)).powi(2)).sqrt()
}

/// One count (rad).
pub(super) fn resolution(bits: u32) -> f64 {
    std::f64::consts::TAU / 2f64.powi(bits.cast_signed())
}

impl Linearised {
    pub(super) fn of(file: &GearFile, sixth: Sixth, unknown: &Unknown) -> Self {
        let size = if sixth == Sixth::None { 5 } else { 6 };
        let units = DVector::from_row_slice(&units(file, sixth)[..size]);
        let scaled = |row: [f64; 6]| RowDVector::from_fn(size, |_, k| row[k] * units[k]);
        let rows = transition(file, sixth);
        let transition =
            DMatrix::from_fn(size, size, |row, column| rows[row][column] * units[column] / units[row]);
        let noise = process_noise(file, sixth, unknown);
        let variances = DVector::from_fn(size, |k, _| noise[k] / units[k].powi(2));
        let torque_noise = file.sensors.output_torque_noise.max(LEAST_NOISE * file.gear.rated_torque);
        let sensor = |row, deviation: f64| Sensor { row: scaled(row), variance: deviation.powi(2) };
        let r: f64 = file.gear.signed_ratio().value();
        let transmitted = torque(file, sixth);
        let bits = file.sensors.motor_encoder_bits;
        let encoder = |bits| encoder_noise(bits, unknown.jitter);
        // Averaged over the same time: the fewer readings it has, the more each of them says.
        let output_jitter =
            unknown.output_jitter / f64::from(file.sensors.output_encoder_period.max(SLOW_PERIODS)).sqrt();
        Self {
            transition,
            noise: DMatrix::from_diagonal(&variances),
            sensors: [
                sensor(unit(0), encoder(bits)),
                sensor(transmitted, torque_noise),
                sensor(unit(2), encoder_noise(file.sensors.output_bits(), output_jitter)),
            ],
            torsion: scaled([r, 0.0, -1.0, 0.0, 0.0, 0.0]),
            transmitted: scaled(transmitted),
            units,
        }
    }
}

/// Optimal gain of one sensor.
pub(super) fn optimal(sensor: &Sensor, covariance: &DMatrix<f64>) -> DVector<f64> {
    let read = covariance * sensor.row.transpose();
    let variance = (&sensor.row * &read)[(0, 0)] + sensor.variance;
    read / variance
}

pub(super) fn information<'a>(sensors: impl Iterator<Item = &'a Sensor>, size: usize) -> DMatrix<f64> {
    sensors.fold(DMatrix::zeros(size, size), |sum, s| sum + s.row.transpose() * &s.row / s.variance)
}

fn unit(k: usize) -> [f64; 6] {
    std::array::from_fn(|column| f64::from(u8::from(column == k)))
}

/// a + factor*b
fn plus(a: [f64; 6], factor: f64, b: [f64; 6]) -> [f64; 6] {
    std::array::from_fn(|k| a[k] + factor * b[k])
}

fn units(file: &GearFile, sixth: Sixth) -> [f64; 6] {
    let n: f64 = f64::from(file.gear.signed_ratio().n()).abs();
    let frequency = (file.stiffness.k1 / file.inertia.flexspline).sqrt();
    let torque = UNIT * file.stiffness.k1;
    let last = if sixth == Sixth::Held { torque / n } else { torque };
    [n * UNIT, n * UNIT * frequency, UNIT, UNIT * frequency, torque, last]
}

/// tau_t of the state.
fn torque(file: &GearFile, sixth: Sixth) -> [f64; 6] {
    let r: f64 = file.gear.signed_ratio().value();
    let (k1, inertia) = (file.stiffness.k1, file.inertia.flexspline);
    let damping = 2.0 * file.damping.torsion_mode_ratio * (k1 * inertia).sqrt();
    let stiffness_torque = f64::from(u8::from(sixth == Sixth::Stiffness));
    [k1 * r, damping * r, -k1, -damping, 0.0, stiffness_torque]
}

/// One period of the observer of the linearised gear.
fn transition(file: &GearFile, sixth: Sixth) -> [[f64; 6]; 6] {
    let dt = DT;
    let r: f64 = file.gear.signed_ratio().value();
    let viscous = [&file.friction.input, &file.friction.output].map(|side| side.viscous.unwrap_or_default());
    let held = f64::from(u8::from(sixth == Sixth::Held));
    let torque = torque(file, sixth);
    let on_motor = plus(plus(unit(5).map(|x| held * x), -r, torque), -viscous[0], unit(1));
    let on_flange = plus(plus(unit(4), 1.0, torque), -viscous[1], unit(3));
    let motor_speed = plus(unit(1), dt / file.inertia.wave_generator, on_motor);
    let flange_speed = plus(unit(3), dt / file.inertia.flexspline, on_flange);
    [
        plus(unit(0), dt, motor_speed),
        motor_speed,
        plus(unit(2), dt, flange_speed),
        flange_speed,
        unit(4),
        unit(5),
    ]
}

/// Variances of what one period of the observer adds that the model does not know.
fn process_noise(file: &GearFile, sixth: Sixth, unknown: &Unknown) -> [f64; 6] {
    let dt = DT;
    let r: f64 = file.gear.signed_ratio().value();
    let least = LEAST_NOISE * file.gear.rated_torque;
    let friction = |side: &Friction| unknown.friction * side.coulomb.unwrap_or_default();
    let motor = file.sensors.motor_torque_noise.hypot(friction(&file.friction.input)).max(least * r.abs());
    let output = friction(&file.friction.output).max(least);
    let speed = |torque: f64, inertia: f64| (torque / inertia * dt).powi(2) / PERIODS;
    let motor = speed(motor, file.inertia.wave_generator);
    let output = speed(output, file.inertia.flexspline);
    let wander = (unknown.wander * file.gear.rated_torque).powi(2) * dt;
    let last = if sixth == Sixth::Held { r } else { file.tolerances.stiffness / 3f64.sqrt() };
    [motor * dt * dt, motor, output * dt * dt, output, wander, last * last * wander]
}
