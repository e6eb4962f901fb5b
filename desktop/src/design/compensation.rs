//! Parameters of the compensator's adaptation, output feedback and learnt ripple, for the joint of a gear file.
//!
//! Output feedback ([`strainwave::compensator::reference::output_feedback`] by the estimate,
//! [`strainwave::compensator::reference::measured_feedback`] by the output encoder): with the torsion mode's frequency
//! omega = sqrt(K1/J_fs), `b = 2*zeta/omega` adds the damping ratio zeta, D alike; omega_y is omega, omega_m a multiple of it. The
//! multiples were chosen by simulation, of the default gear and of training joints of the catalogue.
//!
//! Of P and D a joint has as much as is stable in every corner of its box (`output_loop.rs`). Of b it has what the lag at the mode
//! allows: the motor follows a shift of its reference late, by
//!
//! ```text
//! phase = atan(omega_3/omega_v) + omega_3*T,   omega_3 = sqrt(K3/J_fs)
//! ```
//!
//! omega_v is the bandwidth of the velocity loop, T the delay from a torque to the reference and half a round. From 90 degrees on the
//! shift takes damping away. So b is whole up to 60 degrees and falls to 0 at 90: half as much phase again as at 60 takes no damping
//! away. It is no more than the loop through the estimate bears (`estimated_damping.rs`), and k no more than leaves a gain margin beside b,
//! P and D (`integral_level.rs`).
//!
//! The corners of what is integrated, k and the disturbance path's slow part, are a fraction of the outer frequency: omega,
//! or so much that they are half of the position gain, by the gain margin, where that is less. Units: rad, s, N m.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, TAU};

use strainwave::Real;
use strainwave::compensator::adapt::learning::LearningParams;
use strainwave::compensator::adapt::parameters::{AdaptationParams, Factors, LARGEST_DEVIATION};
use strainwave::compensator::adapt::ripple::{LearntRippleParams, RIPPLE_ORDERS, RippleOrder};
use strainwave::compensator::estimate::disturbance::DisturbanceParams;
use strainwave::compensator::reference::measured_feedback::MeasuredFeedbackParams;
use strainwave::compensator::reference::output_feedback::OutputFeedbackParams;
use strainwave::compensator::schedule::{OBSERVER_PERIODS, SLOW_PERIODS};
use strainwave::compensator::tuned::{
    GAIN_MARGIN, HYSTERESIS_TORQUE, NOISE_TORQUE, RARE_RATE, SLOW_RATE, TORQUE_CORNER, Tuned,
};

use crate::design::feedback::feedback_params;
use crate::design::output_loop::{self, Gains};
use crate::design::tuned;
use crate::io::gear_file::{Drive, Friction, GearFile};
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Between two steps of the adaptation: two rounds (s).
const ADAPTATION_PERIOD: f64 = 2.0 * SLOW_PERIODS as f64 * CONTROL_PERIOD;

/// Rate of the position's ripple, of the outer frequency, below which the loop through the torsion mode is stable: for a damping ratio of 0.1
/// and a mode at the ends of its tolerance.
const FASTEST_RIPPLE: f64 = 0.036;

/// Largest coefficient of the position's ripple (rad): half of what the least accurate gears of the catalogue have from peak to peak.
const LARGEST_RIPPLE: f64 = 2.9e-4;

/// Damping ratios that the output encoder adds, in slow motion and at rest.
fn measured_damping() -> [f64; 2] {
    [tuned::MEASURED, tuned::MEASURED_DAMPING_AT_REST].map(Tuned::get)
}

/// P, alike.
fn proportional() -> [f64; 2] {
    [tuned::MEASURED, tuned::PROPORTIONAL_AT_REST].map(Tuned::get)
}

/// Delay of the drive, the longest, and lag of its slowest current loop (s), in whole control periods.
fn drive_delay(drive: &Drive) -> f64 {
    let lag = 1.0 / (TAU * drive.least_current_loop * CONTROL_PERIOD);
    f64::from(drive.delay + lag.ceil() as u32) * CONTROL_PERIOD
}

/// By how much a torque may be late in all (s): two periods of the observer, from a torque to its estimate and from that
/// to the motor's reference, and the drive.
fn lateness(drive: &Drive) -> f64 {
    f64::from(2 * OBSERVER_PERIODS) * CONTROL_PERIOD + drive_delay(drive)
}

/// Frequency of the torsion mode with the motor held, at K1 (rad/s).
fn mode_frequency(file: &GearFile) -> f64 {
    (file.stiffness.k1 / file.inertia.flexspline).sqrt()
}

/// Outer frequency (rad/s): of the torsion mode, and such that the integral is slower than the position loop by the gain margin.
fn outer_frequency(file: &GearFile) -> f64 {
    let position = feedback_params::<f64>(file).position_gain;
    mode_frequency(file).min(position / (GAIN_MARGIN * tuned::INTEGRAL.get()))
}

/// Fraction of b, 0..=1, that the phase of the motor at the torsion mode allows.
fn estimated_level(file: &GearFile) -> f64 {
    let delay = lateness(&file.drive) + 0.5 * f64::from(SLOW_PERIODS) * CONTROL_PERIOD;
    let stiffest = (file.stiffness.k3 / file.inertia.flexspline).sqrt();
    let phase = (stiffest / (TAU * file.feedback.velocity_bandwidth)).atan() + stiffest * delay;
    ((FRAC_PI_2 - phase) / (FRAC_PI_2 - FRAC_PI_3)).clamp(0.0, 1.0)
}

/// Whole P and D, in slow motion and at rest.
fn measured_gains(file: &GearFile) -> [Gains; 2] {
    let frequency = mode_frequency(file);
    let corner = tuned::MEASURED_CORNER.get() * frequency;
    [0, 1].map(|k: usize| Gains {
        proportional: proportional()[k],
        derivative: 2.0 * measured_damping()[k] / frequency,
        corner,
    })
}

/// Fractions of P and D, in slow motion and at rest, that the joint bears.
fn measured_levels(file: &GearFile) -> [f64; 2] {
    measured_gains(file).map(|gains| output_loop::level(file, gains))
}

/// Torque of the cascade at once for a shift of the output's reference by 1 rad (N m at the motor).
fn torque_by_shift(file: &GearFile) -> f64 {
    let cascade = feedback_params::<f64>(file);
    f64::from(file.gear.ratio) * cascade.position_gain * cascade.velocity_gain
}

/// One count of the output encoder (rad).
fn output_count(file: &GearFile) -> f64 {
    TAU / 2f64.powi(file.sensors.output_bits().cast_signed())
}

/// Fraction of P and D of which the joint bears `level`, in slow motion, where nothing hides the encoder's rounding: so much of them that a
/// count changes the torque by no more than [`NOISE_TORQUE`] of the motor's peak torque.
fn slow_fraction(file: &GearFile, level: f64) -> f64 {
    let gain = level * (proportional()[0] + 2.0 * measured_damping()[0] * tuned::MEASURED_CORNER.get());
    // Where the joint bears none no count changes its torque.
    let by_count = (gain * output_count(file) * torque_by_shift(file)).max(f64::MIN_POSITIVE);
    (NOISE_TORQUE.get() * file.motor.peak_torque / by_count).min(1.0)
}

/// Largest shift by the output encoder's angle (rad at the motor): it asks for all of the motor's torque.
fn largest_shift(file: &GearFile) -> f64 {
    f64::from(file.gear.ratio) * file.motor.peak_torque / torque_by_shift(file)
}

/// The disturbance path, from the uncertainty of the joint.
///
/// - A joint may hide the static friction of both sides, seen at the output: dead zone.
/// - The motor's torque is known to its constant's and the rotor's inertia to its tolerance: the dead zone is wider by
///   both of the torque that is fed forward.
/// - A gear that is wound up by the fraction s of a load has the stiffness K/(1 - s*K/K_model), infinite at s = K_model/K:
///   a half leaves a gain margin of 2.
pub fn disturbance_params<R: Real>(file: &GearFile) -> DisturbanceParams<R> {
    let n = f64::from(file.gear.signed_ratio().n()).abs();
    let level = |side: &Friction| side.static_level.or(side.coulomb).unwrap_or_default();
    let hidden = n * level(&file.friction.input) + level(&file.friction.output);
    DisturbanceParams {
        slow_corner: R::lit(tuned::INTEGRAL.get() * outer_frequency(file)),
        fast_corner: R::lit(1.0 / lateness(&file.drive)),
        dead_zone: R::lit(hidden),
        tolerance: R::lit(n * (file.drive.torque_constant + file.tolerances.rotor_inertia)),
        wind_up_fraction: R::lit(1.0 - 1.0 / GAIN_MARGIN),
    }
}

/// Gains without and with an output encoder; of b as much as the lag allows, whatever the estimate's own loop bears
/// ([`crate::design::estimated_damping`]), and all of k ([`crate::design::integral_level`]), behind poles at the torsion mode: there the
/// integral is half a period late, and takes no damping from the mode; with poles above it does.
pub fn output_feedback_params(file: &GearFile) -> [OutputFeedbackParams<f64>; 2] {
    let (frequency, outer) = (mode_frequency(file), outer_frequency(file));
    let integral = [0.0, tuned::INTEGRAL.get() * outer];
    let damping = estimated_level(file) * 2.0 * tuned::ADDED_DAMPING.get() / frequency;
    std::array::from_fn(|k| OutputFeedbackParams {
        damping,
        damping_at_rest: damping,
        integral: integral[k],
        filter_corner: frequency,
    })
}

/// P that a joint bears whose torsion mode is too fast for the motor, where it bears next to none of P and D together.
///
/// There the motor follows a shift by `|T| = k_p/omega/sqrt(1 + (omega/omega_v)^2)`, at worst a quarter of a period late, and P takes
/// a damping ratio of `P*|T|/2` from the mode: half of what it has is left to it. Nor does a count move the torque by more than
/// [`NOISE_TORQUE`] of the motor's peak torque.
fn proportional_of_fast_mode(file: &GearFile) -> f64 {
    let (frequency, cascade) = (mode_frequency(file), feedback_params::<f64>(file));
    let late = (frequency / (TAU * file.feedback.velocity_bandwidth)).hypot(1.0);
    let by_damping = file.damping.torsion_mode_ratio * frequency / cascade.position_gain * late;
    let by_count = NOISE_TORQUE.get() * file.motor.peak_torque / (output_count(file) * torque_by_shift(file));
    by_damping.min(by_count).min(proportional()[0])
}

/// Gains of the output encoder's angle.
pub fn measured_feedback_params<R: Real>(file: &GearFile) -> MeasuredFeedbackParams<R> {
    let [slow, at_rest] = measured_levels(file);
    let levels = [slow * slow_fraction(file, slow), at_rest];
    let (gains, least) = (measured_gains(file), proportional_of_fast_mode(file));
    let [proportional, proportional_at_rest] =
        [0, 1].map(|k: usize| R::lit((levels[k] * gains[k].proportional).max(least)));
    let [derivative, derivative_at_rest] = [0, 1].map(|k: usize| R::lit(levels[k] * gains[k].derivative));
    MeasuredFeedbackParams {
        proportional,
        proportional_at_rest,
        derivative,
        derivative_at_rest,
        corner: R::lit(gains[0].corner),
        largest_shift: R::lit(largest_shift(file)),
    }
}

/// 1/frequency of the torsion's mode, the motor held (s/rad).
fn mode(file: &GearFile) -> f64 {
    (file.inertia.flexspline / file.stiffness.k2).sqrt()
}

/// Parameters of the learning, beside an integral k of the output feedback (1/s).
pub fn learning_params<R: Real>(file: &GearFile, integral: f64) -> LearningParams<R> {
    LearningParams { adaptation: adaptation_params(file), ripple: learnt_ripple_params(file, integral) }
}

/// Standard deviation (N m at the output) that the motor torque's noise leaves in a residual that is as slow as a low pass of
/// [`TORQUE_CORNER`].
fn residual_noise(file: &GearFile) -> f64 {
    let n = f64::from(file.gear.signed_ratio().n()).abs();
    n * file.sensors.motor_torque_noise * (0.5 * CONTROL_PERIOD * TORQUE_CORNER.get()).sqrt()
}

/// Bounds, rates and levels of the factors: those of the box that a joint may lie in. What both frictions explain is learnt at one rate,
/// each side's part of it as its part of both Coulomb levels.
fn adaptation_params<R: Real>(file: &GearFile) -> AdaptationParams<R> {
    let n = f64::from(file.gear.signed_ratio().n()).abs();
    let coulomb = |side: &Friction| side.coulomb.unwrap_or_default().max(1e-3 * file.gear.rated_torque / n);
    let (input, output) = (n * coulomb(&file.friction.input), coulomb(&file.friction.output));
    let rated = file.gear.rated_torque;
    let overload = file.gear.peak_torque / rated;
    let fastest = 1.0 / (GAIN_MARGIN * ADAPTATION_PERIOD * overload * overload);
    let rate = tuned::LEARNING_RATE.get();
    let friction_rate = |level: f64| SLOW_RATE.get() * level / (input + output);
    AdaptationParams {
        bounds: Factors {
            inertia: R::lit(file.tolerances.load_inertia),
            input_friction: R::lit(file.tolerances.friction),
            output_friction: R::lit(file.tolerances.friction),
            compliance: R::lit(file.tolerances.stiffness),
            presliding: R::lit(LARGEST_DEVIATION),
            presliding_stiffness: R::lit(LARGEST_DEVIATION),
        },
        rates: Factors {
            inertia: R::lit(rate.min(fastest)),
            input_friction: R::lit(friction_rate(input)),
            output_friction: R::lit(friction_rate(output)),
            compliance: R::lit(rate.min(fastest)),
            presliding: R::lit(RARE_RATE.get()),
            presliding_stiffness: R::lit(rate),
        },
        levels: Factors {
            inertia: R::lit(rated),
            input_friction: R::lit(input),
            output_friction: R::lit(output),
            compliance: R::lit(rated / file.stiffness.k2),
            presliding: R::lit(input + output),
            presliding_stiffness: R::lit(input + output),
        },
        dead_zone: R::lit(residual_noise(file)),
        filter_corner: R::lit(TORQUE_CORNER.get()),
        bias_corner: R::lit(SLOW_RATE.get()),
        flexing_rate: R::lit(rate),
        flexing_level: R::lit(HYSTERESIS_TORQUE.get() * rated),
        // Of the kinematic error most is twice a revolution.
        flexing_speed: R::lit(0.5 / (n * mode(file))),
    }
}

/// Orders 1, 2 and 4 of the wave generator relative to the case, and 2 relative to the flexspline: 2 - 2/N. A ripple of the friction is no
/// more than its tolerance.
fn learnt_ripple_params<R: Real>(file: &GearFile, integral: f64) -> LearntRippleParams<R> {
    let mut orders = [RippleOrder::default(); RIPPLE_ORDERS];
    for (place, (order, to_flexspline)) in
        orders.iter_mut().zip([(1, false), (2, false), (4, false), (2, true)])
    {
        *place = RippleOrder { order, to_flexspline };
    }
    LearntRippleParams {
        orders,
        position_rate: R::lit(FASTEST_RIPPLE / GAIN_MARGIN * outer_frequency(file)),
        torque_rate: R::lit(SLOW_RATE.get()),
        integral_rate: R::lit(integral),
        position_bound: R::lit(LARGEST_RIPPLE),
        torque_bound: R::lit(file.tolerances.friction * file.friction.input.coulomb.unwrap_or_default()),
        fastest: R::lit(tuned::LARGEST_RIPPLE_SPEED.get() * mode_frequency(file)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_load(factor: f64) -> GearFile {
        let mut file = GearFile::default_gear();
        file.inertia.flexspline *= factor;
        file
    }

    #[test]
    fn what_the_motor_is_too_late_for_is_not_damped() {
        let level = |factor: f64| estimated_level(&with_load(factor));
        assert_eq!([level(1.0), level(0.005)], [1.0, 0.0]);
        let levels = [1.0, 0.3, 0.2, 0.1, 0.05].map(level);
        assert!(levels.is_sorted_by(|lighter, heavier| lighter >= heavier), "{levels:?}");
    }

    #[test]
    fn the_largest_shift_asks_for_all_of_the_torque() {
        let file = GearFile::default_gear();
        let cascade = feedback_params::<f64>(&file);
        let torque = largest_shift(&file) * cascade.position_gain * cascade.velocity_gain;
        assert!((torque / file.motor.peak_torque - 1.0).abs() < 1e-12, "{torque}");
    }

    /// Beyond the motor's loops P is what the mode's damping bears: the more, the lighter the load.
    #[test]
    fn a_fast_mode_keeps_half_of_its_damping() {
        let file = |factor: f64| {
            let mut file = with_load(factor);
            file.damping.torsion_mode_ratio = 0.002;
            file
        };
        let [light, lighter] = [0.005, 0.0025].map(|factor| proportional_of_fast_mode(&file(factor)));
        assert!(light > 0.1 && lighter > 1.5 * light, "{light} {lighter}");
        assert!(measured_feedback_params::<f64>(&file(0.005)).proportional >= light);
        let gains = |factor: f64| measured_feedback_params::<f64>(&file(factor));
        assert_eq!(gains(1e-5).proportional, proportional()[0]);
        assert_eq!(gains(1.0).proportional_at_rest, proportional()[1]);
    }

    /// A count of a coarse encoder would be a pulse of torque.
    #[test]
    fn coarse_counts_act_less_in_slow_motion() {
        let coarse = |bits| {
            let mut file = GearFile::default_gear();
            file.sensors.output_encoder_bits = Some(bits);
            slow_fraction(&file, 1.0)
        };
        assert!(coarse(19) == 1.0 && coarse(15) < 0.5 && coarse(14) < 0.6 * coarse(15));
    }

    /// A heavier load slows the integrals down; a lighter one makes them no faster than the position loop bears.
    #[test]
    fn integrals_follow_the_slower_of_mode_and_position_loop() {
        let file = GearFile::default_gear();
        assert_eq!(outer_frequency(&file), mode_frequency(&file));
        assert!((outer_frequency(&with_load(4.0)) - 0.5 * mode_frequency(&file)).abs() < 1e-9);
        let light = with_load(0.01);
        let position = feedback_params::<f64>(&light).position_gain;
        assert!(
            (tuned::INTEGRAL.get() * outer_frequency(&light) / position - 1.0 / GAIN_MARGIN).abs() < 1e-12
        );
    }
}
