//! Observer gains: the steady-state Kalman filter of the linearised two-mass gear, for each set of sensors.
//!
//! ```text
//! x = [theta_wg, omega_wg, theta_fs, omega_fs, d],   x(k+1) = A x + w,   y = C x + v
//! torsion phi = r*theta_wg - theta_fs,               tau_t = K1*phi + c*dphi
//! ```
//!
//! A is one semi-implicit Euler step of the control period dt, as in the observer itself; friction
//! enters as noise, but for its viscous part. The filter's Riccati equation is solved by
//! structure-preserving doubling (Chu, Fan, Lin and Wang, Int. J. Control 77, 2004), which squares the number
//! of filter steps with every iteration.
//!
//! Noise: encoders by their resolution (q/sqrt(12)) plus 2 counts of jitter of a 19-bit encoder; motor
//! torque and strain gauge by the gear file; what the model does not know: a fifth of the Coulomb friction
//! of either side, renewed every control period, and an external torque that wanders in a second by what the gear
//! file says, the rated torque when it says nothing. Units: rad, rad/s, N m; signs as in [`strainwave::gear`].

use nalgebra::{Matrix5, RowVector5};
use strainwave::compensator::observer::{Correction, Gains};
use strainwave::{Error, Real};

use crate::gear_file::GearFile;
use crate::joint::CONTROL_PERIOD;

/// Share of the Coulomb friction that the model does not know.
const UNKNOWN_FRICTION: f64 = 0.2;
/// Doublings: 2^40 filter steps, far beyond steady state.
const DOUBLINGS: usize = 40;

/// One sensor: how it reads the state, and the variance of its noise.
#[derive(Clone, Copy)]
struct Sensor {
    row: RowVector5<f64>,
    variance: f64,
}

/// Gains without further sensors, with output encoder, with strain gauge, with both.
///
/// # Errors
/// [`Error::OutOfRange`] `gains` when the Riccati equation has no finite solution.
pub fn gains<R: Real>(file: &GearFile) -> Result<[Gains<R>; 4], Error> {
    let [motor, output, torque] = sensors(file);
    let mut sets = [Gains::default(); 4];
    for (k, set) in sets.iter_mut().enumerate() {
        let (has_output, has_torque) = (k & 1 != 0, k & 2 != 0);
        let mut used = vec![motor];
        used.extend(has_output.then_some(output));
        used.extend(has_torque.then_some(torque));
        let mut columns = filter_gains(file, &used).ok_or(Error::OutOfRange("gains"))?.into_iter();
        let mut next = |present: bool| if present { columns.next() } else { None }.unwrap_or_default();
        *set = Gains {
            motor: to_real(next(true)),
            output: to_real(next(has_output)),
            torque: to_real(next(has_torque)),
        };
    }
    Ok(sets)
}

fn to_real<R: Real>(column: [f64; 5]) -> Correction<R> {
    column.map(R::lit)
}

fn sensors(file: &GearFile) -> [Sensor; 3] {
    let r: f64 = file.gear.signed_ratio().value();
    let k1 = file.stiffness.k1;
    let resolution = |bits: u32| std::f64::consts::TAU / 2f64.powi(bits.cast_signed());
    let encoder = |bits: u32| resolution(bits).powi(2) / 12.0 + (2.0 * resolution(19)).powi(2);
    let bits = file.sensors.motor_encoder_bits;
    [
        Sensor { row: RowVector5::new(1.0, 0.0, 0.0, 0.0, 0.0), variance: encoder(bits) },
        Sensor {
            row: RowVector5::new(0.0, 0.0, 1.0, 0.0, 0.0),
            variance: encoder(file.sensors.output_encoder_bits.unwrap_or(bits)),
        },
        Sensor {
            row: RowVector5::new(k1 * r, 0.0, -k1, 0.0, 0.0),
            variance: file.sensors.output_torque_noise.powi(2),
        },
    ]
}

/// One control period of the linearised gear.
fn transition(file: &GearFile) -> Matrix5<f64> {
    let dt = CONTROL_PERIOD;
    let r: f64 = file.gear.signed_ratio().value();
    let (k1, jw, jf) = (file.stiffness.k1, file.inertia.wave_generator, file.inertia.flexspline);
    let damping = 2.0 * file.damping.torsion_mode_ratio * (k1 * jf).sqrt();
    let torque = RowVector5::new(k1 * r, damping * r, -k1, -damping, 0.0);
    let unit = |k: usize| RowVector5::from_fn(|_, column| if column == k { 1.0 } else { 0.0 });
    let motor_speed =
        unit(1) - (torque * r + unit(1) * file.friction.input.viscous.unwrap_or_default()) * (dt / jw);
    let flange_speed =
        unit(3) + (torque - unit(3) * file.friction.output.viscous.unwrap_or_default() + unit(4)) * (dt / jf);
    Matrix5::from_rows(&[
        unit(0) + motor_speed * dt,
        motor_speed,
        unit(2) + flange_speed * dt,
        flange_speed,
        unit(4),
    ])
}

/// Covariance of what one control period adds that the model does not know.
fn process_noise(file: &GearFile) -> Matrix5<f64> {
    let dt = CONTROL_PERIOD;
    let motor_torque =
        file.sensors.motor_torque_noise + UNKNOWN_FRICTION * file.friction.input.coulomb.unwrap_or_default();
    let output_torque = UNKNOWN_FRICTION * file.friction.output.coulomb.unwrap_or_default();
    let speed = |torque: f64, inertia: f64| (torque / inertia * dt).powi(2);
    let motor = speed(motor_torque, file.inertia.wave_generator);
    let output = speed(output_torque, file.inertia.flexspline);
    let wander = file.compensation.external_torque_wander.unwrap_or(file.gear.rated_torque).powi(2) * dt;
    Matrix5::from_diagonal(&[motor * dt * dt, motor, output * dt * dt, output, wander].into())
}

/// Steady-state gain columns of the filter, one per sensor; `None` without a finite solution.
fn filter_gains(file: &GearFile, sensors: &[Sensor]) -> Option<Vec<[f64; 5]>> {
    let information: Matrix5<f64> = sensors.iter().map(|s| s.row.transpose() * s.row / s.variance).sum();
    let predicted = riccati(transition(file).transpose(), information, process_noise(file))?;
    // The gain P C' (C P C' + R)^-1 = (P^-1 + C' R^-1 C)^-1 C' R^-1.
    let corrected = (Matrix5::identity() + predicted * information).try_inverse()? * predicted;
    sensors
        .iter()
        .map(|s| <[f64; 5]>::from(corrected * s.row.transpose() / s.variance))
        .map(|column| column.iter().all(|gain| gain.is_finite()).then_some(column))
        .collect()
}

/// Stabilising solution of X = A' X (I + G X)^-1 A + H by doubling.
fn riccati(mut a: Matrix5<f64>, mut g: Matrix5<f64>, mut h: Matrix5<f64>) -> Option<Matrix5<f64>> {
    for _ in 0..DOUBLINGS {
        let inverse = (Matrix5::identity() + g * h).try_inverse()?;
        let next_h = h + a.transpose() * h * inverse * a;
        g += a * inverse * g * a.transpose();
        a = a * inverse * a;
        let change = (next_h - h).norm() / next_h.norm();
        h = (next_h + next_h.transpose()) * 0.5;
        g = (g + g.transpose()) * 0.5;
        if change < 1e-13 {
            break;
        }
    }
    h.iter().all(|x| x.is_finite()).then_some(h)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every set of sensors, as [`gains`] combines them.
    fn sensor_sets(file: &GearFile) -> Vec<Vec<Sensor>> {
        let [motor, output, torque] = sensors(file);
        vec![vec![motor], vec![motor, output], vec![motor, torque], vec![motor, output, torque]]
    }

    fn information(sensors: &[Sensor]) -> Matrix5<f64> {
        sensors.iter().map(|s| s.row.transpose() * s.row / s.variance).sum()
    }

    /// Entries of X span 20 decades, so each is compared on the scale of its own two states.
    #[test]
    fn the_riccati_solution_satisfies_its_equation() {
        let file = GearFile::default_gear();
        let (a, h) = (transition(&file).transpose(), process_noise(&file));
        for sensors in sensor_sets(&file) {
            let g = information(&sensors);
            let x = riccati(a, g, h).unwrap();
            let again = a.transpose() * x * (Matrix5::identity() + g * x).try_inverse().unwrap() * a + h;
            for row in 0..5 {
                for column in 0..5 {
                    let scale = (x[(row, row)] * x[(column, column)]).sqrt();
                    let residual = (again - x)[(row, column)].abs() / scale;
                    assert!(residual < 1e-6, "{residual:e} at {row}, {column}");
                }
            }
            assert!(x.cholesky().is_some(), "a covariance is positive definite");
        }
    }

    /// The error of the observer obeys e(k+1) = (1 - L C) A e(k).
    #[test]
    fn the_observer_forgets_its_errors() {
        let file = GearFile::default_gear();
        let all: [Gains<f64>; 4] = gains(&file).unwrap();
        for (k, set) in all.iter().enumerate() {
            let [motor, output, torque] = sensors(&file);
            let correction = [(motor, set.motor), (output, set.output), (torque, set.torque)]
                .into_iter()
                .map(|(sensor, column)| nalgebra::Vector5::from(column) * sensor.row)
                .sum::<Matrix5<f64>>();
            let error = (Matrix5::identity() - correction) * transition(&file);
            let slowest = error.complex_eigenvalues().iter().map(|z| z.norm()).fold(0.0, f64::max);
            // Within 0.1 s an error is below a thousandth.
            assert!(slowest.powi(1000) < 1e-3, "set {k}: {slowest}");
        }
    }

    /// Alone, the linearised gear forgets neither its angle nor the external torque.
    #[test]
    fn without_correction_nothing_is_forgotten() {
        let a = transition(&GearFile::default_gear());
        let slowest = a.complex_eigenvalues().iter().map(|z| z.norm()).fold(0.0, f64::max);
        assert!(slowest > 1.0 - 1e-6, "{slowest}");
    }
}
