//! The gear's friction block in a form that cannot give work, whatever its level does.
//!
//! ```text
//! dx_i/ds = (f_i*g(v)*sign(v) - x_i) / (eps_i*g(v)/Fs)          F = sum x_i + Fv*v
//! ```
//!
//! g(v) is the lubricated contact's level, f_i and eps_i the normalised Bliman-Sorine levels and distances
//! of [`super::joint_friction`], whose parameters it shares. Steady sliding lies on the same curve,
//! g(v)*sign(v) + Fv*v, and at v -> 0 both are the same model. In fast sliding presliding is shorter, by
//! g/Fs, so that its stiffness Fs/eps, not its distance, is the same at every speed, as in LuGre.
//!
//! Sign: F has the sign of the velocity that it opposes and is subtracted in the equation of motion; F*v >
//! 0 is power lost. Units: (N m), (rad), (rad/s).
//!
//! Discretisation: exact over a step of constant velocity.
//!
//! Work: never negative from rest, so over any closed motion. In the stretched path dq = Fs/g ds the
//! equation is that of Bliman and Sorine, dx_i/dq = (f_i*u - x_i)/eps_i, with the input u = g/Fs*sign(v)
//! (times Fs) instead of sign(v). Their transfer function is positive real, so that the integral of F*u dq
//! is not negative for any u whatever; and u dq = sign(v) ds = dx.
//!
//! Two other ways to let the level vary do not have this. The product g(v)*z of [`super::JointFriction`]
//! and dx_i/ds = (f_i*g*sign(v) - x_i)/eps_i both have a stiffness that follows g(v): loaded fast and
//! unloaded slowly, or the other way round, they return more than they stored, to second order in the
//! stroke, while the loss is of third order.
//!
//! Known weakness: one division more a step than the product; presliding length depends on speed, which
//! nobody has measured on a strain-wave gear.
//!
//! P.-A. Bliman, M. Sorine, European Control Conference, 1995; the proof is the one of LuGre's sigma0*z.

use super::bliman_sorine::{BlimanSorine, BlimanSorineState};
use super::joint_friction::JointFrictionParams;
use super::lubricated_contact::LubricatedContact;
use super::{FrictionModel, Slip};
use crate::error::{Error, require};
use crate::real::Real;

impl<R: Real> JointFrictionParams<R> {
    /// The same parameters in the form that cannot give work.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the name of the field.
    pub fn build_passive(&self) -> Result<PassiveFriction<R>, Error> {
        let contact = self.contact().build()?;
        let static_level = self.static_level;
        require(static_level > R::ZERO, "static_level")?;
        let inverse_static_level = R::ONE / static_level;
        Ok(PassiveFriction {
            presliding: self.normalised_presliding()?,
            contact,
            static_level,
            inverse_static_level,
        })
    }
}

/// Presliding forces over Fs, and the last torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassiveFrictionState<R> {
    presliding: BlimanSorineState<R, 2>,
    force: R,
}

impl<R: Real> Default for PassiveFrictionState<R> {
    fn default() -> Self {
        Self { presliding: BlimanSorineState::default(), force: R::ZERO }
    }
}

/// Built model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassiveFriction<R> {
    presliding: BlimanSorine<R, 2>,
    contact: LubricatedContact<R>,
    static_level: R,
    /// 1/Fs.
    inverse_static_level: R,
}

impl<R: Real> FrictionModel<R> for PassiveFriction<R> {
    type State = PassiveFrictionState<R>;

    #[inline(always)]
    fn force(&self, state: &Self::State) -> R {
        state.force
    }

    #[inline(always)]
    fn advance(&self, state: &mut Self::State, slip: &Slip<R>) {
        let share = self.contact.level(slip.velocity) * self.inverse_static_level;
        self.presliding.slide_at(&mut state.presliding, slip.displacement(), share);
        state.force = self.static_level * state.presliding.force() + self.contact.viscous(slip.velocity);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::Order;

    fn params(order: Order) -> JointFrictionParams<f64> {
        JointFrictionParams {
            order,
            coulomb: 0.035,
            static_level: 0.05,
            stribeck_velocity: 2.0,
            stribeck_exponent: 1.0,
            viscous: 1.2e-4,
            presliding: 0.02,
            presliding_ratio: 0.3,
        }
    }

    #[test]
    fn steady_sliding_lies_on_the_same_curve_as_the_product() {
        for order in [Order::One, Order::Two] {
            let model = params(order).build_passive().unwrap();
            for velocity in [-200.0f64, -2.0, -0.1, 0.3, 5.0] {
                let mut state = PassiveFrictionState::default();
                (0..100).for_each(|_| model.advance(&mut state, &Slip::new(velocity, 0.1)));
                let level = 0.035 + 0.015 * (-velocity.abs() / 2.0).exp();
                let wanted = level * velocity.signum() + 1.2e-4 * velocity;
                assert!((model.force(&state) - wanted).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn without_a_stribeck_effect_it_is_the_product() {
        let params = JointFrictionParams { static_level: 0.035, ..params(Order::Two) };
        let (passive, product) = (params.build_passive().unwrap(), params.build(1e-4).unwrap());
        let (mut a, mut b) = Default::default();
        for k in 0..20_000 {
            let slip = Slip::new(100.0 * (f64::from(k) * 0.003).sin(), 1e-4);
            let (one, two) = (passive.step(&mut a, &slip), FrictionModel::step(&product, &mut b, &slip));
            assert!((one.force - two.force).abs() < 1e-15);
        }
    }

    /// Forces by the path, a step at a time, at a level and +-displacement.
    type Form = fn(&mut f64, f64, f64) -> f64;

    const FORMS: [Form; 3] = [
        // The product: z, and F = g*z.
        |z, level, way| {
            *z += (way.abs() / 0.02).one_minus_exp_neg() * (way.signum() - *z);
            level * *z
        },
        // The level as the target.
        |force, level, way| {
            *force += (way.abs() / 0.02).one_minus_exp_neg() * (level * way.signum() - *force);
            *force
        },
        // The level as the target, and the distance shorter with it.
        |force, level, way| {
            *force +=
                (way.abs() * 0.05 / (0.02 * level)).one_minus_exp_neg() * (level * way.signum() - *force);
            *force
        },
    ];

    /// Mean force, over Fc, that drives strokes of a tenth of eps, at one level up to the middle of each
    /// and at the other from there: above zero, the form gives work.
    fn gain(form: Form, levels: [f64; 2]) -> f64 {
        const CUTS: usize = 500;
        let (length, mut state, mut given) = (0.1 * 0.02, 0.0, 0.0);
        form(&mut state, levels[1], 0.5 * length);
        for k in 0..400 {
            let way = length / (2 * CUTS) as f64 * if k % 2 == 0 { -1.0 } else { 1.0 };
            for level in levels {
                let mut before = form(&mut state.clone(), level, 0.0 * way);
                for _ in 0..CUTS {
                    let after = form(&mut state, level, way);
                    given -= if k < 200 { 0.0 } else { 0.5 * (before + after) * way };
                    before = after;
                }
            }
        }
        given / (200.0 * length * 0.035)
    }

    /// What the header says of the three forms, at Fs/Fc = 10/7.
    #[test]
    fn only_the_form_of_constant_stiffness_never_gives_work() {
        let (slow, fast) = (0.05, 0.035);
        let both = |form| [gain(form, [slow, fast]), gain(form, [fast, slow])];
        let [product, target, passive] = FORMS.map(both);
        assert!(product[0] > 1e-3 && product[1] < 0.0, "{product:?}");
        assert!(target[0] < 0.0 && target[1] > 1e-3, "{target:?}");
        assert!(passive[0] < 0.0 && passive[1] < 0.0, "{passive:?}");
    }

    /// The third form is this file's model.
    #[test]
    fn order_1_is_the_form_of_constant_stiffness() {
        let model = JointFrictionParams { viscous: 0.0, ..params(Order::One) }.build_passive().unwrap();
        let (mut state, mut force) = (PassiveFrictionState::default(), 0.0);
        for k in 0..20_000 {
            let slip = Slip::new(10.0 * (f64::from(k) * 0.003).sin() + 0.1, 1e-4);
            let level = 0.035 + 0.015 * (-slip.velocity.abs() / 2.0).exp();
            let wanted = FORMS[2](&mut force, level, slip.displacement());
            assert!((model.step(&mut state, &slip).force - wanted).abs() < 1e-15);
        }
    }

    #[test]
    fn no_level_at_all_is_refused_and_one_that_vanishes_with_speed_is_not() {
        let none = JointFrictionParams { coulomb: 0.0, static_level: 0.0, ..params(Order::Two) };
        assert_eq!(none.build_passive().unwrap_err(), Error::OutOfRange("static_level"));
        let vanishing = JointFrictionParams { coulomb: 0.0, viscous: 0.0, ..params(Order::Two) };
        let mut state = PassiveFrictionState::default();
        assert_eq!(vanishing.build_passive().unwrap().step(&mut state, &Slip::new(1e9, 1e-4)).force, 0.0);
    }
}
