//! LuGre: the mean deflection of elastic bristles, with the Stribeck effect.
//!
//! ```text
//! dz/dt = v - sigma0*|v|/g(v) * z              g(v) = Fc + (Fs - Fc)*exp(-|v/vs|^delta)
//! F = sigma0*z + sigma1*dz/dt + sigma2*v
//! ```
//!
//! Sign: F has the sign of v in steady sliding and is subtracted in the equation of motion. Units: z (m) or
//! (rad), sigma0 (N/m) or (N m/rad), sigma1, sigma2 (N s/m) or (N m s/rad), levels (N) or (N m), vs (m/s)
//! or (rad/s). sigma2 is the contact's `viscous`.
//!
//! Discretisation: exact over a step of constant velocity, because dz/ds = sign(v) - sigma0/g(v)*z is
//! linear in the path length s = |v|*dt:
//!
//! ```text
//! z <- z + (1 - e^(-sigma0*s/g)) * (g/sigma0*sign(v) - z)          dz/dt at the end of the step
//! ```
//!
//! so that no step is too long; an explicit step of this equation diverges past sigma0*|v|*dt/g = 2.
//!
//! Work: sigma0*z + sigma2*v alone loses work over any closed motion, with the storage sigma0*z^2/2 and
//! whatever g does in time. sigma1*dz/dt keeps that where |z| <= g/sigma0, so always with Fs = Fc, and else
//! where sigma1 <= 4*g(v)/|v| at every speed (Olsson's thesis); the canonical sigma1 = sqrt(sigma0*M)
//! passes that bound at high speed.
//!
//! Known weakness: sigma1 is no measured quantity, and one that damps presliding well makes fast sliding
//! after rest gain work (above); presliding loops don't close on their own turning points (no reversal
//! memory), and under a load that oscillates below Fs the body creeps.
//!
//! C. Canudas de Wit, H. Olsson, K. J. Åström, P. Lischinsky, "A new model for control of systems with
//! friction", IEEE Transactions on Automatic Control 40 (1995); H. Olsson, "Control systems with friction",
//! thesis, Lund 1996.

use super::data::{CURVE, FrictionData, PRESLIDING};
use super::lubricated_contact::{LubricatedContact, LubricatedContactParams};
use super::registered::{Registered, Standstill};
use super::{FrictionModel, FrictionParams, GREATEST, LEAST, Slip, require_divisor, require_level};
use crate::error::{Error, require};
use crate::real::Real;

/// Sliding curve, stiffness and damping of the bristles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LuGreParams<R> {
    /// g(v) and sigma2; its `coulomb` must be at least 1e-9.
    pub contact: LubricatedContactParams<R>,
    /// sigma0 (N/m) or (N m/rad); 1e-9..=1e9.
    pub stiffness: R,
    /// sigma1 (N s/m) or (N m s/rad); 0..=1e6.
    pub damping: R,
}

impl<R: Real> FrictionParams<R> for LuGreParams<R> {
    type Model = LuGre<R>;

    /// # Errors
    /// [`Error::OutOfRange`] with the name of the field, the contact's too.
    fn build(&self) -> Result<LuGre<R>, Error> {
        let contact = self.contact.build()?;
        require_divisor(self.contact.coulomb, "coulomb")?;
        require((R::lit(LEAST)..=R::lit(1e3 * GREATEST)).contains(&self.stiffness), "stiffness")?;
        require_level(self.damping, "damping")?;
        Ok(LuGre { contact, stiffness: self.stiffness, damping: self.damping })
    }
}

impl<R: Real> Registered<R> for LuGreParams<R> {
    const NEEDS: &'static [&'static [&'static str]] = &[CURVE, PRESLIDING];
    const MAY_HAVE: &'static [&'static str] = &["micro_damping_nm_s_per_rad"];
    const STANDSTILL: Standstill = Standstill::Presliding;
    const STICK_SLIP: bool = true;

    /// sigma0 = Fs/eps: without sigma1 it is Bliman and Sorine's order 1 at the level g.
    fn of_data(data: &FrictionData<R>) -> Self {
        Self {
            contact: LubricatedContactParams::of_data(data),
            stiffness: data.forward.static_level / data.presliding,
            damping: data.micro_damping,
        }
    }
}

/// sigma0*z, and the last force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LuGreState<R> {
    elastic: R,
    force: R,
}

/// Built model.
///
/// In steady sliding it lies on the curve of the lubricated contact:
///
/// ```
/// use strainwave::friction::{FrictionModel, FrictionParams, LuGreParams, LubricatedContactParams, Slip};
///
/// let contact = LubricatedContactParams {
///     coulomb: 1.0_f64, static_level: 1.5, stribeck_velocity: 1e-3, stribeck_exponent: 2.0, viscous: 0.4,
/// };
/// let friction = LuGreParams { contact, stiffness: 1e5, damping: 100.0 }.build()?;
/// for velocity in [1e-4, 1e-3, 1e-2] {
///     let (mut state, slip) = (Default::default(), Slip::new(velocity, 1e-5));
///     let force = (0..200_000).fold(0.0, |_, _| friction.step(&mut state, &slip).force);
///     let steady = contact.build()?.level(velocity) + 0.4 * velocity;
///     assert!((force - steady).abs() < 1e-5, "{force} {steady}");
/// }
/// # Ok::<(), strainwave::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LuGre<R> {
    contact: LubricatedContact<R>,
    stiffness: R,
    damping: R,
}

impl<R: Real> FrictionModel<R> for LuGre<R> {
    type State = LuGreState<R>;

    #[inline(always)]
    fn force(&self, state: &Self::State) -> R {
        state.force
    }

    #[inline(always)]
    fn advance(&self, state: &mut Self::State, slip: &Slip<R>) {
        let velocity = slip.velocity;
        let direction = velocity.sign();
        let level = self.contact.level(velocity);
        let inverse = R::ONE / level;
        let covered = (slip.displacement().abs() * self.stiffness * inverse).one_minus_exp_neg();
        let missing = direction * level - state.elastic;
        state.elastic += covered * missing;
        // dz/dt = |v|*(missing at the end of the step)/g: no difference of near numbers in steady sliding.
        let rate = velocity.abs() * (missing * (R::ONE - covered)) * inverse;
        state.force = state.elastic + self.damping * rate + self.contact.viscous(velocity);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::tests::{Extremes, contact};
    use std::vec;
    use std::vec::Vec;

    impl<R: Real> Extremes<R> for LuGreParams<R> {
        fn extremes() -> Vec<Self> {
            let extreme =
                LubricatedContactParams { coulomb: R::lit(1e-9), static_level: R::lit(1e6), ..contact() };
            vec![Self { contact: extreme, stiffness: R::lit(1e9), damping: R::lit(1e6) }]
        }
    }

    fn params<R: Real>() -> LuGreParams<R> {
        let contact = LubricatedContactParams {
            coulomb: R::ONE,
            static_level: R::lit(1.5),
            stribeck_velocity: R::lit(1e-3),
            stribeck_exponent: R::lit(2.0),
            viscous: R::lit(0.4),
        };
        LuGreParams { contact, stiffness: R::lit(1e5), damping: R::lit(1e5).sqrt() }
    }

    #[test]
    fn steady_sliding_lies_on_the_stribeck_curve() {
        let model = params::<f64>().build().unwrap();
        for velocity in [-1.0f64, -1e-3, 2e-4, 0.02] {
            let mut state = LuGreState::default();
            let force =
                (0..10).map(|_| model.step(&mut state, &Slip::new(velocity, 0.5)).force).last().unwrap();
            let level = 1.0 + 0.5 * (-(velocity / 1e-3).powi(2)).exp();
            assert!((force - level * velocity.signum() - 0.4 * velocity).abs() < 1e-12, "{velocity}");
        }
    }

    /// dz/dt by fourth-order Runge-Kutta, in steps a thousand times shorter.
    #[test]
    fn a_step_of_any_length_solves_the_equation() {
        let model = params::<f64>().build().unwrap();
        for (velocity, duration) in [(1e-3, 1e-3), (-5e-3, 2e-3), (0.1, 1e-4), (0.1, 1e-2)] {
            let level = 1.0 + 0.5 * (-(velocity / 1e-3f64).powi(2)).exp();
            let rate = |z: f64| velocity - 1e5 * velocity.abs() / level * z;
            let (mut z, h) = (0.0, duration / 1e5);
            for _ in 0..100_000 {
                let k1 = rate(z);
                let k2 = rate(z + 0.5 * h * k1);
                let k3 = rate(z + 0.5 * h * k2);
                z += h / 6.0 * (k1 + 2.0 * (k2 + k3) + rate(z + h * k3));
            }
            let force = model.step(&mut LuGreState::default(), &Slip::new(velocity, duration)).force;
            let expected = 1e5 * z + 1e5f64.sqrt() * rate(z) + 0.4 * velocity;
            assert!((force - expected).abs() < 1e-9, "{velocity} {duration}: {force} {expected}");
        }
    }

    #[test]
    fn a_parameter_out_of_range_is_named() {
        let name = |change: fn(&mut LuGreParams<f64>)| {
            let mut changed = params();
            change(&mut changed);
            changed.build().unwrap_err()
        };
        assert_eq!(name(|p| p.contact.coulomb = 0.0), Error::OutOfRange("coulomb"));
        assert_eq!(name(|p| p.contact.static_level = 0.5), Error::OutOfRange("static_level"));
        assert_eq!(name(|p| p.contact.stribeck_velocity = 0.0), Error::OutOfRange("stribeck_velocity"));
        assert_eq!(name(|p| p.stiffness = 0.0), Error::OutOfRange("stiffness"));
        assert_eq!(name(|p| p.damping = -1.0), Error::OutOfRange("damping"));
    }
}
