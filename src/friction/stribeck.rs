//! Stribeck effect: sliding friction falls from the static level as speed builds up a film of lubricant.
//!
//! ```text
//! v != 0:  F = (Fc + (Fs - Fc) * exp(-|v/vs|^delta)) * sign(v) + Fv*v
//! v = 0:   F = F_e where |F_e| <= Fs,  else Fs * sign(F_e)
//! ```
//!
//! Table 1 gives the exponential alone, which is what the effect adds to Coulomb's level. The sliding curve
//! is that of [`super::LubricatedContact`]; here standstill is static friction.
//!
//! Sign: at standstill F has the sign of F_e, in motion that of v; it is subtracted in the equation of
//! motion. Units: see [`LubricatedContactParams`]. Memoryless: there is nothing to discretise.
//!
//! Known weakness: that of static friction, v = 0 must be met exactly. The slope dF/dv < 0 below vs is
//! negative damping, and the curve holds for steady speed only: measured friction lags behind it.
//!
//! R. Stribeck, "Die wesentlichen Eigenschaften der Gleit- und Rollenlager", Zeitschrift des VDI 46 (1902);
//! H. Olsson et al., "Friction models and friction compensation", European Journal of Control 4 (1998),
//! eqs. (4), (5).

use super::data::{CURVE, FrictionData};
use super::lubricated_contact::{LubricatedContact, LubricatedContactParams};
use super::registered::{Registered, Standstill};
use super::{FrictionModel, FrictionParams, LastForce, Slip};
use crate::error::Error;
use crate::real::Real;

/// The sliding curve; its level at v = 0 is the static one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StribeckParams<R> {
    /// Curve over speed.
    pub contact: LubricatedContactParams<R>,
}

impl<R: Real> FrictionParams<R> for StribeckParams<R> {
    type Model = Stribeck<R>;

    /// # Errors
    /// [`Error::OutOfRange`] with the name of the contact's field.
    fn build(&self) -> Result<Stribeck<R>, Error> {
        Ok(Stribeck { contact: self.contact.build()? })
    }
}

impl<R: Real> Registered<R> for StribeckParams<R> {
    const NEEDS: &'static [&'static [&'static str]] = &[CURVE];
    const STANDSTILL: Standstill = Standstill::Static;
    const STICK_SLIP: bool = true;

    fn of_data(data: &FrictionData<R>) -> Self {
        Self { contact: LubricatedContactParams::of_data(data) }
    }
}

/// Built model.
///
/// Friction falls as a slow motion gets faster, which is why a slow drive may stick and slip, and rises again where
/// the viscous part prevails:
///
/// ```
/// use strainwave::friction::{FrictionModel, FrictionParams, LastForce, LubricatedContactParams, Slip, StribeckParams};
///
/// let contact = LubricatedContactParams {
///     coulomb: 0.035, static_level: 0.050, stribeck_velocity: 2.0, stribeck_exponent: 1.0, viscous: 1.2e-4,
/// };
/// let (friction, mut state) = (StribeckParams { contact }.build()?, LastForce::default());
/// let mut force = |velocity| friction.step(&mut state, &Slip::new(velocity, 1e-4)).force;
/// assert!(force(0.1) > force(1.0) && force(1.0) > force(10.0));
/// assert!(force(100.0) > force(10.0));
/// let at_vs: f64 = 0.035 + 0.015 * (-1.0_f64).exp() + 1.2e-4 * 2.0;
/// assert!((force(2.0) - at_vs).abs() < 1e-12);
/// # Ok::<(), strainwave::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stribeck<R> {
    contact: LubricatedContact<R>,
}

impl<R: Real> FrictionModel<R> for Stribeck<R> {
    type State = LastForce<R>;
    const READS_APPLIED: bool = true;

    fn force(&self, state: &Self::State) -> R {
        state.0
    }

    fn advance(&self, state: &mut Self::State, slip: &Slip<R>) {
        state.0 = self.contact.standing_or_sliding(slip.velocity == R::ZERO, slip);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::tests::{Extremes, contact};
    use std::vec;
    use std::vec::Vec;

    impl<R: Real> Extremes<R> for StribeckParams<R> {
        fn extremes() -> Vec<Self> {
            vec![Self { contact: contact() }]
        }
    }

    #[test]
    fn standstill_holds_what_is_applied_and_sliding_falls_with_speed() {
        let contact = LubricatedContactParams {
            coulomb: 1.0,
            static_level: 1.5,
            stribeck_velocity: 0.1,
            stribeck_exponent: 2.0,
            viscous: 0.0,
        };
        let model = StribeckParams { contact }.build().unwrap();
        let force = |velocity: f64, applied| {
            model.step(&mut LastForce::default(), &Slip::new(velocity, 1e-3).under(applied, 0.0)).force
        };
        assert_eq!([-9.0, -0.7, 0.0, 1.6].map(|applied| force(0.0, applied)), [-1.5, -0.7, 0.0, 1.5]);
        assert!((force(0.1, 0.0) - (1.0 + 0.5 * (-1.0f64).exp())).abs() < 1e-15);
        assert!(force(1e-9, 0.0) > force(0.05, 0.0) && force(0.05, 0.0) > force(5.0, 0.0));
        let named = StribeckParams { contact: LubricatedContactParams { coulomb: -1.0, ..contact } };
        assert_eq!(named.build().unwrap_err(), Error::OutOfRange("coulomb"));
    }
}
