//! Motor reference, extrapolated from one plan of the feed-forward to the next by its acceleration, jerk and torque rate.
//!
//! ```text
//! x <- x + dt*(omega + dt*a/2 + v),   omega <- omega + dt*a,   a <- a + dt*j,   tau <- tau + dt*dtau
//! ```
//!
//! dt is the control period, v the speed of the wind-up response to a load
//! ([`crate::compensator::estimate::disturbance`]). The reference is kept relative to the motor's encoder as the position
//! error x = theta_ref - theta: small, so that an f32 resolves it. The motion of the encoder is subtracted as soon as it
//! is read. Units: rad, s, N m at the motor's shaft; signs as in [`crate::gear`].

use crate::angle::Angle;
use crate::real::{RADIANS_PER_COUNT, Real};

/// Reference of the motor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::compensator) struct MotorReference<R> {
    /// theta_ref - theta (rad), dtheta_ref (rad/s), ddtheta_ref (rad/s^2) and its rate.
    pub(in crate::compensator) position_error: R,
    pub(in crate::compensator) velocity: R,
    pub(in crate::compensator) acceleration: R,
    pub(in crate::compensator) jerk: R,
    /// Gain of the acceleration that is passed to the cascade.
    pub(in crate::compensator) acceleration_gain: R,
    /// Feed-forward (N m).
    pub(in crate::compensator) torque: R,
    pub(in crate::compensator) torque_rate: R,
    pub(in crate::compensator) transmission: R,
    pub(in crate::compensator) wind_up_compliance: R,
    /// Commanded torque at the output flange in the place of a motion (N m).
    pub(in crate::compensator) output_torque: Option<R>,
    /// Rest is commanded.
    pub(in crate::compensator) rests: bool,
    /// The command is of another kind than the last one.
    pub(in crate::compensator) switched: bool,
    /// There is a plan.
    pub(in crate::compensator) planned: bool,
    /// There is one, of a motion: the cascade's feedback acts.
    pub(in crate::compensator) closed: bool,
}

impl<R: Real> MotorReference<R> {
    /// Commanded speed of the motor (rad/s); 0 where a torque is commanded.
    #[inline(always)]
    pub(in crate::compensator) fn commanded_velocity(&self) -> R {
        if self.output_torque.is_some() { R::ZERO } else { self.velocity }
    }

    /// Of a position `error` (rad), at rest, what exceeds the `rounding` of the encoder (rad), which cannot tell where
    /// within a count the motor is. With all of it the integral would push the motor from count to count.
    #[inline(always)]
    pub(in crate::compensator) fn beyond_rounding(&self, error: R, rounding: R) -> R {
        if self.rests { error.dead_zone(rounding) } else { error }
    }

    /// Reference angle for a motor at the angle `motor`, to a count.
    #[inline(always)]
    pub(in crate::compensator) fn reference(&self, motor: Angle<R>) -> Angle<R> {
        let counts = (self.position_error * R::lit(1.0 / RADIANS_PER_COUNT)).to_i32();
        Angle::from_counts(motor.counts.wrapping_add(i64::from(counts)))
    }

    /// Extrapolates by one control period dt (s), at an additional `velocity` (rad/s).
    #[inline(always)]
    pub(in crate::compensator) fn advance(&mut self, velocity: R, dt: R) {
        let change = dt * self.acceleration;
        let speed = self.velocity + velocity;
        self.position_error += dt * (speed + R::lit(0.5) * change);
        self.velocity += change;
        self.acceleration += dt * self.jerk;
        self.torque += dt * self.torque_rate;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rounding_of_the_encoder_counts_in_motion_alone() {
        let followed = |error, rests| {
            MotorReference { rests, ..MotorReference::default() }.beyond_rounding(error, 1e-4_f64)
        };
        assert_eq!((followed(0.9e-4, true), followed(-0.9e-4, true)), (0.0, 0.0));
        assert_eq!((followed(0.9e-4, false), followed(3e-4, false)), (0.9e-4, 3e-4));
        assert!((followed(-3e-4, true) + 2e-4).abs() < 1e-18);
    }
}
