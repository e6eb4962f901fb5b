//! Lubricated contact: Coulomb friction that falls from the static level with speed (Stribeck),
//! plus a viscous part.
//!
//! ```text
//! g(v) = Fc + (Fs - Fc) * exp(-|v/vs|^delta)        F = g(v)*sign(v) + Fv*v,   F = 0 at v = 0
//! ```
//!
//! Sign: F has the sign of v and is subtracted in the equation of motion. Units: Fc, Fs (N) or
//! (N m), v, vs (m/s) or (rad/s), Fv (N s/m) or (N m s/rad). Memoryless: there is nothing to
//! discretise. Only delta = 1 and 2 exist, because a power has no place in the control step and
//! measured curves do not separate other exponents.
//!
//! Known weakness: no friction at v = 0 and a jump at it, as Coulomb's, unless it is used as the level
//! of a model with presliding; the slope below vs is negative damping; measured friction lags behind speed,
//! this does not.
//!
//! H. Olsson et al., "Friction models and friction compensation", European Journal of Control 4
//! (1998), eq. (5).

use super::data::{CURVE, FrictionData, Sliding};
use super::registered::{Registered, Standstill};
use super::{FrictionModel, FrictionParams, GREATEST, LastForce, Slip};
use crate::constants::constants;
use crate::error::{Error, require};
use crate::real::Real;

/// Level over speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LubricatedContactParams<R> {
    /// Fc, the level that fast sliding tends to (N) or (N m); 0..=1e6.
    pub coulomb: R,
    /// Fs, the level at standstill (N) or (N m); `coulomb`..=1e6.
    pub static_level: R,
    /// vs (m/s) or (rad/s); 1e-9..=1e6.
    pub stribeck_velocity: R,
    /// delta; 1 or 2.
    pub stribeck_exponent: R,
    /// Fv (N s/m) or (N m s/rad); 0..=1e6.
    pub viscous: R,
}

impl<R: Real> FrictionParams<R> for LubricatedContactParams<R> {
    type Model = LubricatedContact<R>;

    /// # Errors
    /// [`Error::OutOfRange`] with the name of the field.
    fn build(&self) -> Result<LubricatedContact<R>, Error> {
        let (least, greatest) = (R::lit(1e-9), R::lit(GREATEST));
        let squared = self.stribeck_exponent == R::lit(2.0);
        require((R::ZERO..=greatest).contains(&self.coulomb), "coulomb")?;
        require((self.coulomb..=greatest).contains(&self.static_level), "static_level")?;
        require((least..=greatest).contains(&self.stribeck_velocity), "stribeck_velocity")?;
        require(squared || self.stribeck_exponent == R::ONE, "stribeck_exponent")?;
        require((R::ZERO..=greatest).contains(&self.viscous), "viscous")?;
        let slowness = R::ONE / self.stribeck_velocity;
        Ok(LubricatedContact {
            coulomb: self.coulomb,
            rise: self.static_level - self.coulomb,
            slowness: if squared { [R::ZERO, slowness * slowness] } else { [slowness, R::ZERO] },
            viscous: self.viscous,
        })
    }
}

impl<R: Real> LubricatedContactParams<R> {
    /// Curve of one direction.
    pub(super) fn of_sliding(sliding: &Sliding<R>) -> Self {
        Self {
            coulomb: sliding.coulomb,
            static_level: sliding.static_level,
            stribeck_velocity: sliding.stribeck_velocity,
            stribeck_exponent: sliding.stribeck_exponent,
            viscous: sliding.viscous,
        }
    }
}

impl<R: Real> Registered<R> for LubricatedContactParams<R> {
    const NEEDS: &'static [&'static [&'static str]] = &[CURVE];
    const STANDSTILL: Standstill = Standstill::Jump;
    const STICK_SLIP: bool = true;

    fn of_data(data: &FrictionData<R>) -> Self {
        Self::of_sliding(&data.forward)
    }
}

/// Built model.
///
/// The level is Fs at standstill and Fc in fast sliding; between them the curve has the slope -(Fs - Fc)/vs at v = 0,
/// which is negative damping:
///
/// ```
/// use strainwave::friction::{FrictionParams, LubricatedContactParams};
///
/// let params = LubricatedContactParams {
///     coulomb: 1.0_f64, static_level: 1.3, stribeck_velocity: 0.02, stribeck_exponent: 1.0, viscous: 4.0,
/// };
/// let contact = params.build()?;
/// assert!((contact.level(0.0) - 1.3).abs() < 1e-12);
/// assert!((contact.level(2.0) - 1.0).abs() < 1e-12);
/// let slope = (contact.level(1e-6) - contact.level(0.0)) / 1e-6;
/// assert!((slope + 0.3 / 0.02).abs() < 1e-2);
/// # Ok::<(), strainwave::Error>(())
/// ```
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LubricatedContact<R> {
    coulomb: R,
    /// Fs - Fc.
    rise: R,
    /// 1/vs^delta, of delta = 1 and of delta = 2; the other is 0.
    slowness: [R; 2],
    viscous: R,
}

impl<R: Real> LubricatedContact<R> {
    /// g(v): between Fc and Fs, for a velocity within the limits of [`Slip`].
    #[inline(always)]
    pub fn level(&self, velocity: R) -> R {
        let (speed, [first, second]) = (velocity.abs(), self.slowness);
        let exponent = speed * (first + speed * second);
        self.coulomb + self.rise * (R::ONE - exponent.one_minus_exp_neg())
    }

    /// Fv*v.
    #[inline(always)]
    pub fn viscous(&self, velocity: R) -> R {
        self.viscous * velocity
    }

    /// F(v) for a finite velocity within the limits of [`Slip`].
    #[inline]
    pub(super) fn sliding(&self, velocity: R) -> R {
        self.level(velocity) * velocity.sign() + self.viscous(velocity)
    }

    /// Friction that balances the force applied to a body at rest, at most Fs; else the sliding force.
    #[inline]
    pub(super) fn standing_or_sliding(&self, stands: bool, slip: &Slip<R>) -> R {
        if stands { slip.applied.limit(self.level(R::ZERO)) } else { self.sliding(slip.velocity) }
    }
}

impl<R: Real> FrictionModel<R> for LubricatedContact<R> {
    type State = LastForce<R>;

    fn force(&self, state: &Self::State) -> R {
        state.0
    }

    fn advance(&self, state: &mut Self::State, slip: &Slip<R>) {
        state.0 = self.sliding(slip.velocity);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::tests::{Extremes, contact};
    use proptest::prelude::*;
    use std::vec;
    use std::vec::Vec;

    impl<R: Real> Extremes<R> for LubricatedContactParams<R> {
        fn extremes() -> Vec<Self> {
            vec![contact()]
        }
    }

    fn params(stribeck_exponent: f64) -> LubricatedContactParams<f64> {
        LubricatedContactParams {
            coulomb: 0.035,
            static_level: 0.05,
            stribeck_velocity: 2.0,
            stribeck_exponent,
            viscous: 1.2e-4,
        }
    }

    #[test]
    fn the_curve_is_stribecks() {
        for exponent in [1.0, 2.0] {
            let model = params(exponent).build().unwrap();
            assert_eq!(model.level(0.0), 0.05);
            assert_eq!(model.sliding(0.0), 0.0);
            let standing = |applied| model.standing_or_sliding(true, &Slip { applied, ..Slip::default() });
            assert_eq!([-9.0, 0.01, 0.2].map(standing), [-0.05, 0.01, 0.05]);
            for v in [-7.0f64, -1.0, 0.3, 2.0, 50.0] {
                let level = 0.035 + 0.015 * (-(v / 2.0).abs().powf(exponent)).exp();
                let force = level * v.signum() + 1.2e-4 * v;
                assert!((model.sliding(v) - force).abs() < 1e-16);
            }
        }
    }

    #[test]
    fn a_parameter_out_of_range_is_named() {
        let name = |change: fn(&mut LubricatedContactParams<f64>)| {
            let mut changed = params(1.0);
            change(&mut changed);
            changed.build().unwrap_err()
        };
        assert_eq!(name(|p| p.coulomb = -1.0), Error::OutOfRange("coulomb"));
        assert_eq!(name(|p| p.static_level = 0.03), Error::OutOfRange("static_level"));
        assert_eq!(name(|p| p.stribeck_velocity = 0.0), Error::OutOfRange("stribeck_velocity"));
        assert_eq!(name(|p| p.stribeck_exponent = 1.5), Error::OutOfRange("stribeck_exponent"));
        assert_eq!(name(|p| p.viscous = f64::INFINITY), Error::OutOfRange("viscous"));
    }

    proptest! {
        #[test]
        fn the_level_stays_between_its_ends(velocity in -1e9..1e9f64, squared: bool) {
            let model = params(if squared { 2.0 } else { 1.0 }).build().unwrap();
            prop_assert!((0.035..=0.05).contains(&model.level(velocity)));
        }
    }
}
