//! The gear's friction block, the same type at the wave generator and at the flexspline.
//!
//! ```text
//! dx_i/ds = (f_i*g*sign(v) - x_i) / (eps_i*g/g0)       F = sum x_i + Fv*v
//! g       = (Fc + (Fs - Fc)*exp(-|v/vs|^delta)) * ripple(theta_wg) + k*|tau|
//! ```
//!
//! g is the level: that of the lubricated contact, times what the ripple over the wave generator's angle
//! makes of it, plus what the torque tau through the contact adds. Fc, Fs, vs, Fv and the ripple have one value
//! for forward and one for backward motion; k one while the motor drives the load (tau*v > 0) and another
//! while the load drives the motor. f_i and eps_i are the levels and distances of a Bliman-Sorine model whose
//! kinetic level f1 - f2 is 1; g0 is Fs of forward motion.
//!
//! Levels: order 1 has f1 = 1. Order 2 has f1 = 1/(1 - eta), f2 = eta/(1 - eta), so that eta alone shapes
//! the rise: x peaks at s = eps*eta/(1-eta) * ln(1/eta^2) before it settles. A slow break-away from rest
//! therefore passes Fs by that peak: for eta = 0.3 it needs 1.107 Fs.
//!
//! Sign: F has the sign of the velocity that it opposes and is subtracted in the equation of motion; F*v >
//! 0 is power lost. Units: (N m), (rad), (rad/s); k has no unit.
//!
//! Discretisation: exact over a step of constant velocity and level.
//!
//! Work: never negative from rest, so over any closed motion, whatever speed, load and angle make of the
//! level. In the stretched path dq = g0/g ds the equation is that of Bliman and Sorine, dx_i/dq = (f_i*u -
//! x_i)/eps_i, with the input u = g*sign(v) instead of sign(v). Their transfer function is positive real, so
//! that the integral of F*u dq is not negative for any u whatever; and u dq = g0*sign(v) ds = g0*dx.
//!
//! Two simpler ways to let the level vary do not have this. The product g*z with a normalised z and
//! dx_i/ds = (f_i*g*sign(v) - x_i)/eps_i both have a stiffness that follows g: loaded fast and unloaded
//! slowly, or the other way round, they return more than they stored, to second order in the stroke, while
//! the loss is of third order. Steady sliding is the same in all three: g*sign(v) + Fv*v. With this one,
//! presliding is as stiff at every level, f_i*g0/eps_i, and its distance grows with the level, as in LuGre.
//!
//! Known weakness: that presliding distance depends on speed and load is not measured on a strain-wave gear;
//! the break-away peak and eta are tied together; the level follows the load at once, without its lag.
//!
//! P.-A. Bliman, M. Sorine, European Control Conference, 1995; H. Olsson et al., European Journal of Control 4
//! (1998); the load's factors as in [`super::load_dependence`].

use super::bliman_sorine::{BlimanSorine, BlimanSorineParams, BlimanSorineState};
use super::load_dependence::{DirectedLoad, LoadFactors};
use super::lubricated_contact::{LubricatedContact, LubricatedContactParams};
use super::ripple::{Harmonics, RippleParams};
use super::{Friction, FrictionModel, FrictionParams, LIMIT, Slip, StepTime};
use crate::angle::Heading;
use crate::error::{Error, require};
use crate::real::Real;

/// Orders of the ripple, 1..=2 a turn of the wave generator.
pub const RIPPLE_ORDERS: usize = 2;

/// Levels below this count as this (N m): a level divides.
const LEAST_LEVEL: f64 = 1e-9;

/// Order of the Bliman-Sorine dynamics.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Order {
    /// Dahl's monotone rise.
    One,
    /// Rise with a peak.
    #[default]
    Two,
}

/// Friction of one side of the gear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointFrictionParams<R> {
    /// Order of the presliding dynamics.
    pub order: Order,
    /// Fc, Fs, vs, delta and Fv of motion forwards.
    pub forward: LubricatedContactParams<R>,
    /// Those of motion backwards.
    pub backward: LubricatedContactParams<R>,
    /// eps (rad), at the level of `forward.static_level`; 1e-9..=1e6.
    pub presliding: R,
    /// eta; 0.01..=0.99, unused with order 1.
    pub presliding_ratio: R,
    /// What the torque through the contact adds to the level.
    pub load: LoadFactors<R>,
    /// Share of the level over the wave generator's angle.
    pub ripple: RippleParams<R, RIPPLE_ORDERS>,
}

impl<R: Real> JointFrictionParams<R> {
    /// The same both ways, without load or ripple.
    pub fn symmetric(
        order: Order,
        contact: LubricatedContactParams<R>,
        presliding: R,
        presliding_ratio: R,
    ) -> Self {
        Self {
            order,
            forward: contact,
            backward: contact,
            presliding,
            presliding_ratio,
            load: LoadFactors::default(),
            ripple: RippleParams::NONE,
        }
    }

    /// Every level and viscous friction times `factor`.
    pub fn scale(&mut self, factor: R) {
        for contact in [&mut self.forward, &mut self.backward] {
            contact.coulomb *= factor;
            contact.static_level *= factor;
            contact.viscous *= factor;
        }
        self.load.driving *= factor;
        self.load.driven *= factor;
    }

    /// Order 1 is built as an order 2 whose second force stays at zero: one type, one code path.
    fn normalised_presliding(&self) -> Result<BlimanSorine<R, 2>, Error> {
        let (eps, eta) = (self.presliding, self.presliding_ratio);
        require((R::lit(1e-9)..=R::lit(1e6)).contains(&eps), "presliding")?;
        match self.order {
            Order::One => BlimanSorineParams { levels: [R::ONE, R::ZERO], distances: [eps, eps] },
            Order::Two => {
                require((R::lit(0.01)..=R::lit(0.99)).contains(&eta), "presliding_ratio")?;
                let f1 = R::ONE / (R::ONE - eta);
                BlimanSorineParams { levels: [f1, -eta * f1], distances: [eta * eps, eps] }
            }
        }
        .build_dissipative()
    }
}

impl<R: Real> FrictionParams<R> for JointFrictionParams<R> {
    type Model = JointFriction<R>;

    /// # Errors
    /// [`Error::OutOfRange`] with the name of the field, the contacts' and the ripple's too.
    fn build(&self) -> Result<JointFriction<R>, Error> {
        let (forward, backward) = (with_a_level(self.forward), with_a_level(self.backward));
        let ripple = self.ripple.build()?;
        let [load, backward_load] = self.load.build()?;
        // The path is divided by g alone: g0 is in the distances.
        let inverse_level = R::ONE / forward.static_level;
        let presliding = self.normalised_presliding()?.scaled(R::ONE, inverse_level);
        let backward_presliding = presliding.scaled(-R::ONE, R::ONE);
        Ok(JointFriction {
            forward: Side::new(forward.build()?, ripple.forward, load, presliding),
            backward: Side::new(backward.build()?, ripple.backward, backward_load, backward_presliding),
        })
    }
}

/// The same with levels of at least [`LEAST_LEVEL`]; what is refused stays so.
fn with_a_level<R: Real>(contact: LubricatedContactParams<R>) -> LubricatedContactParams<R> {
    let raised = |level: R| if level >= R::ZERO { level.max(R::lit(LEAST_LEVEL)) } else { level };
    let (coulomb, static_level) = (raised(contact.coulomb), raised(contact.static_level));
    LubricatedContactParams { coulomb, static_level, ..contact }
}

/// Presliding forces and the last torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointFrictionState<R> {
    presliding: BlimanSorineState<R, 2>,
    force: R,
}

impl<R: Real> Default for JointFrictionState<R> {
    fn default() -> Self {
        Self { presliding: BlimanSorineState::default(), force: R::ZERO }
    }
}

/// Built model: everything that one direction of motion needs is in one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointFriction<R> {
    forward: Side<R>,
    backward: Side<R>,
}

/// One direction of motion.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Side<R> {
    contact: LubricatedContact<R>,
    ripple: Harmonics<R, RIPPLE_ORDERS>,
    load: DirectedLoad<R>,
    /// Of level 1 in this direction, over the path divided by g.
    presliding: BlimanSorine<R, 2>,
    /// The level is the contact's alone: there is neither ripple nor load.
    plain: bool,
}

impl<R: Real> Side<R> {
    fn new(
        contact: LubricatedContact<R>,
        ripple: Harmonics<R, RIPPLE_ORDERS>,
        load: DirectedLoad<R>,
        presliding: BlimanSorine<R, 2>,
    ) -> Self {
        Self { contact, ripple, load, presliding, plain: ripple.is_none() && load.is_none() }
    }

    /// g.
    #[inline(always)]
    fn level(&self, slip: &Slip<R>) -> R {
        let contact = self.contact.level(slip.velocity);
        if self.plain {
            return contact;
        }
        contact * self.ripple.share(slip.wave_generator) + self.load.level(slip.load)
    }
}

impl<R: Real> JointFriction<R> {
    /// Torque (N m) after `duration` at `velocity` (rad/s), for any bits.
    // Never inlined: the timing budget counts this block by its symbol. Numbers come in registers.
    #[inline(never)]
    fn moved(
        &self,
        state: &mut JointFrictionState<R>,
        velocity: R,
        duration: StepTime<R>,
        load: R,
        wave_generator: Heading<R>,
    ) -> Friction<R> {
        if velocity.abs() + load.abs() <= R::lit(LIMIT) {
            self.slid(state, &Slip { velocity, duration, load, wave_generator, applied: R::ZERO })
        } else {
            self.slid_beyond(state, velocity, duration, load, wave_generator)
        }
    }

    /// From beyond the limits of [`Slip`]. As long as it takes what it is called with, nothing is saved for it.
    #[cold]
    #[inline(never)]
    fn slid_beyond(
        &self,
        state: &mut JointFrictionState<R>,
        velocity: R,
        duration: StepTime<R>,
        load: R,
        wave_generator: Heading<R>,
    ) -> Friction<R> {
        match (Slip { velocity, duration, load, wave_generator, applied: R::ZERO }).limited() {
            Some(slip) => self.slid(state, &slip),
            None => Friction { force: state.force, held: true },
        }
    }

    #[inline(always)]
    fn slid(&self, state: &mut JointFrictionState<R>, slip: &Slip<R>) -> Friction<R> {
        let side = if slip.velocity < R::ZERO { &self.backward } else { &self.forward };
        let level = side.level(slip);
        side.presliding.approach(&mut state.presliding, slip.displacement().abs() / level, level);
        state.force = state.presliding.force() + side.contact.viscous(slip.velocity);
        Friction { force: state.force, held: false }
    }
}

impl<R: Real> FrictionModel<R> for JointFriction<R> {
    type State = JointFrictionState<R>;

    #[inline(always)]
    fn force(&self, state: &Self::State) -> R {
        state.force
    }

    #[inline(always)]
    fn advance(&self, state: &mut Self::State, slip: &Slip<R>) {
        self.step(state, slip);
    }

    #[inline(always)]
    fn step(&self, state: &mut Self::State, slip: &Slip<R>) -> Friction<R> {
        self.moved(state, slip.velocity, slip.duration, slip.load, slip.wave_generator)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::tests::contact;
    use proptest::prelude::*;
    use std::vec::Vec;

    const STEP: f64 = 1e-4;

    fn wave_generator<R: Real>(order: Order) -> JointFrictionParams<R> {
        JointFrictionParams::symmetric(order, contact(), R::lit(0.02), R::lit(0.3))
    }

    /// Everything differs with direction, load and angle.
    fn everything<R: Real>(order: Order) -> JointFrictionParams<R> {
        let harmonics = |mean, a, b| Harmonics {
            mean: R::lit(mean),
            cosines: [a, -0.5 * a].map(R::lit),
            sines: [b, 0.2 * b].map(R::lit),
        };
        JointFrictionParams {
            backward: LubricatedContactParams {
                coulomb: R::lit(0.05),
                static_level: R::lit(0.06),
                stribeck_velocity: R::lit(3.0),
                viscous: R::lit(2e-4),
                ..contact()
            },
            load: LoadFactors { driving: R::lit(0.08), driven: R::lit(0.15) },
            ripple: RippleParams { forward: harmonics(1.0, 0.2, 0.1), backward: harmonics(2.0, -0.5, 0.3) },
            ..wave_generator(order)
        }
    }

    fn force_after(params: &JointFrictionParams<f64>, slips: &[Slip<f64>]) -> f64 {
        let (model, mut state) = (params.build().unwrap(), JointFrictionState::default());
        slips.iter().map(|slip| model.step(&mut state, slip).force).last().unwrap_or_default()
    }

    #[test]
    fn steady_sliding_lies_on_the_level_of_speed_direction_load_and_angle() {
        for order in [Order::One, Order::Two] {
            let params = everything::<f64>(order);
            for (velocity, load, turn) in
                [(-20.0f64, 0.0, 0.0), (-0.3, 0.4, 0.1), (0.3, 0.4, 0.7), (5.0, -0.2, 0.4)]
            {
                let heading = Heading::of_phase((turn * 4_294_967_296.0) as u32);
                let slip = Slip { wave_generator: heading, ..Slip::new(velocity, 0.1).under(0.0, load) };
                let angle = turn * std::f64::consts::TAU;
                let (contact, harmonics) = match velocity < 0.0 {
                    true => (&params.backward, &params.ripple.backward),
                    false => (&params.forward, &params.ripple.forward),
                };
                let ripple = 1.0
                    + (0..2)
                        .map(|k| {
                            let (sine, cosine) = ((k + 1) as f64 * angle).sin_cos();
                            (harmonics.cosines[k] * cosine + harmonics.sines[k] * sine) / harmonics.mean
                        })
                        .sum::<f64>();
                let stribeck = (contact.static_level - contact.coulomb)
                    * (-velocity.abs() / contact.stribeck_velocity).exp();
                let factor = if velocity * load >= 0.0 { 0.08 } else { 0.15 };
                let level = (contact.coulomb + stribeck) * ripple + factor * f64::abs(load);
                let wanted = level * velocity.signum() + contact.viscous * velocity;
                let force = force_after(&params, &[slip; 200]);
                assert!((force - wanted).abs() < 1e-8 * wanted.abs(), "{velocity} {load}: {force} {wanted}");
            }
        }
    }

    /// The same presliding at any level, from the same stiffness.
    #[test]
    fn the_level_stretches_presliding() {
        let plain = LubricatedContactParams { static_level: 0.05, coulomb: 0.05, viscous: 0.0, ..contact() };
        let params = JointFrictionParams::symmetric(Order::Two, plain, 0.02, 0.3);
        let heavy = JointFrictionParams { load: LoadFactors { driving: 0.1, driven: 0.1 }, ..params };
        // A load of 0.5 N m doubles the level: twice the force at twice the path.
        for path in [1e-4, 5e-3, 0.02, 0.1] {
            let once = force_after(&params, &[Slip::new(path, 1.0)]);
            let twice = force_after(&heavy, &[Slip::new(2.0 * path, 1.0).under(0.0, 0.5)]);
            assert!((twice - 2.0 * once).abs() < 1e-9, "{path}: {once} {twice}");
        }
    }

    /// Pieces of motion (velocity, duration, load, turn of the wave generator) that end where they began.
    fn closed_motion() -> impl Strategy<Value = Vec<(f64, f64, f64, u32)>> {
        let piece = (-30.0..30.0f64, 1e-5..0.02f64, -1.0..1.0f64, any::<u32>());
        prop::collection::vec(piece, 1..30).prop_map(|mut pieces| {
            let travelled: f64 = pieces.iter().map(|(velocity, duration, ..)| velocity * duration).sum();
            pieces.push((-travelled / 0.01, 0.01, 0.3, 0));
            pieces
        })
    }

    /// Work lost, in steps short against eps.
    fn work(params: &JointFrictionParams<f64>, pieces: &[(f64, f64, f64, u32)]) -> f64 {
        let (model, mut state) = (params.build().unwrap(), JointFrictionState::default());
        let mut total = 0.0;
        for &(velocity, duration, load, phase) in pieces {
            let steps = (velocity.abs() * duration / (params.presliding * 0.002)).ceil().max(1.0);
            let slip = Slip {
                wave_generator: Heading::of_phase(phase),
                ..Slip::new(velocity, duration / steps).under(0.0, load)
            };
            for _ in 0..steps as usize {
                let before = state.presliding.force();
                model.step(&mut state, &slip);
                let mean = 0.5 * (before + state.presliding.force()) + params.forward.viscous * velocity;
                total += mean * slip.displacement();
            }
        }
        total
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn no_closed_motion_gains_work_whatever_the_level_does(pieces in closed_motion(), two: bool) {
            let params = everything(if two { Order::Two } else { Order::One });
            prop_assert!(work(&params, &pieces) >= -1e-10);
        }

        #[test]
        fn f32_follows_f64(slips in prop::collection::vec((-300.0..300.0f32, -1.0..1.0f32, any::<u32>()), 1..400)) {
            let (single, double) = (everything::<f32>(Order::Two), everything::<f64>(Order::Two));
            let (single, double) = (single.build().unwrap(), double.build().unwrap());
            let (mut a, mut b) = (JointFrictionState::default(), JointFrictionState::default());
            for (velocity, load, phase) in slips {
                let slip = Slip { wave_generator: Heading::of_phase(phase), ..Slip::new(velocity, 1e-4).under(0.0, load) };
                let exact = Slip {
                    wave_generator: Heading::of_phase(phase),
                    ..Slip::new(f64::from(velocity), STEP).under(0.0, f64::from(load))
                };
                let (force, exact) = (single.step(&mut a, &slip).force, double.step(&mut b, &exact).force);
                prop_assert!((f64::from(force) - exact).abs() < 3e-6 * 0.2, "{force} {exact}");
            }
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
        let contact = LubricatedContactParams { viscous: 0.0, ..contact() };
        let model = JointFrictionParams::symmetric(Order::One, contact, 0.02, 0.3).build().unwrap();
        let (mut state, mut force) = (JointFrictionState::default(), 0.0);
        for k in 0..20_000 {
            let slip = Slip::new(10.0 * (f64::from(k) * 0.003).sin() + 0.1, 1e-4);
            let level = 0.035 + 0.015 * (-slip.velocity.abs() / 2.0).exp();
            let wanted = FORMS[2](&mut force, level, slip.displacement());
            assert!((model.step(&mut state, &slip).force - wanted).abs() < 1e-9);
        }
    }

    /// The number in the header: 1.107 Fs for eta = 0.3.
    #[test]
    fn break_away_from_rest_passes_the_static_level_by_the_peak() {
        let place = 0.02 * 0.3 / 0.7 * (1.0 / 0.09f64).ln();
        let exact = (1.0 - (-place / 0.006).exp()) / 0.7 - 0.3 / 0.7 * (1.0 - (-place / 0.02).exp());
        let (model, mut state) = (wave_generator(Order::Two).build().unwrap(), JointFrictionState::default());
        let slowly = Slip::new(place / 10_000.0, 1.0);
        let forces: Vec<f64> = (0..20_000).map(|_| model.step(&mut state, &slowly).force / 0.05).collect();
        let peak = forces.iter().copied().fold(0.0, f64::max);
        assert!((peak - exact).abs() < 1e-6, "{peak} {exact}");
        assert!((peak - 1.107).abs() < 5e-4);
        assert!(forces.last().is_some_and(|last| *last < peak));
    }

    #[test]
    fn no_level_at_all_gives_no_force_to_speak_of_and_one_that_vanishes_with_speed_fades() {
        let none = LubricatedContactParams { coulomb: 0.0, static_level: 0.0, viscous: 0.0, ..contact() };
        let params = JointFrictionParams::symmetric(Order::Two, none, 0.02, 0.3);
        assert!(force_after(&params, &[Slip::new(3.0, 1e-4)]) < 1.2 * LEAST_LEVEL);
        let fading = LubricatedContactParams { static_level: 0.05, ..none };
        let params = JointFrictionParams::symmetric(Order::Two, fading, 0.02, 0.3);
        let faded = force_after(&params, &[Slip::new(0.1, 0.01), Slip::new(1e9, 1e-4)]);
        assert!((faded - LEAST_LEVEL).abs() < 1e-16, "{faded}");
    }

    #[test]
    fn a_parameter_out_of_range_is_named() {
        let name = |change: fn(&mut JointFrictionParams<f64>)| {
            let mut changed = everything(Order::Two);
            change(&mut changed);
            changed.build().unwrap_err()
        };
        assert_eq!(name(|p| p.presliding = 0.0), Error::OutOfRange("presliding"));
        assert_eq!(name(|p| p.presliding_ratio = 1.0), Error::OutOfRange("presliding_ratio"));
        assert_eq!(name(|p| p.forward.coulomb = f64::NAN), Error::OutOfRange("coulomb"));
        assert_eq!(name(|p| p.backward.static_level = 0.01), Error::OutOfRange("static_level"));
        assert_eq!(name(|p| p.load.driven = -0.1), Error::OutOfRange("load.driven"));
        assert_eq!(name(|p| p.ripple.backward.mean = 0.1), Error::OutOfRange("backward"));
    }
}
