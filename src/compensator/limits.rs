//! Limits of a joint: the bounds of every output.

use crate::constants::constants;
use crate::error::{Error, require};
use crate::real::Real;

/// Limits of a joint.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits<R> {
    /// Peak torque of the motor at its shaft, > 0 (N m).
    pub motor_torque: R,
    /// Fastest speed of the motor, > 0 (rad/s).
    pub motor_speed: R,
    /// Peak torque of the gear at its output, > 0 (N m).
    pub output_torque: R,
}

impl<R: Real> Limits<R> {
    /// Every limit is finite and positive.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the name of the limit that is not finite and positive.
    pub fn check(&self) -> Result<(), Error> {
        require(self.motor_torque.is_positive(), "motor_torque")?;
        require(self.motor_speed.is_positive(), "motor_speed")?;
        require(self.output_torque.is_positive(), "output_torque")
    }

    /// Fastest speed of a setpoint of the output behind a ratio 1/n (rad/s): 90 % of the output's fastest speed, a
    /// margin for overshoot.
    pub fn setpoint_speed(&self, n: i32) -> R {
        R::lit(0.9) * self.output_speed(n)
    }

    /// Fastest speed of the output behind a ratio 1/n (rad/s).
    pub fn output_speed(&self, n: i32) -> R {
        self.motor_speed / R::from_i32(n).abs()
    }
}
