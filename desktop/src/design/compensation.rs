//! Parameters of the compensator's adaptation, output feedback and learnt ripple, for the joint of a gear file.
//!
//! Output feedback ([`strainwave::compensator::reference::output_feedback`] by the estimate,
//! [`strainwave::compensator::reference::measured_feedback`] by the output encoder): with the torsion mode's frequency
//! omega = sqrt(K1/J_fs), `b = 2*zeta/omega` adds the damping ratio zeta, D alike; omega_y and omega_m are multiples of
//! omega. The multiples were chosen by simulation, of the default gear and of training joints of the catalogue; no linear
//! analysis of their margins stands behind them.
//!
//! The motor follows a shift of its reference late: at the mode by
//!
//! ```text
//! phase = atan(omega_3/omega_v) + omega_3*T,   omega_3 = sqrt(K3/J_fs)
//! ```
//!
//! omega_v is the bandwidth of the velocity loop, T the delay: of b from a torque to the reference and half a round, of P
//! and D, which act in every period, a period and the drive's. From 90 degrees on the shift takes damping away. So the
//! gains are whole up to 60 degrees and fall to 0 at 90: half as much phase again as at 60 takes no damping away.
//!
//! The corners of what is integrated, k and the disturbance path's slow part, are fractions of the outer frequency: omega,
//! or 1.75 times the position gain where that is less. Units: rad, s, N m.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, TAU};

use strainwave::Real;
use strainwave::compensator::adapt::learning::LearningParams;
use strainwave::compensator::adapt::parameters::{AdaptationParams, Factors};
use strainwave::compensator::adapt::ripple::{LearntRippleParams, RIPPLE_ORDERS, RippleOrder};
use strainwave::compensator::estimate::disturbance::DisturbanceParams;
use strainwave::compensator::reference::measured_feedback::MeasuredFeedbackParams;
use strainwave::compensator::reference::output_feedback::OutputFeedbackParams;
use strainwave::compensator::schedule::{OBSERVER_PERIODS, SLOW_PERIODS};

use crate::design::feedback::feedback_params;
use crate::io::gear_file::{Drive, Friction, GearFile};
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Damping ratio that the output feedback adds to the torsion mode, by the estimate.
const ADDED_DAMPING: f64 = 0.125;
/// The same by the output encoder, in slow motion and at rest, where more of it opposes a load step.
const MEASURED_DAMPING: [f64; 2] = [0.4, 0.55];
/// P, alike.
const PROPORTIONAL: [f64; 2] = [0.4, 0.26];
/// omega_m as a multiple of omega: a count of the output encoder moves the reference of a joint in slow motion by
/// P + 2*zeta*omega_m/omega = 4.4 counts.
const MEASURED_CORNER: f64 = 5.0;
/// Largest change of the torque by a count of the output encoder in slow motion, of the motor's peak torque.
const COUNT_TORQUE: f64 = 0.05;
/// Part of the motor's peak torque that the rotor takes to follow the largest shift at the torsion mode's frequency: the rest is
/// left to the load and to the cascade's damping. With 0.2 a joint whose reflected rotor is ten times its load goes from limit to
/// limit after a load step, with 0.15 it does not.
const SHIFT_TORQUE: f64 = 0.1;
/// Largest torque that P and D ask for at a step of the rated torque, in motor's peak torques: with more, a motor at its
/// limit no longer damps, and a load far lighter than its rotor is lost. Without it one run more of 500 training joints shakes
/// and 3 of its 135 joints with both encoders more are worse than a baseline in S1.
const STEP_TORQUE: f64 = 5.0;
/// k without and with an output encoder, in slow motion and at rest, as fractions of the outer frequency.
const INTEGRAL: [f64; 2] = [0.0, 0.3];
const INTEGRAL_AT_REST: [f64; 2] = [0.0, 0.25];
/// omega_y as a multiple of omega: z takes a damping ratio of 0.03 off the mode, of 0.125 without its poles.
const FILTER_CORNER: f64 = 1.5;
/// Outer frequency over the position gain, at most.
const OUTER_TO_POSITION: f64 = 1.75;

/// Corner of the disturbance path's slow part, as a fraction of the outer frequency.
const SLOW_CORNER: f64 = 0.2;
/// Fraction of a sudden load that the gear is wound up for.
const FAST_SHARE: f64 = 0.5;

/// Room that a factor has beyond the file's tolerances.
const ROOM: f64 = 1.25;
/// Rate of the inertia's factor where its torque is the rated one (1/s).
const INERTIA_RATE: f64 = 30.0;
/// Between two steps of the adaptation: two rounds (s).
const ADAPTATION_PERIOD: f64 = 2.0 * SLOW_PERIODS as f64 * CONTROL_PERIOD;
/// Fraction of the rate at which a step of the adaptation at the peak torque is no longer stable.
const STABLE_SHARE: f64 = 0.75;
/// Rate of the friction's factor at its Coulomb level, on the motor's and on the output's side (1/s).
const FRICTION_RATES: [f64; 2] = [1.2, 0.3];
/// The same of the presliding's shape and of its stiffness, where both weigh as much as the Coulomb levels.
const PRESLIDING_RATES: [f64; 2] = [8.0, 40.0];
/// Largest deviation of both from their nominal values: from nearly order 1 on, stiffness by 0.5 to 2.3.
const PRESLIDING_BOUND: f64 = 0.9;
/// Rate of the compliance's factor at the rated torque's torsion (1/s).
const COMPLIANCE_RATE: f64 = 80.0;
/// The same without an output encoder, at a flexing torque of so many rated torques, which is also the largest that
/// counts.
const FLEXING_RATE: f64 = 60.0;
const FLEXING_LEVEL: f64 = 0.06;
/// Half width of the dead zone, in rated torques.
const DEAD_ZONE: f64 = 0.001;
/// Corners of F(s) and of the slow part (rad/s).
const CORNERS: [f64; 2] = [200.0, 2.0];

/// Rate of the ripple of position, as a fraction of the outer frequency. Learning a ripple of the frequency f closes a loop
/// through the torsion mode, stable for a rate below 2*zeta*omega*(1 - (f/omega)^2) over the number of orders: a fraction
/// of 0.036 for the damping ratio zeta = 0.1, and omega at the ends of its tolerance.
const POSITION_RIPPLE_RATE: f64 = 1.0 / 64.0;
/// Rate of the ripple of torque (1/s).
const TORQUE_RIPPLE_RATE: f64 = 1.0;
/// Largest ripple of position (rad), and of torque in Coulomb levels of the motor's side.
const RIPPLE_BOUNDS: [f64; 2] = [3e-4, 0.3];
/// Speeds of the motor between which ripple is learnt, as fractions of the torsion mode's frequency; the upper is of order
/// 1, well below the mode, where the sign of the output's response changes.
const RIPPLE_SPEEDS: [f64; 2] = [1.0 / 160.0, 0.375];

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

/// Outer frequency (rad/s).
fn outer_frequency(file: &GearFile) -> f64 {
    mode_frequency(file).min(OUTER_TO_POSITION * feedback_params::<f64>(file).position_gain)
}

/// Fraction of a shift's gains, 0..=1, that the phase of the motor at the torsion mode allows, with this delay (s).
fn damping_level(file: &GearFile, delay: f64) -> f64 {
    let stiffest = (file.stiffness.k3 / file.inertia.flexspline).sqrt();
    let phase = (stiffest / (TAU * file.feedback.velocity_bandwidth)).atan() + stiffest * delay;
    ((FRAC_PI_2 - phase) / (FRAC_PI_2 - FRAC_PI_3)).clamp(0.0, 1.0)
}

/// Fraction of b.
fn estimated_level(file: &GearFile) -> f64 {
    damping_level(file, lateness(&file.drive) + 0.5 * f64::from(SLOW_PERIODS) * CONTROL_PERIOD)
}

/// Fraction of P and D.
fn measured_level(file: &GearFile) -> f64 {
    let late = f64::from(1 + file.sensors.output_encoder_delay) * CONTROL_PERIOD;
    damping_level(file, late + drive_delay(&file.drive))
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

/// Fraction of P and D in slow motion, where nothing hides the encoder's rounding: so much of them that a count changes the
/// torque by no more than [`COUNT_TORQUE`] of the motor's peak torque.
fn slow_fraction(file: &GearFile) -> f64 {
    let gain = measured_level(file) * (PROPORTIONAL[0] + 2.0 * MEASURED_DAMPING[0] * MEASURED_CORNER);
    // P and D of a joint whose torsion mode is too fast for any are 0: no count changes its torque.
    let by_count = (gain * output_count(file) * torque_by_shift(file)).max(f64::MIN_POSITIVE);
    (COUNT_TORQUE * file.motor.peak_torque / by_count).min(1.0)
}

/// Fraction of P and D at rest: so much of them that a step of the rated torque asks for no more than [`STEP_TORQUE`] of
/// the motor's peak torque. Its error goes up to 2*T/K1, at a speed of up to omega*T/K1.
fn rest_fraction(file: &GearFile) -> f64 {
    let gain = 2.0 * (PROPORTIONAL[1] + MEASURED_DAMPING[1]);
    let by_step = gain * file.gear.rated_torque / file.stiffness.k1 * torque_by_shift(file);
    (STEP_TORQUE * file.motor.peak_torque / by_step).min(1.0)
}

/// Largest shift by the output encoder's angle (rad at the motor), which takes [`SHIFT_TORQUE`] of the motor's peak torque:
/// `J_wg*omega^2` times its amplitude.
fn largest_shift(file: &GearFile) -> f64 {
    let stiffness = file.inertia.wave_generator * mode_frequency(file).powi(2);
    SHIFT_TORQUE * file.motor.peak_torque / stiffness
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
        slow_corner: R::lit(SLOW_CORNER * outer_frequency(file)),
        fast_corner: R::lit(1.0 / lateness(&file.drive)),
        dead_zone: R::lit(hidden),
        tolerance: R::lit(n * (file.drive.torque_constant + file.tolerances.rotor_inertia)),
        wind_up_fraction: R::lit(FAST_SHARE),
    }
}

/// Gains without and with an output encoder.
pub fn output_feedback_params<R: Real>(file: &GearFile) -> [OutputFeedbackParams<R>; 2] {
    let (frequency, outer) = (mode_frequency(file), outer_frequency(file));
    std::array::from_fn(|k| OutputFeedbackParams {
        damping: R::lit(estimated_level(file) * 2.0 * ADDED_DAMPING / frequency),
        integral: R::lit(INTEGRAL[k] * outer),
        integral_at_rest: R::lit(INTEGRAL_AT_REST[k] * outer),
        filter_corner: R::lit(FILTER_CORNER * frequency),
    })
}

/// P that a joint bears whose torsion mode is too fast for the motor, where P and D by the mode's phase are none.
///
/// There the motor follows a shift by `|T| = k_p/omega/sqrt(1 + (omega/omega_v)^2)`, at worst a quarter of a period late, and P takes
/// a damping ratio of `P*|T|/2` from the mode: half of what it has is left to it. Nor does a count move the torque by more than
/// [`COUNT_TORQUE`] of the motor's peak torque.
fn proportional_of_fast_mode(file: &GearFile) -> f64 {
    let (frequency, cascade) = (mode_frequency(file), feedback_params::<f64>(file));
    let late = (frequency / (TAU * file.feedback.velocity_bandwidth)).hypot(1.0);
    let by_damping = file.damping.torsion_mode_ratio * frequency / cascade.position_gain * late;
    let by_count = COUNT_TORQUE * file.motor.peak_torque / (output_count(file) * torque_by_shift(file));
    by_damping.min(by_count).min(PROPORTIONAL[0])
}

/// Gains of the output encoder's angle.
pub fn measured_feedback_params<R: Real>(file: &GearFile) -> MeasuredFeedbackParams<R> {
    let (frequency, level) = (mode_frequency(file), measured_level(file));
    let levels = [level * slow_fraction(file), level * rest_fraction(file)];
    let least = proportional_of_fast_mode(file);
    let [proportional, proportional_at_rest] =
        [0, 1].map(|k: usize| R::lit((levels[k] * PROPORTIONAL[k]).max(least)));
    let [derivative, derivative_at_rest] =
        [0, 1].map(|k: usize| R::lit(levels[k] * 2.0 * MEASURED_DAMPING[k] / frequency));
    MeasuredFeedbackParams {
        proportional,
        proportional_at_rest,
        derivative,
        derivative_at_rest,
        corner: R::lit(MEASURED_CORNER * frequency),
        largest_shift: R::lit(largest_shift(file)),
    }
}

/// 1/frequency of the torsion's mode, the motor held (s/rad).
fn mode(file: &GearFile) -> f64 {
    (file.inertia.flexspline / file.stiffness.k2).sqrt()
}

/// Parameters of the learning.
pub fn learning_params<R: Real>(file: &GearFile) -> LearningParams<R> {
    LearningParams { adaptation: adaptation_params(file), ripple: learnt_ripple_params(file) }
}

/// Bounds, rates and levels of the factors: those of the box that a joint may lie in, with some room.
fn adaptation_params<R: Real>(file: &GearFile) -> AdaptationParams<R> {
    let n = f64::from(file.gear.signed_ratio().n()).abs();
    let coulomb = |side: &Friction| side.coulomb.unwrap_or_default().max(1e-3 * file.gear.rated_torque / n);
    let (input, output) = (n * coulomb(&file.friction.input), coulomb(&file.friction.output));
    let rated = file.gear.rated_torque;
    let overload = file.gear.peak_torque / rated;
    let fastest = STABLE_SHARE / (ADAPTATION_PERIOD * overload * overload);
    AdaptationParams {
        bounds: Factors {
            inertia: R::lit(ROOM * file.tolerances.load_inertia),
            input_friction: R::lit(ROOM * file.tolerances.friction),
            output_friction: R::lit(ROOM * file.tolerances.friction),
            compliance: R::lit(ROOM * file.tolerances.stiffness),
            presliding: R::lit(PRESLIDING_BOUND),
            presliding_stiffness: R::lit(PRESLIDING_BOUND),
        },
        rates: Factors {
            inertia: R::lit(INERTIA_RATE.min(fastest)),
            input_friction: R::lit(FRICTION_RATES[0]),
            output_friction: R::lit(FRICTION_RATES[1]),
            compliance: R::lit(COMPLIANCE_RATE.min(fastest)),
            presliding: R::lit(PRESLIDING_RATES[0]),
            presliding_stiffness: R::lit(PRESLIDING_RATES[1]),
        },
        levels: Factors {
            inertia: R::lit(rated),
            input_friction: R::lit(input),
            output_friction: R::lit(output),
            compliance: R::lit(rated / file.stiffness.k2),
            presliding: R::lit(input + output),
            presliding_stiffness: R::lit(input + output),
        },
        dead_zone: R::lit(DEAD_ZONE * rated),
        filter_corner: R::lit(CORNERS[0]),
        bias_corner: R::lit(CORNERS[1]),
        flexing_rate: R::lit(FLEXING_RATE),
        flexing_level: R::lit(FLEXING_LEVEL * rated),
        // Of the kinematic error most is twice a revolution.
        flexing_speed: R::lit(0.5 / (n * mode(file))),
    }
}

/// Orders 1, 2 and 4 of the wave generator relative to the case, and 2 relative to the flexspline: 2 - 2/N.
fn learnt_ripple_params<R: Real>(file: &GearFile) -> LearntRippleParams<R> {
    let mut orders = [RippleOrder::default(); RIPPLE_ORDERS];
    for (place, (order, to_flexspline)) in
        orders.iter_mut().zip([(1, false), (2, false), (4, false), (2, true)])
    {
        *place = RippleOrder { order, to_flexspline };
    }
    LearntRippleParams {
        orders,
        position_rate: R::lit(POSITION_RIPPLE_RATE * outer_frequency(file)),
        torque_rate: R::lit(TORQUE_RIPPLE_RATE),
        position_bound: R::lit(RIPPLE_BOUNDS[0]),
        torque_bound: R::lit(RIPPLE_BOUNDS[1] * file.friction.input.coulomb.unwrap_or_default()),
        speeds: RIPPLE_SPEEDS.map(|fraction| R::lit(fraction * mode_frequency(file))),
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
        for level in [estimated_level, measured_level] {
            assert_eq!(level(&GearFile::default_gear()), 1.0);
            assert_eq!(level(&with_load(0.005)), 0.0);
            let levels = [1.0, 0.3, 0.2, 0.1, 0.05].map(|factor| level(&with_load(factor)));
            assert!(levels.is_sorted_by(|lighter, heavier| lighter >= heavier), "{levels:?}");
        }
        // What is read acts sooner than what is estimated.
        assert!(measured_level(&with_load(0.1)) > estimated_level(&with_load(0.1)));
    }

    /// Of the motor's torque the largest shift takes the less at once, the lighter the load: it swings the faster.
    #[test]
    fn a_light_load_is_shifted_with_less_torque() {
        let at_once = |factor: f64| {
            let file = crate::catalogue::load::with_load(&GearFile::default_gear(), factor * 1.2);
            let cascade = feedback_params::<f64>(&file);
            largest_shift(&file) * cascade.position_gain * cascade.velocity_gain / file.motor.peak_torque
        };
        assert!(
            at_once(0.05) < 0.25 && at_once(0.05) < 0.5 * at_once(0.5),
            "{} {}",
            at_once(0.05),
            at_once(0.5)
        );
    }

    /// Beyond the motor's loops P is what the mode's damping bears: the more, the lighter the load.
    #[test]
    fn a_fast_mode_keeps_half_of_its_damping() {
        let gains = |factor: f64| {
            let mut file = with_load(factor);
            file.damping.torsion_mode_ratio = 0.002;
            measured_feedback_params::<f64>(&file)
        };
        let (light, lighter) = (gains(0.005), gains(0.0025));
        assert_eq!((light.derivative, light.proportional), (0.0, light.proportional_at_rest));
        assert!(light.proportional > 0.1 && lighter.proportional > 1.5 * light.proportional);
        assert_eq!(gains(1e-5).proportional, PROPORTIONAL[0]);
        assert_eq!(gains(1.0).proportional_at_rest, PROPORTIONAL[1]);
    }

    /// A count of a coarse encoder would be a pulse of torque.
    #[test]
    fn coarse_counts_act_less_in_slow_motion() {
        let coarse = |bits| {
            let mut file = GearFile::default_gear();
            file.sensors.output_encoder_bits = Some(bits);
            slow_fraction(&file)
        };
        assert!(coarse(19) == 1.0 && coarse(15) < 0.5 && coarse(14) < 0.6 * coarse(15));
    }

    #[test]
    fn a_weak_motor_is_not_asked_for_more_than_its_limit_bears() {
        let weak = |factor: f64| {
            let mut file = GearFile::default_gear();
            file.motor.peak_torque *= factor;
            rest_fraction(&file)
        };
        assert!(weak(1.0) == 1.0 && weak(0.1) < 0.5 && (weak(0.05) / weak(0.1) - 0.5).abs() < 1e-9);
    }

    /// A heavier load slows the integrals down; a lighter one makes them no faster than the position loop bears.
    #[test]
    fn integrals_follow_the_slower_of_mode_and_position_loop() {
        let file = GearFile::default_gear();
        assert_eq!(outer_frequency(&file), mode_frequency(&file));
        assert!((outer_frequency(&with_load(4.0)) - 0.5 * mode_frequency(&file)).abs() < 1e-9);
        let light = with_load(0.01);
        assert_eq!(outer_frequency(&light), 1.75 * feedback_params::<f64>(&light).position_gain);
    }
}
