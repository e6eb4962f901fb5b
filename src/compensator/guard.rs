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

use crate::compensator::faults::Faults;
use crate::compensator::{Input, Limits, Sensors, Setpoint, Shares};
use crate::error::{Error, require};
use crate::gear::GearParams;
use crate::real::Real;

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

/// The last input that passed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InputGuardState<R> {
    passed: Input<R>,
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
    pub fn step(&self, state: &mut InputGuardState<R>, input: &Input<R>, faults: &mut Faults) -> Input<R> {
        let last = state.passed;
        let mut finite = |value: R, held: R| {
            faults.raise_if(!value.is_finite(), Faults::INPUT_NOT_FINITE);
            value.finite_or(held)
        };
        let mut setpoint = Setpoint {
            position: input.setpoint.position,
            velocity: finite(input.setpoint.velocity, last.setpoint.velocity),
            acceleration: finite(input.setpoint.acceleration, last.setpoint.acceleration),
            jerk: finite(input.setpoint.jerk, last.setpoint.jerk),
            snap: finite(input.setpoint.snap, last.setpoint.snap),
        };
        setpoint.position.rest = finite(input.setpoint.position.rest, R::ZERO).limit(R::ONE);
        let sensors = Sensors {
            motor_torque: finite(input.sensors.motor_torque, last.sensors.motor_torque)
                .limit(self.motor_torque),
            output_torque: input.sensors.output_torque.map(|torque| {
                finite(torque, last.sensors.output_torque.unwrap_or(R::ZERO)).limit(self.output_torque)
            }),
            ..input.sensors
        };
        let mut share = |wanted: R, now: R| {
            let wanted = finite(wanted, now).max(R::ZERO).min(R::ONE);
            now + (wanted - now).limit(self.share_step)
        };
        let shares = Shares {
            feedback: share(input.shares.feedback, last.shares.feedback),
            inertia: share(input.shares.inertia, last.shares.inertia),
            friction: share(input.shares.friction, last.shares.friction),
            wind_up: share(input.shares.wind_up, last.shares.wind_up),
            kinematic_error: share(input.shares.kinematic_error, last.shares.kinematic_error),
        };
        for (value, bound) in [
            (&mut setpoint.velocity, self.velocity),
            (&mut setpoint.acceleration, self.acceleration),
            (&mut setpoint.jerk, self.jerk),
            (&mut setpoint.snap, self.snap),
        ] {
            let limited = value.limit(bound);
            faults.raise_if(limited != *value, Faults::SETPOINT_LIMITED);
            *value = limited;
        }
        state.passed = Input { sensors, setpoint, shares };
        state.passed
    }
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
