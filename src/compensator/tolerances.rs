//! How well a joint is known, and which part of its torques is uncertain for that.
//!
//! ```text
//! torque of the motor, less what accelerates its rotor       m*(d_kt + d_J)
//! torque by the torsion, against the motor's                 m*(d_kt + d_K)
//! torque by a sensor at the output, against the motor's      m*d_kt
//! peak torque of the gear, which none of them may exceed     m*d_kt
//! ```
//!
//! d are the largest relative deviations of torque constant, rotor inertia and stiffness, m = 1.5: a sound joint is to stay within, at a
//! corner of its tolerances and with what they do not say. What exceeds them is a fault.

use crate::compensator::tuned::UNCERTAINTY_MARGIN;
use crate::error::{Error, require};
use crate::real::Real;

/// Largest relative deviations of a joint from the parameters that it is built from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerances<R> {
    /// Of the drive's torque constant, 0..=0.5.
    pub torque_constant: R,
    /// Of the rotor's inertia, 0..=0.5.
    pub rotor_inertia: R,
    /// Of the gear's stiffness, 0..=0.5.
    pub stiffness: R,
}

impl<R: Real> Tolerances<R> {
    /// Every tolerance is within its range.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `torque_constant_tolerance`, `rotor_inertia_tolerance` or `stiffness_tolerance`.
    pub fn check(&self) -> Result<(), Error> {
        let within = |tolerance: R| tolerance >= R::ZERO && tolerance <= R::lit(0.5);
        require(within(self.torque_constant), "torque_constant_tolerance")?;
        require(within(self.rotor_inertia), "rotor_inertia_tolerance")?;
        require(within(self.stiffness), "stiffness_tolerance")
    }

    /// Part of the motor's torque, less what accelerates its rotor, that is uncertain.
    pub fn of_motor(&self) -> R {
        with_margin(self.torque_constant + self.rotor_inertia)
    }

    /// Part of the gear's torque by its torsion that is uncertain, against the motor's.
    pub fn of_torsion(&self) -> R {
        with_margin(self.torque_constant + self.stiffness)
    }

    /// Part of the gear's torque by a torque sensor that is uncertain, against the motor's.
    pub fn of_torque_sensor(&self) -> R {
        with_margin(self.torque_constant)
    }

    /// Part of the gear's peak torque that a command may ask for: what the motor makes of it is not to exceed the whole.
    pub fn of_peak(&self) -> R {
        R::ONE - with_margin(self.torque_constant)
    }
}

fn with_margin<R: Real>(tolerance: R) -> R {
    R::lit(UNCERTAINTY_MARGIN.get()) * tolerance
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Of the default gear.
    pub const TENTHS: Tolerances<f64> =
        Tolerances { torque_constant: 0.1, rotor_inertia: 0.1, stiffness: 0.1 };

    const KNOWN: Tolerances<f64> = Tolerances { torque_constant: 0.1, rotor_inertia: 0.2, stiffness: 0.05 };

    #[test]
    fn a_torque_is_as_uncertain_as_what_it_is_computed_from() {
        let found = [KNOWN.of_motor(), KNOWN.of_torsion(), KNOWN.of_torque_sensor()];
        let expected = [0.3, 0.15, 0.1].map(|sum| UNCERTAINTY_MARGIN.get() * sum);
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{found:?}");
        assert!((KNOWN.of_peak() - 0.85).abs() < 1e-15);
    }

    #[test]
    fn a_tolerance_out_of_range_is_named() {
        assert_eq!(KNOWN.check(), Ok(()));
        let refused = |tolerances: Tolerances<f64>| tolerances.check().unwrap_err();
        let named = Error::OutOfRange;
        assert_eq!(refused(Tolerances { torque_constant: 0.6, ..KNOWN }), named("torque_constant_tolerance"));
        assert_eq!(refused(Tolerances { rotor_inertia: -0.1, ..KNOWN }), named("rotor_inertia_tolerance"));
        assert_eq!(refused(Tolerances { stiffness: f64::NAN, ..KNOWN }), named("stiffness_tolerance"));
    }
}
