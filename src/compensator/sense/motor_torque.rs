//! Motor torque for the observer: complementary filter of command (fast) and measurement (slow).
//!
//! ```text
//! tau = s*tau_commanded + y,    x = tau_measured - s*tau_commanded - y,    g = 1 - e^(-omega*dt)
//! y  <- y + x - limit(x, w) + g*limit(x, w),                        w: 5 % of the peak torque
//! ```
//!
//! A drive's torque is its command, up to an offset, a gain or a limit; its measurement is noisy. The filter has the
//! corner omega = 7 rad/s: noise of the measurement above it is rejected, errors of the drive below it pass. Where the
//! feedback gain s is 0, another controller moves the motor and the command is unknown: then the measurement alone
//! passes a low pass of 140 rad/s; between the two g is interpolated by s. A residual above w cannot be noise (a drive at
//! its limit, or switched off); it passes unfiltered: w has to lie far beyond the noise, whose tails would otherwise
//! decay in y with a time constant of a seventh of a second each. It is stepped once a period of the observer, by the means of both
//! torques over it. Units: N m at the motor's shaft, rad/s. Exact for inputs that are held.

use crate::compensator::tuned::{DRIVE_CORNER, NOISE_TORQUE, TORQUE_CORNER};
use crate::constants::constants;
use crate::error::{Error, require};
use crate::real::Real;

/// The built filter.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorTorque<R> {
    /// g without a command, and its change by a command.
    gain: [R; 2],
    /// w (N m).
    gross: R,
}

/// y (N m).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotorTorqueState<R> {
    drive_error: R,
}

impl<R: Real> MotorTorqueState<R> {
    /// Torque error of the drive: measured less commanded torque, filtered (N m).
    #[inline(always)]
    pub fn drive_error(&self) -> R {
        self.drive_error
    }
}

impl<R: Real> MotorTorque<R> {
    /// For a motor of this peak torque (N m) and the period dt of its steps (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `dt` unless above 0 and up to 1, `motor_torque` unless positive.
    pub fn build(peak_torque: R, dt: R) -> Result<Self, Error> {
        require(dt > R::ZERO && dt <= R::ONE, "dt")?;
        require(peak_torque > R::ZERO, "motor_torque")?;
        let corners = [TORQUE_CORNER, DRIVE_CORNER];
        let [alone, commanded] = corners.map(|corner| (dt * R::lit(corner.get())).one_minus_exp_neg());
        Ok(Self { gain: [alone, commanded - alone], gross: R::lit(NOISE_TORQUE.get()) * peak_torque })
    }

    /// Torque over the period that ended, from the `commanded` torque, its feedback gain, and the `measured` one.
    #[inline(always)]
    pub fn step(&self, state: &mut MotorTorqueState<R>, commanded: R, feedback_gain: R, measured: R) -> R {
        let [alone, change] = self.gain;
        let commanded = feedback_gain * commanded;
        let residual = measured - commanded - state.drive_error;
        let small = residual.limit(self.gross);
        state.drive_error += residual - small + (alone + feedback_gain * change) * small;
        commanded + state.drive_error
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensator::schedule::CONTROL_PERIOD;

    /// Output for a measurement that differs from the command by a wave of `frequency` (rad/s), largest after a
    /// while.
    fn passed(frequency: f64, followed: f64) -> f64 {
        let (filter, mut state) =
            (MotorTorque::build(200.0, CONTROL_PERIOD).unwrap(), MotorTorqueState::default());
        let outputs = (0..200_000).map(|k| {
            let wave = (frequency * CONTROL_PERIOD * f64::from(k)).sin();
            filter.step(&mut state, 2.0, followed, 2.0 * followed + wave) - 2.0 * followed
        });
        outputs.skip(100_000).fold(0.0, f64::max)
    }

    #[test]
    fn slow_differences_pass_and_fast_ones_do_not() {
        for (corner, followed) in [(DRIVE_CORNER.get(), 1.0), (TORQUE_CORNER.get(), 0.0)] {
            assert!(passed(0.1 * corner, followed) > 0.99);
            assert!((passed(corner, followed) - 0.5f64.sqrt()).abs() < 0.01);
            assert!(passed(100.0 * corner, followed) < 0.013);
        }
    }

    /// A drive that gives 0.05 N m less than it is commanded is seen within a second, the noise of its measurement is not.
    #[test]
    fn a_drive_that_gives_less_is_seen_and_noise_is_not() {
        let (filter, mut state) =
            (MotorTorque::build(2.4, CONTROL_PERIOD).unwrap(), MotorTorqueState::default());
        let noise = |period: u32| if period.is_multiple_of(2) { 0.01 } else { -0.01 };
        let torques = (0..20_000).map(|period| filter.step(&mut state, 1.0, 1.0, 0.95 + noise(period)));
        assert!(torques.skip(20_000 - 100).all(|torque: f64| (torque - 0.95).abs() < 1e-3));
    }

    #[test]
    fn a_command_without_drive_error_passes_unfiltered() {
        let (filter, mut state) =
            (MotorTorque::<f64>::build(200.0, CONTROL_PERIOD).unwrap(), MotorTorqueState::default());
        for commanded in [1.0, -2.0, 0.5] {
            assert_eq!(filter.step(&mut state, commanded, 1.0, commanded), commanded);
        }
    }

    #[test]
    fn a_drive_that_is_switched_off_passes_unfiltered() {
        let (filter, mut state) =
            (MotorTorque::build(2.0, CONTROL_PERIOD).unwrap(), MotorTorqueState::default());
        for commanded in [1.0, -2.0, 0.5, 2.0] {
            assert!(filter.step(&mut state, commanded, 1.0, 0.0).abs() <= NOISE_TORQUE.get() * 2.0);
        }
    }

    /// Noise of 0.85 % of the peak torque, twice that of the default joint: an unfiltered tail would stay in y.
    #[test]
    fn the_tails_of_noise_are_filtered() {
        let noise = 0.0085 * 2.0;
        let (filter, mut state) =
            (MotorTorque::build(2.0, CONTROL_PERIOD).unwrap(), MotorTorqueState::default());
        let mut seed = 1u64;
        let mut uniform = move || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1u64 << 53) as f64
        };
        let squares = (0..100_000).map(|_| {
            let normal = (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
            filter.step(&mut state, 0.0, 1.0, noise * normal).powi(2)
        });
        let passed = (squares.sum::<f64>() / 1e5).sqrt();
        assert!(passed < 0.03 * noise, "{passed} of {noise}");
    }
}
