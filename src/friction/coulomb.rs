//! Coulomb friction.
//!
//! ```text
//! F = Fc * sign(v),   F = 0 at v = 0
//! ```
//!
//! Sign: F has the sign of v and is subtracted in the equation of motion. Units: Fc (N) or (N m). Memoryless:
//! there is nothing to discretise.
//!
//! Known weakness: at v = 0, where a joint spends most of its time, it is undefined. The jump at v = 0
//! makes a simulation chatter between both signs at every step, and a compensator that adds it hunts.
//!
//! C. A. Coulomb, "Théorie des machines simples", 1785; H. Olsson et al., "Friction models and friction
//! compensation", European Journal of Control 4 (1998), eq. (1).

use super::data::{COULOMB, FrictionData};
use super::registered::{Registered, Standstill};
use super::{FrictionModel, FrictionParams, LastForce, Slip, require_level};
use crate::error::Error;
use crate::real::Real;

/// One level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoulombParams<R> {
    /// Fc (N) or (N m); 0..=1e6.
    pub coulomb: R,
}

impl<R: Real> FrictionParams<R> for CoulombParams<R> {
    type Model = Coulomb<R>;

    /// # Errors
    /// [`Error::OutOfRange`] `coulomb`.
    fn build(&self) -> Result<Coulomb<R>, Error> {
        require_level(self.coulomb, "coulomb")?;
        Ok(Coulomb { coulomb: self.coulomb })
    }
}

impl<R: Real> Registered<R> for CoulombParams<R> {
    const NEEDS: &'static [&'static [&'static str]] = &[COULOMB];
    const STANDSTILL: Standstill = Standstill::Jump;
    const STICK_SLIP: bool = false;

    fn of_data(data: &FrictionData<R>) -> Self {
        Self { coulomb: data.forward.coulomb }
    }
}

/// Built model.
///
/// A body of mass m that slides at v stops after the way m*v^2/(2*Fc):
///
/// ```
/// use strainwave::friction::{CoulombParams, FrictionModel, FrictionParams, LastForce, Slip};
///
/// let (friction, mut state) = (CoulombParams { coulomb: 2.0 }.build()?, LastForce::default());
/// let (mass, dt, mut velocity, mut way) = (1.0_f64, 1e-4, 1.0, 0.0);
/// while velocity > 0.0 {
///     velocity -= friction.step(&mut state, &Slip::new(velocity, dt)).force / mass * dt;
///     way += velocity * dt;
/// }
/// assert!((way - 0.25).abs() < 1e-3);
/// # Ok::<(), strainwave::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coulomb<R> {
    coulomb: R,
}

impl<R: Real> FrictionModel<R> for Coulomb<R> {
    type State = LastForce<R>;

    fn force(&self, state: &Self::State) -> R {
        state.0
    }

    fn advance(&self, state: &mut Self::State, slip: &Slip<R>) {
        state.0 = self.coulomb * slip.velocity.sign();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::tests::Extremes;
    use std::vec;
    use std::vec::Vec;

    impl<R: Real> Extremes<R> for CoulombParams<R> {
        fn extremes() -> Vec<Self> {
            vec![Self { coulomb: R::lit(0.035) }]
        }
    }

    #[test]
    fn it_has_the_sign_of_the_velocity_and_one_level() {
        let model = CoulombParams { coulomb: 0.7 }.build().unwrap();
        let force = |velocity: f64| model.step(&mut LastForce::default(), &Slip::new(velocity, 1e-3)).force;
        assert_eq!([-5.0, -1e-300, 0.0, 1e-300, 5.0].map(force), [-0.7, -0.7, 0.0, 0.7, 0.7]);
        let named = CoulombParams { coulomb: -0.1 }.build().unwrap_err();
        assert_eq!(named, Error::OutOfRange("coulomb"));
    }
}
