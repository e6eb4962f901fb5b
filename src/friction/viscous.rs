//! Viscous friction.
//!
//! ```text
//! F = Fv * v
//! ```
//!
//! Sign: F has the sign of v and is subtracted in the equation of motion. Units: Fv (N s/m) or (N m s/rad).
//! Memoryless: there is nothing to discretise.
//!
//! Known weakness: no friction at standstill. The loss of a gear grows more slowly than v, and falls as the
//! lubricant warms, by a factor of 3 and more.
//!
//! O. Reynolds, "On the theory of lubrication", 1886; H. Olsson et al., "Friction models and friction
//! compensation", European Journal of Control 4 (1998), eq. (2).

use super::data::FrictionData;
use super::registered::{Registered, Standstill};
use super::{FrictionModel, FrictionParams, LastForce, Slip, require_level};
use crate::error::Error;
use crate::real::Real;

/// One factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViscousParams<R> {
    /// Fv (N s/m) or (N m s/rad); 0..=1e6.
    pub viscous: R,
}

impl<R: Real> FrictionParams<R> for ViscousParams<R> {
    type Model = Viscous<R>;

    /// # Errors
    /// [`Error::OutOfRange`] `viscous`.
    fn build(&self) -> Result<Viscous<R>, Error> {
        require_level(self.viscous, "viscous")?;
        Ok(Viscous { viscous: self.viscous })
    }
}

impl<R: Real> Registered<R> for ViscousParams<R> {
    const NEEDS: &'static [&'static [&'static str]] = &[&["viscous_nm_s_per_rad"]];
    const STANDSTILL: Standstill = Standstill::Free;
    const STICK_SLIP: bool = false;

    fn of_data(data: &FrictionData<R>) -> Self {
        Self { viscous: data.forward.viscous }
    }
}

/// Built model.
///
/// Speed decays by the factor e in the time m/Fv:
///
/// ```
/// use strainwave::friction::{FrictionModel, FrictionParams, LastForce, Slip, ViscousParams};
///
/// let (friction, mut state) = (ViscousParams { viscous: 4.0 }.build()?, LastForce::default());
/// let (mass, dt, mut velocity) = (2.0_f64, 1e-4, 1.0);
/// for _ in 0..5000 {
///     velocity -= friction.step(&mut state, &Slip::new(velocity, dt)).force / mass * dt;
/// }
/// assert!((velocity - (-1.0_f64).exp()).abs() < 1e-4); // after 0.5 s
/// # Ok::<(), strainwave::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viscous<R> {
    viscous: R,
}

impl<R: Real> FrictionModel<R> for Viscous<R> {
    type State = LastForce<R>;

    fn force(&self, state: &Self::State) -> R {
        state.0
    }

    fn advance(&self, state: &mut Self::State, slip: &Slip<R>) {
        state.0 = self.viscous * slip.velocity;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::tests::Extremes;
    use std::vec;
    use std::vec::Vec;

    impl<R: Real> Extremes<R> for ViscousParams<R> {
        fn extremes() -> Vec<Self> {
            vec![Self { viscous: R::lit(0.5) }]
        }
    }

    #[test]
    fn it_is_proportional_to_the_velocity() {
        let model = ViscousParams { viscous: 0.5 }.build().unwrap();
        let force = |velocity: f64| model.step(&mut LastForce::default(), &Slip::new(velocity, 1e-3)).force;
        assert_eq!([-4.0, 0.0, 3.0].map(force), [-2.0, 0.0, 1.5]);
        let named = ViscousParams { viscous: f64::NAN }.build().unwrap_err();
        assert_eq!(named, Error::OutOfRange("viscous"));
    }
}
