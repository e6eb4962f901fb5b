//! Torque of a motor over its angle: cogging, which is there without current, and ripple of the torque constant.
//!
//! ```text
//! tau_motor = tau_shaft*(1 + b*sin(m*theta + q)) + a*sin(k*theta + p)
//! ```
//!
//! theta is the rotor's angle relative to the case, k and m are orders a revolution. Cogging has no mean over a revolution, so that it
//! gives no work over one. Units: a (N m), b without. Memoryless.

use strainwave::Angle;

use crate::sensor::Wave;

/// Both of a motor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cogging {
    /// Cogging (N m).
    pub cogging: Wave,
    /// Ripple, as a fraction of the torque.
    pub ripple: Wave,
}

impl Cogging {
    /// An ideal motor.
    pub const NONE: Self = Self { cogging: Wave::NONE, ripple: Wave::NONE };

    /// Torque of the motor (N m) at its angle, of the drive's on the shaft.
    pub(super) fn torque(&self, shaft: f64, angle: Angle<f64>) -> f64 {
        shaft * (1.0 + self.ripple.at(angle)) + self.cogging.at(angle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MOTOR: Cogging = Cogging {
        cogging: Wave { order: 12, amplitude: 0.01, phase: 0.4 },
        ripple: Wave { order: 6, amplitude: 0.02, phase: -1.0 },
    };

    #[test]
    fn none_leaves_the_torque_as_it_is() {
        let angle = Angle::from_radians_f64(1.0);
        assert_eq!(Cogging::default().torque(0.123, angle), 0.123);
    }

    #[test]
    fn the_torque_repeats_every_turn_and_cogging_works_nothing() {
        let at = |k: u32| Angle::from_counts(i64::from(k) << 22);
        let mut mean = 0.0;
        for k in 0..1024 {
            let torque = MOTOR.torque(1.0, at(k));
            assert_eq!(torque, MOTOR.torque(1.0, at(k + 1024)));
            let angle = at(k).to_radians();
            let expected = 1.0 + 0.02 * (6.0 * angle - 1.0).sin() + 0.01 * (12.0 * angle + 0.4).sin();
            assert!((torque - expected).abs() < 1e-12);
            mean += MOTOR.torque(0.0, at(k)) / 1024.0;
        }
        assert!(mean.abs() < 1e-12, "{mean}");
    }
}
