//! What stands between the outside and the control step: its inputs are finite and bounded.
//!
//! A value that is not finite is replaced by its last finite one; the setpoint's fraction of a count by 0.
//! The setpoint's derivatives are limited to what the joint can do, and reported:
//!
//! ```text
//! |dq| <= motor_speed/|n|,   |ddq| <= 2*motor_torque*|n|/(J_fs + n^2*J_wg),   |dddq| <= that/dt,
//! |ddddq| <= that/dt,   n = 1/r
//! ```
//!
//! Measured torques are limited to twice the peak torque of motor and gear: a torque sensor that says
//! more is off its range. The shares are limited to 0..=1 and follow their command at 1 per 10 ms, so that
//! switching one makes no step in the output. The setpoint's position may be any angle; the feedback's
//! answer to a jump of it ends at the motor's torque. Units: rad, N m, s; signs as in [`crate::gear`].

use crate::angle::Angle;
use crate::compensator::faults::Faults;
use crate::compensator::{Input, Limits, Sensors, Setpoint, Shares};
use crate::error::{Error, require};
use crate::gear::GearParams;
use crate::real::{Real, seldom};

/// Time in which a share goes from 0 to 1 (s).
const SHARE_RAMP: f64 = 0.01;

/// The built guard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputGuard<R> {
    velocity: R,
    acceleration: R,
    jerk: R,
    snap: R,
    motor_torque: R,
    output_torque: R,
    share_step: R,
}

/// What passed last.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InputGuardState<R> {
    velocity: R,
    acceleration: R,
    jerk: R,
    snap: R,
    motor_torque: R,
    output_torque: R,
    shares: Shares<R>,
}

impl<R: Real> InputGuard<R> {
    /// Prepares the guard for the control period dt (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `dt` or `flexspline_inertia` unless finite and positive.
    pub fn build(gear: &GearParams<R>, limits: &Limits<R>, dt: R) -> Result<Self, Error> {
        require(dt.is_finite() && dt > R::ZERO, "dt")?;
        let n = R::from_i32(gear.ratio).abs();
        let inertia = gear.flexspline_inertia + gear.wave_generator_inertia * n * n;
        require(inertia.is_finite() && inertia > R::ZERO, "flexspline_inertia")?;
        let acceleration = R::lit(2.0) * limits.motor_torque * n / inertia;
        Ok(Self {
            velocity: limits.output_speed(gear.ratio),
            acceleration,
            jerk: acceleration / dt,
            snap: acceleration / (dt * dt),
            motor_torque: R::lit(2.0) * limits.motor_torque,
            output_torque: R::lit(2.0) * limits.output_torque,
            share_step: dt * R::lit(1.0 / SHARE_RAMP),
        })
    }

    /// The input as the control step may use it.
    #[inline(always)]
    pub fn step(&self, state: &mut InputGuardState<R>, input: &Input<R>, faults: &mut Faults) -> Input<R> {
        Input {
            sensors: self.sensors(state, &input.sensors, faults),
            setpoint: self.setpoint(state, &input.setpoint, faults),
            shares: self.shares(&mut state.shares, &input.shares, faults),
        }
    }

    #[inline(always)]
    fn sensors(&self, last: &mut InputGuardState<R>, new: &Sensors<R>, faults: &mut Faults) -> Sensors<R> {
        let mut pass = |new, last: &mut R, bound| pass(new, last, bound, Faults::NONE, faults);
        Sensors {
            motor_torque: pass(new.motor_torque, &mut last.motor_torque, self.motor_torque),
            output_torque: new
                .output_torque
                .map(|torque| pass(torque, &mut last.output_torque, self.output_torque)),
            ..*new
        }
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

    #[inline(always)]
    fn shares(&self, last: &mut Shares<R>, new: &Shares<R>, faults: &mut Faults) -> Shares<R> {
        if have_arrived(last, new) {
            return *last;
        }
        let mut follow = |new, last: &mut R| follow(new, last, self.share_step, faults);
        Shares {
            feedback: follow(new.feedback, &mut last.feedback),
            inertia: follow(new.inertia, &mut last.inertia),
            friction: follow(new.friction, &mut last.friction),
            wind_up: follow(new.wind_up, &mut last.wind_up),
            kinematic_error: follow(new.kinematic_error, &mut last.kinematic_error),
        }
    }
}

/// The usual case: no share is on its way.
#[inline(always)]
fn have_arrived<R: Real>(now: &Shares<R>, wanted: &Shares<R>) -> bool {
    let Shares { feedback, inertia, friction, wind_up, kinematic_error } = *wanted;
    now.feedback.is_same(feedback)
        && now.inertia.is_same(inertia)
        && now.friction.is_same(friction)
        && now.wind_up.is_same(wind_up)
        && now.kinematic_error.is_same(kinematic_error)
}

/// A value within +-`bound`: the `new` one, limited and reported as `limited`; in the place of one that is not
/// finite the `last`.
#[inline(always)]
fn pass<R: Real>(new: R, last: &mut R, bound: R, limited: Faults, faults: &mut Faults) -> R {
    if !new.is_within(bound) {
        seldom();
        faults.raise_if(true, if new.is_finite() { limited } else { Faults::INPUT_NOT_FINITE });
        *last = new.finite_or(*last).limit(bound);
        return *last;
    }
    *last = new;
    new
}

/// A share on its way to `wanted`, limited to 0..=1, by at most `step`.
#[inline(always)]
fn follow<R: Real>(wanted: R, share: &mut R, step: R, faults: &mut Faults) -> R {
    let mut target = wanted;
    if !wanted.is_share() {
        seldom();
        faults.raise_if(!wanted.is_finite(), Faults::INPUT_NOT_FINITE);
        target = wanted.finite_or(*share).max(R::ZERO).min(R::ONE);
    }
    *share += (target - *share).max(-step).min(step);
    *share
}

/// Path that the motor may be asked to move while its encoder stands still (rad).
const FROZEN_PATH: f64 = 0.5;

/// Notices an encoder that stands still while the motor is asked to move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrozenEncoder<R> {
    dt: R,
}

impl<R: Real> FrozenEncoder<R> {
    /// For the control period dt (s).
    pub fn build(dt: R) -> Self {
        Self { dt }
    }

    /// Adds to the path while the encoder stands still; true once the path is too long.
    #[inline]
    pub fn step(&self, path: &mut R, stood_still: bool, velocity: R) -> bool {
        let limit = R::lit(FROZEN_PATH);
        *path = if stood_still { (*path + self.dt * velocity.abs()).min(limit) } else { R::ZERO };
        *path >= limit
    }
}
