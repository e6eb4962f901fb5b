//! Validation of the control step's inputs: finite and bounded.
//!
//! A value that is not finite is replaced by its last finite one; the setpoint's fraction of a count by 0. The
//! setpoint's derivatives are limited to the joint's capability, and reported:
//!
//! ```text
//! |dq| <= 0.95*motor_speed/|n|,   |ddq| <= 2*motor_torque*|n|/(J_fs + n^2*J_wg),   |dddq| <= that/dt,
//! |ddddq| <= that/dt,   n = 1/r
//! ```
//!
//! Measured torques are limited to twice the peak torque of motor and gear, the range of a torque sensor; a commanded
//! torque to the gear's peak torque. The gains of the compensation functions, those of the direction of motion, are
//! limited to 0..=1 and ramped to their command at 1 per 20 ms, in a slot of their own
//! ([`crate::compensator::schedule::SlowSlot`]), so that switching one makes no step in the output: at most 6 % of it at a
//! time. Where the model cannot be trusted they are ramped in every round, and are 0 within 7 ms. The setpoint's position
//! may be any angle; one that is too far to be followed is approached smoothly
//! ([`crate::compensator::reference::command`]). Units: rad, N m, s; signs as in [`crate::gear`].

use crate::angle::Angle;
use crate::branch::seldom;
use crate::compensator::faults::Faults;
use crate::compensator::reference::directions::Crossover;
use crate::compensator::schedule::{SLOW_PERIODS, SLOW_SLOTS};
use crate::compensator::sense::pulleys::Pulleys;
use crate::compensator::tuned::{MOTOR_PATH, SETTLED_TIME};
use crate::compensator::{Command, CompensationGains, Directions, Limits, Setpoint};
use crate::constants::constants;
use crate::error::{Error, require};
use crate::gear::GearParams;
use crate::real::Real;

/// The built guard.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputGuard<R> {
    velocity: R,
    acceleration: R,
    jerk: R,
    snap: R,
    motor_torque: R,
    output_torque: R,
    peak_output_torque: R,
    /// Largest change of a gain in its slot.
    gain_step: R,
    crossover: Crossover<R>,
}

/// Last valid inputs, and the gains.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InputGuardState<R> {
    velocity: R,
    acceleration: R,
    jerk: R,
    snap: R,
    motor_torque: R,
    output_torque: R,
    command_torque: R,
    gains: CompensationGains<R>,
}

impl<R: Real> InputGuardState<R> {
    /// Gains of the compensation functions now, in the direction of the motion.
    #[inline(always)]
    pub fn gains(&self) -> &CompensationGains<R> {
        &self.gains
    }
}

/// Commanded motion and validity of the model, on which the gains depend in addition to their command.
#[derive(Clone, Copy, Debug)]
pub struct CommandedMotion<R> {
    /// Speed of the reference of the output (rad/s).
    pub velocity: R,
    /// The model may be used.
    pub trusted: bool,
}

impl<R: Real> InputGuard<R> {
    /// Prepares the guard for the control period dt (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `dt` or `flexspline_inertia` unless finite and positive.
    pub fn build(gear: &GearParams<R>, limits: &Limits<R>, dt: R) -> Result<Self, Error> {
        require(dt.is_positive(), "dt")?;
        let n = R::from_i32(gear.ratio).abs();
        let inertia = gear.flexspline_inertia + gear.wave_generator_inertia * n * n;
        require(inertia.is_positive(), "flexspline_inertia")?;
        let acceleration = R::lit(2.0) * limits.motor_torque * n / inertia;
        Ok(Self {
            velocity: limits.setpoint_speed(gear.ratio),
            acceleration,
            jerk: acceleration / dt,
            snap: acceleration / (dt * dt),
            motor_torque: R::lit(2.0) * limits.motor_torque,
            output_torque: R::lit(2.0) * limits.output_torque,
            peak_output_torque: limits.output_torque,
            gain_step: (R::from_i32((SLOW_SLOTS * SLOW_PERIODS) as i32)
                * dt
                * R::lit(1.0 / SETTLED_TIME.get()))
            .min(R::ONE),
            crossover: Crossover::build(limits.output_speed(gear.ratio)),
        })
    }

    /// The same where the measured torque of the motor is that in front of a belt.
    #[must_use]
    pub fn in_front_of(self, pulleys: &Pulleys<R>) -> Self {
        Self { motor_torque: pulleys.at_motor(self.motor_torque), ..self }
    }

    /// The outer controller's command, validated.
    #[inline(always)]
    pub fn command(
        &self,
        last: &mut InputGuardState<R>,
        new: &Command<R>,
        faults: &mut Faults,
    ) -> Command<R> {
        let mut pass = |new, last: &mut R, bound| pass(new, last, bound, Faults::SETPOINT_LIMITED, faults);
        match new {
            Command::Position(setpoint) => Command::Position(self.setpoint(last, setpoint, faults)),
            Command::Velocity { velocity, acceleration } => Command::Velocity {
                velocity: pass(*velocity, &mut last.velocity, self.velocity),
                acceleration: pass(*acceleration, &mut last.acceleration, self.acceleration),
            },
            Command::Torque(torque) => {
                Command::Torque(pass(*torque, &mut last.command_torque, self.peak_output_torque))
            }
        }
    }

    /// The motor's measured torque (N m), validated.
    #[inline(always)]
    pub fn motor_torque(&self, last: &mut InputGuardState<R>, new: R, faults: &mut Faults) -> R {
        pass(new, &mut last.motor_torque, self.motor_torque, Faults::NONE, faults)
    }

    /// The torque that is measured at the output (N m), validated.
    #[inline(always)]
    pub fn output_torque(&self, last: &mut InputGuardState<R>, new: R, faults: &mut Faults) -> R {
        pass(new, &mut last.output_torque, self.output_torque, Faults::NONE, faults)
    }

    #[inline(always)]
    fn setpoint(&self, last: &mut InputGuardState<R>, new: &Setpoint<R>, faults: &mut Faults) -> Setpoint<R> {
        let mut none = R::ZERO;
        let rest = pass(new.position.rest, &mut none, R::ONE, Faults::NONE, faults);
        let mut pass = |new, last: &mut R, bound| pass(new, last, bound, Faults::SETPOINT_LIMITED, faults);
        Setpoint {
            position: Angle { rest, ..new.position },
            velocity: pass(new.velocity, &mut last.velocity, self.velocity),
            acceleration: pass(new.acceleration, &mut last.acceleration, self.acceleration),
            jerk: pass(new.jerk, &mut last.jerk, self.jerk),
            snap: pass(new.snap, &mut last.snap, self.snap),
        }
    }

    /// The usual case: every gain equals its command of a direction. Either direction is compared in a slot of its own: one takes 35
    /// cycles.
    #[inline(always)]
    pub fn have_settled(&self, state: &InputGuardState<R>, new: &CompensationGains<R>) -> bool {
        is_same(&state.gains, new)
    }

    /// All gains of model-based functions are 0.
    #[cold]
    pub fn model_is_off(&self, state: &InputGuardState<R>) -> bool {
        is_same(
            &state.gains,
            &CompensationGains { feedback: state.gains.feedback, ..CompensationGains::default() },
        )
    }

    /// Ramps the gains towards their command.
    #[inline(always)]
    pub fn ramp_gains(
        &self,
        state: &mut InputGuardState<R>,
        new: &Directions<R>,
        motion: CommandedMotion<R>,
        faults: &mut Faults,
    ) {
        let Directions { forward, backward } = new;
        let w = self.crossover.forward(motion.velocity);
        let model = if motion.trusted { R::ONE } else { R::ZERO };
        let mut ramp_gain = |forward: R, backward: R, gain: &mut R, allowed| {
            ramp(backward + w * (forward - backward), gain, allowed, self.gain_step, faults);
        };
        let now = &mut state.gains;
        ramp_gain(forward.feedback, backward.feedback, &mut now.feedback, R::ONE);
        ramp_gain(forward.inertia, backward.inertia, &mut now.inertia, model);
        ramp_gain(forward.friction, backward.friction, &mut now.friction, model);
        ramp_gain(forward.wind_up, backward.wind_up, &mut now.wind_up, model);
        ramp_gain(forward.kinematic_error, backward.kinematic_error, &mut now.kinematic_error, model);
        ramp_gain(forward.output_feedback, backward.output_feedback, &mut now.output_feedback, model);
        ramp_gain(forward.adaptation, backward.adaptation, &mut now.adaptation, model);
        ramp_gain(forward.ripple, backward.ripple, &mut now.ripple, model);
    }
}

/// Every gain is the same. All are compared: one branch costs more than that.
#[inline(always)]
fn is_same<R: Real>(one: &CompensationGains<R>, other: &CompensationGains<R>) -> bool {
    one.feedback.is_same(other.feedback)
        & one.inertia.is_same(other.inertia)
        & one.friction.is_same(other.friction)
        & one.wind_up.is_same(other.wind_up)
        & one.kinematic_error.is_same(other.kinematic_error)
        & one.output_feedback.is_same(other.output_feedback)
        & one.adaptation.is_same(other.adaptation)
        & one.ripple.is_same(other.ripple)
}

/// A value within +-`bound`: the `new` one, limited and reported as `limited`; in the place of one that is not
/// finite the `last`.
#[inline(always)]
fn pass<R: Real>(new: R, last: &mut R, bound: R, limited: Faults, faults: &mut Faults) -> R {
    if !new.is_within(bound) {
        seldom();
        if new.is_finite() {
            faults.raise_if(true, limited);
            *last = bound.copysign(new);
        } else {
            faults.raise_if(true, Faults::INPUT_NOT_FINITE);
        }
        // The last one is within its bound.
        return *last;
    }
    *last = new;
    new
}

/// Ramps a gain towards `commanded`, limited to 0..=1, times `allowed`, by at most `step`.
#[inline(always)]
fn ramp<R: Real>(commanded: R, gain: &mut R, allowed: R, step: R, faults: &mut Faults) {
    let mut target = commanded;
    if !commanded.is_fraction() {
        seldom();
        faults.raise_if(!commanded.is_finite(), Faults::INPUT_NOT_FINITE);
        target = commanded.finite_or(*gain).max(R::ZERO).min(R::ONE);
    }
    *gain += (allowed * target - *gain).max(-step).min(step);
}

/// Detector of an encoder that stands still while the motor moves, as commanded or as measured.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrozenEncoder<R> {
    farthest: R,
    /// Step of the path that counts at rest, besides the commanded one.
    at_rest: R,
}

impl<R: Real> FrozenEncoder<R> {
    /// The motor's, whose steps are commanded velocities (rad/s) at the period dt (s). Its noise changes its count at rest, too: it may tell the
    /// same one for no longer than the time `still` (s), where that is known.
    pub fn of_motor(dt: R, still: Option<R>) -> Self {
        let farthest = R::lit(MOTOR_PATH.get()) / dt;
        Self { farthest, at_rest: still.map_or(R::ZERO, |still| farthest * dt / still) }
    }

    /// The output's, whose steps are the motor's measured motions (rad). It may stand still while the motor goes as far `apart` from it as
    /// the gear's torsion from one peak torque to the other and a count take it, with a margin (rad, at the motor).
    pub fn of_output(apart: R) -> Self {
        Self { farthest: apart, at_rest: R::ZERO }
    }

    /// Adds a step to the path while the encoder stands still; true once the path is too long in either direction, and until the
    /// encoder moves. A motor that reverses stands still for a moment: one step is never more than half of the path.
    #[inline]
    pub fn step(&self, path: &mut R, stood_still: bool, step: R) -> bool {
        if !stood_still {
            *path = R::ZERO;
            return false;
        }
        if !self.is_frozen(*path) {
            *path += step.limit(R::lit(0.5) * self.farthest);
        }
        self.is_frozen(*path)
    }

    /// The step for a commanded velocity (rad/s) of the motor.
    #[inline(always)]
    pub fn commanded(&self, velocity: R) -> R {
        velocity.abs() + self.at_rest
    }

    /// The path is too long.
    #[inline(always)]
    pub fn is_frozen(&self, path: R) -> bool {
        path.abs() >= self.farthest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// However fast the commanded motion, a single step at a standstill is none; two are.
    #[test]
    fn a_motor_that_reverses_is_not_frozen() {
        let (encoder, mut path) = (FrozenEncoder::<f64>::of_motor(1.6e-3, None), 0.0);
        for _ in 0..10 {
            assert!(!encoder.step(&mut path, true, 1e4));
            assert!(!encoder.step(&mut path, false, 1e4));
        }
        assert!(!encoder.step(&mut path, true, 1e4) && encoder.step(&mut path, true, 1e4));
    }

    /// At rest, a count that noise does not change is frozen after the time that the joint's file tells, and without one never.
    #[test]
    fn an_encoder_without_its_noise_is_frozen_at_rest() {
        let after = |still| {
            let (encoder, mut path) = (FrozenEncoder::<f64>::of_motor(1.6e-3, still), 0.0);
            (1..1000).find(|_| encoder.step(&mut path, true, encoder.commanded(0.0)))
        };
        assert_eq!(
            [None, Some(1.6e-3), Some(3.2e-3), Some(6.4e-3)].map(after),
            [None, Some(2), Some(2), Some(4)]
        );
    }

    /// A motor that moves to and fro within the gear's torsion gets nowhere, and the output has not to follow it.
    #[test]
    fn an_oscillation_is_no_path() {
        let (encoder, mut path) = (FrozenEncoder::<f64>::of_output(1.4), 0.0);
        assert!((0..100_000).all(|k| !encoder.step(&mut path, true, 0.5 * f64::from(k).sin())));
    }

    /// An encoder that is frozen is so until it moves, wherever the motor goes meanwhile.
    #[test]
    fn a_way_back_does_not_thaw_it() {
        for sign in [1.0, -1.0] {
            let (encoder, mut path) = (FrozenEncoder::<f64>::of_output(1.4), 0.0);
            assert!((0..1000).any(|_| encoder.step(&mut path, true, 5.0 * sign)));
            assert!((0..1000).all(|_| encoder.step(&mut path, true, -5.0 * sign)));
            assert!(!encoder.step(&mut path, false, 5.0 * sign));
        }
    }

    #[test]
    fn a_slow_motion_adds_up_to_the_path() {
        let (encoder, mut path) = (FrozenEncoder::<f64>::of_motor(1e-3, None), 0.0);
        let steps = (1..).find(|_| encoder.step(&mut path, true, 5.0)).unwrap();
        assert!((100..=101).contains(&steps), "{steps}");
        assert!((0..1000).all(|_| !encoder.step(&mut 0.0, true, 0.0)));
    }
}
