//! Static friction: at standstill it holds whatever is applied, up to a level.
//!
//! ```text
//! v = 0:   F = F_e where |F_e| <= Fs,  else Fs * sign(F_e)
//! v != 0:  F = Fc * sign(v)
//! ```
//!
//! F_e is what everything else applies to the body. Table 1 has the first line; a body that moves needs the
//! second, here Coulomb's.
//!
//! Sign: at standstill F has the sign of F_e, in motion that of v; it is subtracted in the equation of
//! motion. Units: (N) or (N m). Memoryless: there is nothing to discretise.
//!
//! Known weakness: v = 0 must be met exactly, which a simulation or an encoder never does ([`super::Karnopp`]
//! widens it). The applied force must be known, which is an algebraic loop wherever it depends on F.
//!
//! A. Morin, "New friction experiments carried out at Metz in 1831-1833", 1833; H. Olsson et al., "Friction
//! models and friction compensation", European Journal of Control 4 (1998), eq. (3).

use super::data::{FrictionData, LEVELS};
use super::registered::{Registered, Standstill};
use super::{FrictionModel, FrictionParams, LastForce, Slip, require_level};
use crate::error::{Error, require};
use crate::real::Real;

/// Levels at standstill and in motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticParams<R> {
    /// Fc (N) or (N m); 0..=1e6.
    pub coulomb: R,
    /// Fs (N) or (N m); `coulomb`..=1e6.
    pub static_level: R,
}

impl<R: Real> FrictionParams<R> for StaticParams<R> {
    type Model = Static<R>;

    /// # Errors
    /// [`Error::OutOfRange`] `coulomb` or `static_level`.
    fn build(&self) -> Result<Static<R>, Error> {
        require_level(self.coulomb, "coulomb")?;
        require_level(self.static_level, "static_level")?;
        require(self.static_level >= self.coulomb, "static_level")?;
        Ok(Static { coulomb: self.coulomb, static_level: self.static_level })
    }
}

impl<R: Real> Registered<R> for StaticParams<R> {
    const NEEDS: &'static [&'static [&'static str]] = &[LEVELS];
    const STANDSTILL: Standstill = Standstill::Static;
    const STICK_SLIP: bool = true;

    fn of_data(data: &FrictionData<R>) -> Self {
        Self { coulomb: data.forward.coulomb, static_level: data.forward.static_level }
    }
}

/// Built model.
///
/// It holds up to Fs, and slides at Fc:
///
/// ```
/// use strainwave::friction::{FrictionModel, FrictionParams, LastForce, Slip, StaticParams};
///
/// let friction = StaticParams { coulomb: 1.0, static_level: 1.3 }.build()?;
/// let mut state = LastForce::default();
/// let mut force = |velocity, applied| friction.step(&mut state, &Slip::new(velocity, 1e-4).under(applied, 0.0)).force;
/// assert_eq!(force(0.0, 1.2), 1.2); // held: nothing moves
/// assert_eq!(force(0.0, 2.0), 1.3); // 0.7 N m are left to accelerate the body
/// assert_eq!(force(0.1, 2.0), 1.0); // and more once it slides
/// # Ok::<(), strainwave::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Static<R> {
    coulomb: R,
    static_level: R,
}

impl<R: Real> FrictionModel<R> for Static<R> {
    type State = LastForce<R>;
    const READS_APPLIED: bool = true;

    fn force(&self, state: &Self::State) -> R {
        state.0
    }

    fn advance(&self, state: &mut Self::State, slip: &Slip<R>) {
        state.0 = if slip.velocity == R::ZERO {
            slip.applied.limit(self.static_level)
        } else {
            self.coulomb * slip.velocity.sign()
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::tests::Extremes;
    use std::vec;
    use std::vec::Vec;

    impl<R: Real> Extremes<R> for StaticParams<R> {
        fn extremes() -> Vec<Self> {
            vec![Self { coulomb: R::lit(0.035), static_level: R::lit(0.05) }]
        }
    }

    #[test]
    fn it_holds_up_to_its_level_and_slides_below_it() {
        let model = StaticParams { coulomb: 1.0, static_level: 1.5 }.build().unwrap();
        let force = |velocity: f64, applied| {
            model.step(&mut LastForce::default(), &Slip::new(velocity, 1e-3).under(applied, 0.0)).force
        };
        assert_eq!([-9.0, -0.7, 0.0, 1.6].map(|applied| force(0.0, applied)), [-1.5, -0.7, 0.0, 1.5]);
        assert_eq!([-3.0, 1e-30].map(|velocity| force(velocity, 0.0)), [-1.0, 1.0]);
        let named = |coulomb, static_level| StaticParams { coulomb, static_level }.build().unwrap_err();
        assert_eq!(named(-1.0, 1.0), Error::OutOfRange("coulomb"));
        assert_eq!(named(1.0, 0.5), Error::OutOfRange("static_level"));
    }
}
