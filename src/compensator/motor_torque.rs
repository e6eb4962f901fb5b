//! The motor's torque as the observer may believe it: what was commanded where it is fast, what was measured where it is slow.
//!
//! ```text
//! tau = tau_commanded + y,    y <- y + omega*dt*(tau_measured - tau_commanded - y)
//! ```
//!
//! A drive gives what it is commanded, up to an offset, a gain or a limit; what it measures carries noise. Complementary
//! filter of the two with the corner omega: the noise of the measurement beyond it is gone, the drive's errors below it are
//! seen. Units: N m at the motor's shaft, rad/s. Explicit Euler.

use crate::error::{Error, require};
use crate::real::Real;

/// omega (rad/s).
const CORNER: f64 = 100.0;

/// The built filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorTorque<R> {
    gain: R,
}

/// y (N m).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotorTorqueState<R> {
    off: R,
}

impl<R: Real> MotorTorque<R> {
    /// For the control period dt (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `dt` unless above 0 and up to 1.
    pub fn build(dt: R) -> Result<Self, Error> {
        require(dt > R::ZERO && dt <= R::ONE, "dt")?;
        Ok(Self { gain: (dt * R::lit(CORNER)).one_minus_exp_neg() })
    }

    /// Torque over the control period that ended, from what was `commanded` for it and what was `measured`.
    #[inline(always)]
    pub fn step(&self, state: &mut MotorTorqueState<R>, commanded: R, measured: R) -> R {
        state.off += self.gain * (measured - commanded - state.off);
        commanded + state.off
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 1e-4;

    /// Output for a measurement that differs from the command by a wave of `frequency` (rad/s), largest after a while.
    fn passed(frequency: f64) -> f64 {
        let (filter, mut state) = (MotorTorque::build(DT).unwrap(), MotorTorqueState::default());
        let outputs = (0..100_000).map(|k| filter.step(&mut state, 2.0, 2.0 + (frequency * DT * f64::from(k)).sin()) - 2.0);
        outputs.skip(50_000).fold(0.0, f64::max)
    }

    #[test]
    fn slow_differences_are_believed_and_fast_ones_are_not() {
        assert!(passed(1.0) > 0.999);
        assert!((passed(100.0) - 0.5f64.sqrt()).abs() < 0.01);
        assert!(passed(10_000.0) < 0.012);
    }

    #[test]
    fn a_command_that_is_followed_passes_at_once() {
        let (filter, mut state) = (MotorTorque::<f64>::build(DT).unwrap(), MotorTorqueState::default());
        for commanded in [1.0, -2.0, 0.5] {
            assert_eq!(filter.step(&mut state, commanded, commanded), commanded);
        }
    }
}
