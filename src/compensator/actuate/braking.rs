//! Position error that the cascade follows: never faster than the joint can brake.
//!
//! ```text
//! x = e                                   |e| <= b,    b = a_b/k_p^2
//! x = sign(e)*sqrt(b*(2*|e| - b))         beyond
//! ```
//!
//! e is the motor's position error, without the small shift by the measured angle
//! ([`crate::compensator::reference::measured_feedback`]). The cascade's speed k_p*e towards its reference takes a
//! deceleration of k_p^2*e to end there. Where that is more than the motor has left, the motor passes its reference at a
//! speed, and comes back as fast: at the torque's limit the joint swings about a setpoint that it could have reached. The
//! speed k_p*x takes the deceleration a_b from any distance. a_b is a tenth of the acceleration with which a setpoint is
//! approached (`approach.rs`): the rest is for the setpoint's own acceleration, for a load, and for a drive that gives less than
//! it is commanded. Within b the loop is the linear one; beyond it its gain is less, never more. The gain x/e is found once a
//! round, for the error of that moment. Units: rad at the motor.
//!
//! V. Rao, D. Bernstein, "Naive control of the double integrator", IEEE Control Systems Magazine 21 (2001).

use crate::branch::seldom;
use crate::compensator::tuned::RESERVE;
use crate::constants::constants;
use crate::real::Real;

/// The built law.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Braking<R> {
    /// b (rad).
    linear: R,
}

impl<R: Real> Braking<R> {
    /// For a cascade of this position gain (1/s), whose motor approaches setpoints with this acceleration (rad/s^2).
    pub fn build(position_gain: R, acceleration: R) -> Self {
        Self { linear: R::lit(RESERVE.get()) * acceleration / (position_gain * position_gain) }
    }

    /// x/e for a position error e (rad), 0..=1.
    #[inline(always)]
    pub fn gain(&self, error: R) -> R {
        if error.is_within(self.linear) {
            return R::ONE;
        }
        seldom();
        let part = self.linear / error.abs();
        (part * (R::lit(2.0) - part)).sqrt_or_zero()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensator::schedule::{CONTROL_PERIOD, SLOW_PERIODS};

    const GAIN: f64 = 141.0;
    const ACCELERATION: f64 = 7500.0;

    /// Continuous with its slope, alike to both sides, and never more than 1.
    #[test]
    fn it_is_one_near_by_and_less_beyond() {
        let braking = Braking::<f64>::build(GAIN, ACCELERATION);
        let b = braking.linear;
        assert_eq!((braking.gain(0.9 * b), braking.gain(-0.9 * b)), (1.0, 1.0));
        assert!((braking.gain(b * (1.0 + 1e-6)) - 1.0).abs() < 1e-9);
        for error in [1.1 * b, 3.0 * b, 1e3 * b] {
            let gain = braking.gain(error);
            assert!((0.0..1.0).contains(&gain) && gain == braking.gain(-error));
            assert!((gain * error - (b * (2.0 * error - b)).sqrt()).abs() < 1e-12 * error);
        }
        assert!([f64::MAX, f64::INFINITY].map(|error| braking.gain(error)).iter().all(|gain| *gain < 1e-3));
    }

    /// Largest overshoot (rad) of a motor that begins at rest far from its reference, its acceleration limited.
    fn overshoot(start: f64, gain: impl Fn(f64) -> f64) -> f64 {
        let (velocity_gain, dt, limit) = (377.0, CONTROL_PERIOD, RESERVE.get() * ACCELERATION * 1.2);
        let (mut position, mut velocity, mut largest) = (-start, 0.0f64, 0.0f64);
        let mut followed = 1.0;
        for k in 0..20_000u32 {
            if k.is_multiple_of(SLOW_PERIODS) {
                followed = gain(-position);
            }
            let acceleration: f64 = velocity_gain * (GAIN * followed * -position - velocity);
            velocity += dt * acceleration.clamp(-limit, limit);
            position += dt * velocity;
            largest = largest.max(position);
        }
        assert!(position.abs() < 1e-6);
        largest
    }

    #[test]
    fn a_motor_at_its_limit_does_not_pass_its_reference() {
        let braking = Braking::<f64>::build(GAIN, ACCELERATION);
        for start in [1.0, 3.0, 10.0] {
            assert!(overshoot(start, |_| 1.0) > 0.2 * start);
            assert!(overshoot(start, |error| braking.gain(error)) < 0.01 * start, "{start}");
        }
    }
}
