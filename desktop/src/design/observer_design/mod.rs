//! Observer gains and deviations: the steady-state Kalman filter of the linearised two-mass gear, for each set of
//! sensors.
//!
//! A set's filter corrects by the motor encoder, then by the strain gauge, then by the output encoder, each gain from
//! the covariance that the one before left. An output encoder is looked at every m-th period of the observer only:
//! the filter between two readings is that without it, F = (1 - l C) A, so that an encoder that fails leaves a filter
//! that is sound; the reading's gain is that of the system over m periods, A -> F^m. A reading that is D periods late
//! corrects by F^D of its gain ([`strainwave::compensator::estimate::observer::past`]). Units: rad, rad/s, N m; signs as in
//! [`strainwave::gear`].

mod followed_load;
mod linearised;
mod riccati;
#[cfg(test)]
mod tests;

use nalgebra::{DMatrix, DVector};
use strainwave::compensator::EstimateDeviation;
use strainwave::compensator::estimate::observer::deviation::{Spread, Uncertainty};
use strainwave::compensator::estimate::observer::past::STEPS;
use strainwave::compensator::estimate::observer::{Correction, GainSets, Gains, ObserverParams, STATES};
use strainwave::compensator::schedule::{OBSERVER_PERIODS, SLOW_PERIODS};
use strainwave::compensator::tuned::{ENCODER_NOISE, SLOW_RATE};
use strainwave::{Error, Real};

use crate::design::tuned::FRICTION_NOISE;
use crate::io::gear_file::{Friction, GearFile};
use followed_load::designed;
use linearised::{DT, Linearised, Sensor, Sixth, Unknown, information, optimal, resolution};

/// Eigenvalue from which on a mode counts as one that the motor's encoder does not show: slower than a second.
const UNSEEN: f64 = 1.0 - 1e-4;

/// Parameters of a gear's observer.
///
/// # Errors
/// [`Error::OutOfRange`] with the set of sensors by which the gear is not observable.
pub fn observer_params<R: Real>(file: &GearFile) -> Result<ObserverParams<R>, Error> {
    let span = |fraction: f64| fraction / 3f64.sqrt();
    Ok(ObserverParams {
        moving: sets(file, Sixth::Stiffness)?,
        standing: sets(file, Sixth::Held)?,
        motion_threshold: R::lit(ENCODER_NOISE.get() * resolution(file.sensors.motor_encoder_bits.min(19))),
        output_encoder_delay: file.sensors.output_encoder_delay,
        output_encoder_period: file.sensors.output_encoder_period,
        output_count: R::lit(resolution(file.sensors.output_bits())),
        uncertainty: Uncertainty {
            friction: R::lit(span(file.tolerances.friction)),
            stiffness: R::lit(span(file.tolerances.stiffness)),
            inertia: R::lit(span(file.tolerances.load_inertia) * file.inertia.flexspline),
        },
    })
}

/// Names of the sets, as an error has them.
const NAMES: [&str; 4] = [
    "gains of the motor encoder (the gear is not observable)",
    "gains with an output encoder (the gear is not observable)",
    "gains with a strain gauge (the gear is not observable)",
    "gains with output encoder and strain gauge (the gear is not observable)",
];

/// Gains without further sensors, with output encoder, with strain gauge, with both.
fn sets<R: Real>(file: &GearFile, sixth: Sixth) -> Result<GainSets<R>, Error> {
    let mut sets = [Gains::default(); 4];
    for (k, set) in sets.iter_mut().enumerate() {
        *set = Filter::design(file, sixth, k).ok_or(Error::OutOfRange(NAMES[k]))?.gains(file);
    }
    Ok(sets)
}

/// The least error of the external torque (N m), rms over the `time` (s) that begins with a step of it by `step` (N
/// m), that a linear filter of the motor encoder, or of both encoders, can have with nothing unknown but that step.
///
/// The error's energy after a step is that filter's variance under a walk of step^2/time a second; no filter's is
/// less than that of the Kalman filter for that walk, friction, stiffness and inertia exactly known, encoders without
/// jitter.
pub fn least_load_error(file: &GearFile, step: f64, time: f64, with_output: bool) -> Option<f64> {
    let wander = step / time.sqrt() / file.gear.rated_torque;
    let model = Linearised::of(
        file,
        Sixth::None,
        &Unknown { wander, friction: 0.0, jitter: 0.0, output_jitter: 0.0 },
    );
    let sensors = [Some(&model.sensors[0]), with_output.then_some(&model.sensors[2])];
    let sensors = || sensors.iter().flatten().copied();
    let p = riccati::covariance(&model.transition, &information(sensors(), 5), &model.noise)?;
    let after = sensors().fold(p, |p, sensor| corrected(&optimal(sensor, &p), sensor, &p));
    Some(after[(4, 4)].sqrt() * model.units[4])
}

/// A filter of one set of sensors, in scaled states.
struct Filter {
    model: Linearised,
    sixth: Sixth,
    has_output: bool,
    has_torque: bool,
    /// l of motor encoder, strain gauge, output encoder; zero where absent.
    gains: [DVector<f64>; 3],
    /// F.
    between: DMatrix<f64>,
    /// Covariance of the process noise in a period between readings.
    between_noise: DMatrix<f64>,
    /// Covariance after a reading.
    after: DMatrix<f64>,
    /// Control periods from reading to reading, and by how many they are late.
    period: u32,
    delay: u32,
}

/// (1 - l c) m (1 - l c)' + l v l'
fn corrected(gain: &DVector<f64>, sensor: &Sensor, covariance: &DMatrix<f64>) -> DMatrix<f64> {
    let left = DMatrix::identity(gain.len(), gain.len()) - gain * &sensor.row;
    &left * covariance * left.transpose() + gain * gain.transpose() * sensor.variance
}

fn power(matrix: &DMatrix<f64>, exponent: u32) -> DMatrix<f64> {
    (0..exponent).fold(DMatrix::identity(matrix.nrows(), matrix.nrows()), |product, _| product * matrix)
}

impl Filter {
    /// `set`: bit 0 for the output encoder, bit 1 for the strain gauge. `None` when the gear is not observable.
    fn design(file: &GearFile, sixth: Sixth, set: usize) -> Option<Self> {
        let stands = sixth == Sixth::Held;
        let (has_output, has_torque) = (set & 1 != 0, set & 2 != 0);
        // Quantity that makes the sixth state observable.
        let sixth = match (has_output, has_torque, sixth) {
            (false, false, _) | (false, true, Sixth::Stiffness) => Sixth::None,
            _ => sixth,
        };
        let model = Linearised::of(file, sixth, &designed(file, stands));
        let sensors = &file.sensors;
        // In the observer's periods: it looks at the output once a round.
        let period = sensors.output_encoder_period.div_ceil(SLOW_PERIODS) * (SLOW_PERIODS / OBSERVER_PERIODS);
        let delay = sensors.output_encoder_delay.div_ceil(OBSERVER_PERIODS);
        let [period, delay] = if has_output { [period, delay] } else { [1, 0] };
        let mut filter = Self::without_output(model, sixth, has_output, has_torque, period, delay);
        filter.correct_between(file, set)?;
        filter.correct_output()?;
        Some(filter)
    }

    fn without_output(
        model: Linearised,
        sixth: Sixth,
        has_output: bool,
        has_torque: bool,
        period: u32,
        delay: u32,
    ) -> Self {
        let size = model.units.len();
        let none = DMatrix::zeros(size, size);
        Self {
            between: model.transition.clone(),
            between_noise: model.noise.clone(),
            model,
            sixth,
            has_output,
            has_torque,
            gains: [(); 3].map(|()| DVector::zeros(size)),
            after: none,
            period,
            delay,
        }
    }

    /// Sensors that are there: motor encoder, strain gauge, output encoder.
    fn present(&self) -> [bool; 3] {
        [true, self.has_torque, self.has_output]
    }

    /// Gains of motor encoder and strain gauge, and with them F.
    fn correct_between(&mut self, file: &GearFile, set: usize) -> Option<()> {
        if self.period > 1 {
            let without = Self::design(file, self.sixth, set & !1)?;
            for k in 0..2 {
                let rows = without.gains[k].len();
                self.gains[k].rows_mut(0, rows).copy_from(&without.gains[k]);
                let units = without.model.units.component_div(&self.model.units.rows(0, rows));
                self.gains[k].rows_mut(0, rows).component_mul_assign(&units);
            }
        } else {
            let (size, present) = (self.model.units.len(), self.present());
            let used = (0..3).filter(|&k| present[k]).map(|k| &self.model.sensors[k]);
            let information = information(used, size);
            let mut p = riccati::covariance(&self.model.transition, &information, &self.model.noise)?;
            for k in (0..2).filter(|&k| present[k]) {
                self.gains[k] = optimal(&self.model.sensors[k], &p);
                p = corrected(&self.gains[k], &self.model.sensors[k], &p);
            }
            self.after = p;
        }
        for k in 0..2 {
            let (gain, sensor) = (&self.gains[k], &self.model.sensors[k]);
            self.between -= gain * (&sensor.row * &self.between);
            self.between_noise = corrected(gain, sensor, &self.between_noise);
        }
        Some(())
    }

    /// Gain of the output encoder, and the covariance that it leaves.
    fn correct_output(&mut self) -> Option<()> {
        if !self.has_output {
            return Some(());
        }
        let (sensor, size) = (&self.model.sensors[2], self.model.units.len());
        let noise = (0..self.period).fold(DMatrix::zeros(size, size), |sum, _| self.later(&sum));
        let transition = power(&self.between, self.period);
        let p = riccati::covariance(&transition, &information([sensor].into_iter(), size), &noise)?;
        self.gains[2] = optimal(sensor, &p);
        self.after = corrected(&self.gains[2], sensor, &p);
        Some(())
    }

    /// Covariance a period later, without reading of the output.
    fn later(&self, p: &DMatrix<f64>) -> DMatrix<f64> {
        &self.between * p * self.between.transpose() + &self.between_noise
    }

    /// Slowest mode of what the external torque is followed by (control periods): that of the motor's encoder, which
    /// sees a load first; the output's only takes the offsets away.
    fn settling(&self) -> f64 {
        let one = DMatrix::identity(self.after.nrows(), self.after.nrows());
        let seen = (one - &self.gains[0] * &self.model.sensors[0].row) * &self.model.transition;
        let norms = seen.complex_eigenvalues().map(|z| z.norm());
        // What the motor's encoder does not show, the stiffness, stays where it is.
        let slowest = norms.iter().copied().filter(|norm| *norm < UNSEEN).fold(0.0, f64::max);
        -1.0 / slowest.ln()
    }

    fn gains<R: Real>(&self, file: &GearFile) -> Gains<R> {
        let [motor, torque, output] = &self.gains;
        let late = power(&self.between, self.delay) * output;
        let past = |periods: usize| {
            let there = self.has_output && periods < self.delay as usize;
            let after = || (power(&self.between, periods as u32 + 1) * output)[2] * self.model.units[2];
            R::lit(if there { after() } else { 0.0 })
        };
        Gains {
            motor: self.correction(motor),
            torque: self.correction(torque),
            output: self.correction(&late),
            past: std::array::from_fn::<_, STEPS, _>(past),
            spread: self.spread(file),
        }
    }

    /// In SI units.
    fn correction<R: Real>(&self, gain: &DVector<f64>) -> Correction<R> {
        std::array::from_fn::<_, STATES, _>(|k| {
            R::lit(gain.get(k).map_or(0.0, |entry| entry * self.model.units[k]))
        })
    }

    /// Coefficients of the standard deviations; the covariance is the largest one, just before a late reading.
    fn spread<R: Real>(&self, file: &GearFile) -> Spread<R> {
        let p = (1..self.period + self.delay).fold(self.after.clone(), |p, _| self.later(&p));
        let state = |k: usize| p[(k, k)].sqrt() * self.model.units[k];
        let of = |row: &nalgebra::RowDVector<f64>| (row * &p * row.transpose())[(0, 0)].sqrt();
        let (n, rated) = (f64::from(file.gear.signed_ratio().n()).abs(), file.gear.rated_torque);
        let inertia = file.inertia.flexspline;
        let settling = self.settling();
        let time = settling * DT;
        let standing = self.sixth == Sixth::Held;
        let moving_balance = !(self.has_torque || standing && self.has_output);
        let blind = !self.has_output && !self.has_torque;
        // Each encoder's zero is known to half a count; of a resting output a count more is taken for nothing.
        // A friction of which no path is known is anywhere within its static level.
        let unknown = 1.0 / 3f64.sqrt();
        let at_rest = if standing { unknown } else { FRICTION_NOISE.get() };
        let counts = if standing { 1.5 } else { 0.5 };
        let zero = if self.has_output { counts * resolution(file.sensors.output_bits()) } else { 0.0 };
        let static_level = |side: &Friction| side.static_level.or(side.coulomb).unwrap_or_default();
        let fraction = |condition: bool, value: f64| R::lit(if condition { value } else { 0.0 });
        Spread {
            base: EstimateDeviation {
                output_position: R::lit(state(2) + zero),
                output_velocity: R::lit(state(3)),
                torsion: R::lit(of(&self.model.torsion) + zero),
                transmitted_torque: R::lit(of(&self.model.transmitted)),
                input_friction: R::lit(at_rest * static_level(&file.friction.input)),
                output_friction: R::lit(unknown * static_level(&file.friction.output)),
                external_torque: R::lit(state(4)),
            },
            torque_by_friction: fraction(moving_balance, n),
            torque_by_stiffness: fraction(!self.has_torque && !moving_balance, 1.0),
            angle_by_stiffness: fraction(!self.has_output, 1.0),
            angle_by_torque: R::lit(if self.has_output {
                0.5 * time * time / inertia
            } else {
                1.0 / file.stiffness.k1
            }),
            velocity_by_torque: R::lit(time / inertia),
            unobserved: [fraction(blind, SLOW_RATE.get() * rated * DT), fraction(blind, unknown * rated)],
            settling: R::lit(settling),
            inverse_settling: R::lit(1.0 / settling),
            inverse_sliding_speed: R::lit(
                1.0 / file.friction.output.stribeck_velocity.unwrap_or(f64::INFINITY),
            ),
        }
    }
}
