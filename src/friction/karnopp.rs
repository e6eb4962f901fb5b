//! Karnopp's model: within a dead band of velocity the body counts as standing still.
//!
//! ```text
//! |v| >= DV:  F = (Fc + (Fs - Fc) * exp(-|v/vs|^delta)) * sign(v) + Fv*v
//! |v| <  DV:  F = F_e where |F_e| <= Fs,  else Fs * sign(F_e)
//! ```
//!
//! The switch is on |v|; the paper's table lost the bars. F_e is what everything else applies to the body.
//!
//! Sign: within the band F has the sign of F_e, outside that of v; it is subtracted in the equation of
//! motion. Units: DV (m/s) or (rad/s), the others as in [`LubricatedContactParams`]. Memoryless: there is
//! nothing to discretise.
//!
//! Known weakness: the band is a trick of simulation. Within it there is no presliding stiffness; a body that
//! enters it with v != 0 drifts on unless the simulation sets v to 0; F may push along v there, so that the
//! model can give work; and the applied force must be known, which ties it to the rest of the model.
//!
//! D. Karnopp, "Computer simulation of stick-slip friction in mechanical dynamic systems", Journal of Dynamic
//! Systems, Measurement, and Control 107 (1985); H. Olsson et al., European Journal of Control 4 (1998).

use super::data::{CURVE, FrictionData};
use super::lubricated_contact::{LubricatedContact, LubricatedContactParams};
use super::registered::{Registered, Standstill};
use super::{FrictionModel, FrictionParams, LastForce, Slip, require_divisor};
use crate::error::Error;
use crate::real::Real;

/// Sliding curve and dead band.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KarnoppParams<R> {
    /// Curve over speed; its level at v = 0 is the static one.
    pub contact: LubricatedContactParams<R>,
    /// DV (m/s) or (rad/s); 1e-9..=1e6.
    pub dead_band: R,
}

impl<R: Real> FrictionParams<R> for KarnoppParams<R> {
    type Model = Karnopp<R>;

    /// # Errors
    /// [`Error::OutOfRange`] `dead_band` or the name of the contact's field.
    fn build(&self) -> Result<Karnopp<R>, Error> {
        require_divisor(self.dead_band, "dead_band")?;
        Ok(Karnopp { contact: self.contact.build()?, dead_band: self.dead_band })
    }
}

impl<R: Real> Registered<R> for KarnoppParams<R> {
    const NEEDS: &'static [&'static [&'static str]] = &[CURVE, &["dead_band_rad_per_s"]];
    const STANDSTILL: Standstill = Standstill::Static;
    const STICK_SLIP: bool = true;

    fn of_data(data: &FrictionData<R>) -> Self {
        Self { contact: LubricatedContactParams::of_data(data), dead_band: data.dead_band }
    }
}

/// Built model.
///
/// Within the dead band the body is in equilibrium although its velocity is not exactly 0:
///
/// ```
/// use strainwave::friction::{FrictionModel, FrictionParams, KarnoppParams, LastForce, LubricatedContactParams, Slip};
///
/// let contact = LubricatedContactParams {
///     coulomb: 1.0, static_level: 1.3, stribeck_velocity: 0.02, stribeck_exponent: 1.0, viscous: 4.0,
/// };
/// let friction = KarnoppParams { contact, dead_band: 1e-3 }.build()?;
/// let mut state = LastForce::default();
/// let mut force = |velocity, applied| friction.step(&mut state, &Slip::new(velocity, 1e-4).under(applied, 0.0)).force;
/// for applied in [-1.2, 0.0, 0.7] {
///     assert_eq!(applied - force(5e-4, applied), 0.0); // no net force, so no acceleration
/// }
/// assert!(2.0 - force(5e-4, 2.0) > 0.0); // breaks away
/// # Ok::<(), strainwave::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Karnopp<R> {
    contact: LubricatedContact<R>,
    dead_band: R,
}

impl<R: Real> FrictionModel<R> for Karnopp<R> {
    type State = LastForce<R>;
    const READS_APPLIED: bool = true;

    fn force(&self, state: &Self::State) -> R {
        state.0
    }

    fn advance(&self, state: &mut Self::State, slip: &Slip<R>) {
        state.0 = self.contact.standing_or_sliding(slip.velocity.abs() < self.dead_band, slip);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::tests::{Extremes, contact};
    use std::vec;
    use std::vec::Vec;

    impl<R: Real> Extremes<R> for KarnoppParams<R> {
        fn extremes() -> Vec<Self> {
            vec![Self { contact: contact(), dead_band: R::lit(0.01) }]
        }
    }

    #[test]
    fn the_band_holds_what_is_applied_and_beyond_it_the_body_slides() {
        let contact = LubricatedContactParams {
            coulomb: 1.0,
            static_level: 1.5,
            stribeck_velocity: 0.1,
            stribeck_exponent: 1.0,
            viscous: 0.4,
        };
        let model = KarnoppParams { contact, dead_band: 0.01 }.build().unwrap();
        let force = |velocity: f64, applied| {
            model.step(&mut LastForce::default(), &Slip::new(velocity, 1e-3).under(applied, 0.0)).force
        };
        assert_eq!(
            [(0.009, 0.3), (-0.009, 0.3), (0.0, 9.0), (0.0, -9.0)].map(|(v, f)| force(v, f)),
            [0.3, 0.3, 1.5, -1.5]
        );
        let sliding = 1.0 + 0.5 * (-0.1f64).exp() + 0.004;
        assert!((force(0.01, 0.3) - sliding).abs() < 1e-15 && (force(-0.01, 0.3) + sliding).abs() < 1e-15);
        let named = |contact, dead_band| KarnoppParams { contact, dead_band }.build().unwrap_err();
        assert_eq!(named(contact, 0.0), Error::OutOfRange("dead_band"));
        let swapped = LubricatedContactParams { static_level: 0.5, ..contact };
        assert_eq!(named(swapped, 0.01), Error::OutOfRange("static_level"));
    }
}
