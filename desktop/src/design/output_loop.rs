//! How much of P and D of the output encoder's angle ([`strainwave::compensator::reference::measured_feedback`]) a joint bears: their gain
//! margin in the loop of cascade, rotor, gear and load.
//!
//! ```text
//! S      = K + 2*zeta*sqrt(K*J)*s,   H = S/(J*s^2 + S)                                        load on its spring
//! C      = n^2*c*k_v*(1 + 1/(T_i*s))*omega_c/(s + omega_c)*e^(-s*T)                           cascade and drive
//! G      = k_p*C*H/(n^2*J_wg*s^2 + S*(1 - H) + C*(k_p + s*omega_f/(s + omega_f)))             shift to output
//! L      = (P + D*s)*omega_m/(s + omega_m)*e^(-s*T_m)*G
//! ```
//!
//! c is the torque constant over the file's, omega_c the slowest current loop, T the drive's longest delay and a control period for the
//! hold and the difference quotient, T_m half a period and the encoder's own delay. Friction, which damps, is left out. Above the
//! torsion mode the load moves against the motor, and a cascade that still follows there turns P and D to its excitation: the
//! lighter the load, the less of them the joint bears.
//!
//! The margin is the least factor on L with which it passes through -1, in the worst corner of the box of the file's `[tolerances]`
//! and `[drive]`. Units: rad, rad/s, s, N m at the output.

use std::f64::consts::TAU;

use nalgebra::Complex;
use strainwave::compensator::schedule::CONTROL_PERIOD;

use super::corners::Corner;
use super::feedback::feedback_params;
use super::mode::Mode;
use crate::io::gear_file::GearFile;

/// Ends of the frequencies that are looked at, in torsion modes of the nominal joint, and their number.
const RANGE: [f64; 2] = [0.05, 50.0];
const FREQUENCIES: u32 = 600;

/// P, D (s) and omega_m (rad/s).
#[derive(Clone, Copy, Debug)]
pub(super) struct Gains {
    pub proportional: f64,
    pub derivative: f64,
    pub corner: f64,
}

/// Fraction of these gains, 0..=1, with which the joint is stable in every corner of its box.
pub(super) fn level(file: &GearFile, gains: Gains) -> f64 {
    corners(file).map(|corner| margin(file, gains, &corner)).fold(1.0, f64::min)
}

/// The corners, all with the slowest drive.
fn corners(file: &GearFile) -> impl Iterator<Item = Corner> {
    let slowest = |corner: &Corner| {
        corner.link.is_none()
            && corner.delay == file.drive.delay as usize
            && corner.bandwidth == file.drive.least_current_loop
    };
    Corner::all(file, Mode::Moving).into_iter().filter(slowest)
}

/// Largest factor on the gains up to which the loop is stable in a corner.
fn margin(file: &GearFile, gains: Gains, corner: &Corner) -> f64 {
    let mode = (file.stiffness.k1 / file.inertia.flexspline).sqrt();
    let ratio = RANGE[1] / RANGE[0];
    let frequency =
        |k: u32| RANGE[0] * mode * ratio.powf(f64::from(k) / f64::from(FREQUENCIES - 1));
    let response = |k: u32| (frequency(k), open_loop(file, gains, corner, frequency(k)));
    let points: Vec<_> = (0..FREQUENCIES).map(response).collect();
    least_factor(&points)
}

/// Least factor on L with which it passes through -1.
fn least_factor(points: &[(f64, Complex<f64>)]) -> f64 {
    let crossing = |pair: &[(f64, Complex<f64>)]| {
        let [(_, a), (_, b)] = [pair[0], pair[1]];
        let fraction = a.im / (a.im - b.im);
        let there = a.re + fraction * (b.re - a.re);
        (a.im * b.im < 0.0 && there < 0.0).then_some(-1.0 / there)
    };
    points.windows(2).filter_map(crossing).fold(f64::INFINITY, f64::min)
}

/// L at a frequency (rad/s).
fn open_loop(file: &GearFile, gains: Gains, corner: &Corner, omega: f64) -> Complex<f64> {
    let (s, n, cascade) = (Complex::new(0.0, omega), f64::from(file.gear.ratio), feedback_params::<f64>(file));
    let rotor = corner.rotor * n * n * file.inertia.wave_generator;
    let load = corner.load * file.inertia.flexspline;
    let stiffness = corner.stiffness * corner.point.stiffness(file);
    let spring = stiffness + s * 2.0 * file.damping.torsion_mode_ratio * (stiffness * load).sqrt();
    let swing = spring / (s * s * load + spring);
    let lag = |corner: f64| corner / (s + corner);
    let late = |periods: f64| (-s * periods * CONTROL_PERIOD).exp();
    let drive = lag(TAU * corner.bandwidth) * late(corner.delay as f64 + 1.0);
    let integral = 1.0 + 1.0 / (s * cascade.integral_time);
    let torque = n * n * corner.constant * cascade.velocity_gain * integral * drive;
    let speed = s * lag(cascade.filter_corner);
    let held = s * s * rotor + spring * (1.0 - swing) + torque * (cascade.position_gain + speed);
    let followed = cascade.position_gain * torque * swing / held;
    let measured = lag(gains.corner) * late(0.5 + f64::from(file.sensors.output_encoder_delay));
    (gains.proportional + gains.derivative * s) * measured * followed
}

#[cfg(test)]
mod tests {
    use std::collections::VecDeque;

    use super::*;
    use crate::catalogue::load::with_load;

    fn gains(file: &GearFile) -> Gains {
        let mode = (file.stiffness.k1 / file.inertia.flexspline).sqrt();
        Gains { proportional: 0.26, derivative: 1.1 / mode, corner: 5.0 * mode }
    }

    /// The default gear with `factor` of its load.
    fn loaded(factor: f64) -> GearFile {
        let file = GearFile::default_gear();
        with_load(&file, factor * file.inertia.flexspline)
    }

    /// Amplitude of the output over that of a quarter of a second before, with these gains in the corner; by time steps of a
    /// fiftieth of a control period.
    fn growth(file: &GearFile, gains: Gains, corner: &Corner) -> f64 {
        const DT: f64 = CONTROL_PERIOD / 50.0;
        let (n, cascade) = (f64::from(file.gear.ratio), feedback_params::<f64>(file));
        let inertias =
            [corner.rotor * n * n * file.inertia.wave_generator, corner.load * file.inertia.flexspline];
        let stiffness = corner.stiffness * corner.point.stiffness(file);
        let damping = 2.0 * file.damping.torsion_mode_ratio * (stiffness * inertias[1]).sqrt();
        let line = |periods: f64| VecDeque::from(vec![0.0; (50.0 * periods).round() as usize]);
        let (mut torques, mut readings) = (line(corner.delay as f64 + 1.0), line(0.5));
        let [mut motor, mut output] = [[0.0, 0.0], [1e-4, 0.0]];
        let (mut filtered, mut speed, mut integral, mut torque) = (0.0, 0.0, 0.0, 0.0);
        let mut largest = [0.0f64; 2];
        for k in 0..(1.0 / DT) as usize {
            readings.push_back(output[0]);
            let change = DT * gains.corner * (readings.pop_front().unwrap() - filtered);
            filtered += change;
            let shift = -(gains.proportional * filtered + gains.derivative * change / DT);
            speed += DT * cascade.filter_corner * (motor[1] - speed);
            let lag = cascade.position_gain * (shift - motor[0]) - speed;
            integral += DT * lag / cascade.integral_time;
            torques.push_back(n * n * corner.constant * cascade.velocity_gain * (lag + integral));
            torque += DT * TAU * corner.bandwidth * (torques.pop_front().unwrap() - torque);
            let spring = stiffness * (motor[0] - output[0]) + damping * (motor[1] - output[1]);
            motor[1] += DT * (torque - spring) / inertias[0];
            output[1] += DT * spring / inertias[1];
            motor[0] += DT * motor[1];
            output[0] += DT * output[1];
            let quarter = k as f64 * DT;
            if quarter >= 0.5 {
                let place = usize::from(quarter >= 0.75);
                largest[place] = largest[place].max(output[0].abs());
            }
        }
        largest[1] / largest[0]
    }

    /// A little below its margin the loop of differential equations comes to rest, a little above it swings up.
    #[test]
    fn at_its_margin_a_loop_neither_decays_nor_grows() {
        for factor in [0.05, 0.15] {
            let file = loaded(factor);
            let gains = gains(&file);
            let corner = corners(&file)
                .min_by(|a, b| margin(&file, gains, a).total_cmp(&margin(&file, gains, b)))
                .unwrap();
            let margin = margin(&file, gains, &corner);
            let times = |factor: f64| Gains {
                proportional: factor * margin * gains.proportional,
                derivative: factor * margin * gains.derivative,
                ..gains
            };
            let [below, above] = [0.9, 1.1].map(|factor| growth(&file, times(factor), &corner));
            assert!(below < 0.9 && above > 1.1, "{factor}: {margin} {below} {above}");
        }
    }

    #[test]
    fn a_light_load_bears_less() {
        let level = |factor: f64| {
            let file = loaded(factor);
            level(&file, gains(&file))
        };
        let levels = [1.0, 0.2, 0.1, 0.05].map(level);
        assert!(levels[0] == 1.0 && levels.is_sorted_by(|heavier, lighter| heavier >= lighter), "{levels:?}");
        assert!(levels[3] < 0.5, "{levels:?}");
    }

    #[test]
    fn what_turns_by_half_a_revolution_passes_through_the_critical_point() {
        let lags = |gain: f64| {
            let at = |omega: f64| gain / (Complex::new(1.0, omega) * Complex::new(1.0, omega) * Complex::new(1.0, omega));
            (0..4000).map(|k| 1e-3 * f64::from(k)).map(|omega| (omega, at(omega))).collect::<Vec<_>>()
        };
        // g/(s+1)^3 bears the gain 8.
        assert!((least_factor(&lags(1.0)) - 8.0).abs() < 1e-3 && (least_factor(&lags(20.0)) - 0.4).abs() < 1e-4);
    }
}
