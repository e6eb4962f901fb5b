//! How much of P and D of the output encoder's angle ([`strainwave::compensator::reference::measured_feedback`]) a joint bears: their gain
//! margin in the loop of cascade, rotor, gear and load.
//!
//! ```text
//! S      = K + 2*zeta*sqrt(K*J)*s,   H = S/(J*s^2 + S)                                        load on its spring
//! C      = n^2*c*k_v*(1 + 1/(T_i*s))*omega_c/(s + omega_c)*e^(-s*T)                           cascade and drive
//! G      = k_p*C*H/(n^2*J_wg*s^2 + S*(1 - H) + C*(k_p + s*omega_f/(s + omega_f)))             shift to output
//! L      = (P + D*s*omega_m/(s + omega_m))*e^(-s*T_m)*G
//! ```
//!
//! c is the torque constant over the file's, omega_c the corner of the current loop, T the drive's delay and a control period for the
//! hold and the difference quotient, T_m the encoder's own delay and one and a half periods: half of one, as P and D are held for two,
//! and one for D's difference quotient. Friction, which damps, is left out. Above the
//! torsion mode the load moves against the motor, and a cascade that still follows there turns P and D to its excitation: the
//! lighter the load, the less of them the joint bears.
//!
//! The margin is the least factor on L with which it passes through -1, in the worst corner of the box of the file's `[tolerances]`
//! and `[drive]`: the slowest drive, or for a mode far above the cascade's bandwidth the fastest. Units: rad, rad/s, s, N m at the
//! output.

use std::f64::consts::TAU;

use nalgebra::Complex;
use strainwave::compensator::schedule::CONTROL_PERIOD;

use super::corners::Corner;
use super::feedback::feedback_params;
use super::mode::Mode;
use crate::io::gear_file::GearFile;

/// Ends of the frequencies that are looked at, in torsion modes of the nominal joint, and their number.
const RANGE: [f64; 2] = [0.05, 50.0];
const FREQUENCIES: u32 = 200;
/// Largest turn of L between two frequencies (rad), to which they are halved, so often at most: a mode that hardly is damped turns it by
/// half a revolution within a thousandth of its frequency.
const TURN: f64 = 0.1;
const HALVINGS: u32 = 12;

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

/// The corners without a mode behind the flange.
fn corners(file: &GearFile) -> impl Iterator<Item = Corner> {
    Corner::all(file, Mode::Moving).into_iter().filter(|corner| corner.link.is_none())
}

/// Largest factor on the gains up to which the loop is stable in a corner.
fn margin(file: &GearFile, gains: Gains, corner: &Corner) -> f64 {
    let mode = (file.stiffness.k1 / file.inertia.flexspline).sqrt();
    let ratio = RANGE[1] / RANGE[0];
    let frequency = |k: u32| RANGE[0] * mode * ratio.powf(f64::from(k) / f64::from(FREQUENCIES - 1));
    let frequencies: Vec<_> = (0..FREQUENCIES).map(frequency).collect();
    least_factor(&frequencies, |omega| open_loop(file, gains, corner, omega))
}

/// Least factor on L with which it passes through -1 between the first and the last of these frequencies.
fn least_factor(frequencies: &[f64], l: impl Fn(f64) -> Complex<f64>) -> f64 {
    let points: Vec<_> = frequencies.iter().map(|omega| (*omega, l(*omega))).collect();
    points.windows(2).map(|pair| between(pair[0], pair[1], &l, HALVINGS)).fold(f64::INFINITY, f64::min)
}

/// The same between two neighbours.
fn between(
    a: (f64, Complex<f64>),
    b: (f64, Complex<f64>),
    l: &impl Fn(f64) -> Complex<f64>,
    halvings: u32,
) -> f64 {
    if halvings > 0 && (b.1 / a.1).arg().abs() > TURN {
        let middle = (a.0 * b.0).sqrt();
        let middle = (middle, l(middle));
        return between(a, middle, l, halvings - 1).min(between(middle, b, l, halvings - 1));
    }
    let [(_, a), (_, b)] = [a, b];
    if (a.im < 0.0) == (b.im < 0.0) {
        return f64::INFINITY;
    }
    let there = a.re + a.im / (a.im - b.im) * (b.re - a.re);
    if there < 0.0 { -1.0 / there } else { f64::INFINITY }
}

/// L at a frequency (rad/s).
fn open_loop(file: &GearFile, gains: Gains, corner: &Corner, omega: f64) -> Complex<f64> {
    let (s, n, cascade) =
        (Complex::new(0.0, omega), f64::from(file.gear.ratio), feedback_params::<f64>(file));
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
    let measured = late(1.5 + f64::from(file.sensors.output_encoder_delay));
    (gains.proportional + gains.derivative * s * lag(gains.corner)) * measured * followed
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
        let (mut torques, mut readings) = (line(corner.delay as f64 + 1.0), line(1.5));
        let [mut motor, mut output] = [[0.0, 0.0], [1e-4, 0.0]];
        let (mut filtered, mut speed, mut integral, mut torque) = (0.0, 0.0, 0.0, 0.0);
        let mut largest = [0.0f64; 2];
        for k in 0..(1.0 / DT) as usize {
            readings.push_back(output[0]);
            let reading = readings.pop_front().unwrap();
            let change = DT * gains.corner * (reading - filtered);
            filtered += change;
            let shift = -(gains.proportional * reading + gains.derivative * change / DT);
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
            let lag = |omega: f64| 1.0 / Complex::new(1.0, omega);
            least_factor(&[0.1, 1.0, 10.0], |omega| gain * lag(omega) * lag(omega) * lag(omega))
        };
        // g/(s+1)^3 bears the gain 8.
        assert!(
            (lags(1.0) / 8.0 - 1.0).abs() < 1e-2 && (lags(20.0) / 0.4 - 1.0).abs() < 1e-2,
            "{}",
            lags(1.0)
        );
        // A mode of the damping ratio 1e-3 turns a sign that is wrong through the critical point, at 1/(2*1e-3).
        let mode = |omega: f64| Complex::new(0.0, -1.0) / Complex::new(1.0 - omega * omega, 2e-3 * omega);
        assert!((least_factor(&[0.5, 2.0], mode) / 2e-3 - 1.0).abs() < 1e-2);
    }
}
