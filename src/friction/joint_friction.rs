//! The gear's friction block, the same type at the wave generator and at the flexspline.
//!
//! ```text
//! F = g(v) * z + Fv*v
//! g(v) = Fc + (Fs - Fc) * exp(-|v/vs|^delta)                  the lubricated contact's level
//! z    = Bliman-Sorine force with kinetic level f1 - f2 = 1   presliding, in the path length
//! ```
//!
//! Normalised levels: order 1 has f1 = 1. Order 2 has f1 = 1/(1 - eta), f2 = eta/(1 - eta), so that
//! eta alone shapes the rise: z peaks at s = eps*eta/(1-eta) * ln(1/eta^2) before it settles at 1.
//! A slow break-away from rest therefore passes Fs by that peak: for eta = 0.3 it needs 1.107 Fs.
//!
//! Sign: F has the sign of the velocity that it opposes and is subtracted in the equation of
//! motion; F*v > 0 is power lost. Units: (N m), (rad), (rad/s).
//!
//! Discretisation: z is exact over a step of constant velocity, g is taken at that velocity.
//!
//! Work: with Fs = Fc the block is dissipative over any motion from rest, as z is. With Fs > Fc it
//! is not: strokes inside presliding that each start slowly and end fast release at level Fs what
//! they stored at level Fc. For Fs/Fc = 10/7 the gain is at most a mean force of 0.0073 Fc (order 1,
//! strokes of 0.27 eps) or 0.009 Fc (order 2 with eta = 0.3, 0.075 eps); a viscous loss comes off
//! it. At the default gear that leaves at most 0.0005 Fc at the wave generator and nothing at the
//! flexspline. Equal strokes longer than 0.6 eps always lose.

use super::bliman_sorine::{BlimanSorine, BlimanSorineParams, BlimanSorineState};
use super::lubricated_contact::{LubricatedContact, LubricatedContactParams};
use super::{Friction, FrictionModel, Slip};
use crate::error::{Error, require};
use crate::real::Real;

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
    /// Fc (N m); 0..=1e6.
    pub coulomb: R,
    /// Fs (N m); `coulomb`..=1e6.
    pub static_level: R,
    /// vs (rad/s); 1e-9..=1e6.
    pub stribeck_velocity: R,
    /// delta; 1 or 2.
    pub stribeck_exponent: R,
    /// Fv (N m s/rad); 0..=1e6.
    pub viscous: R,
    /// eps (rad); 1e-9..=1e6.
    pub presliding: R,
    /// eta; 0.01..=0.99, unused with order 1.
    pub presliding_ratio: R,
}

impl<R: Real> JointFrictionParams<R> {
    /// Checks and precomputes for steps of `step_time` (s), above 0 and up to 1.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the name of the field, or `step_time`.
    pub fn build(&self, step_time: R) -> Result<JointFriction<R>, Error> {
        require(step_time > R::ZERO && step_time <= R::ONE, "step_time")?;
        let contact = self.contact().build()?;
        Ok(JointFriction { presliding: self.normalised_presliding()?, contact, step_time })
    }

    pub(super) fn contact(&self) -> LubricatedContactParams<R> {
        LubricatedContactParams {
            coulomb: self.coulomb,
            static_level: self.static_level,
            stribeck_velocity: self.stribeck_velocity,
            stribeck_exponent: self.stribeck_exponent,
            viscous: self.viscous,
        }
    }

    /// Order 1 is built as an order 2 whose second force stays at zero: one type, one code path.
    pub(super) fn normalised_presliding(&self) -> Result<BlimanSorine<R, 2>, Error> {
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

/// Presliding state and the last output.
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

impl<R: Real> JointFrictionState<R> {
    /// Torque of the last step (N m).
    #[inline]
    pub fn torque(&self) -> R {
        self.force
    }

    /// z: 1 in steady sliding forwards, -1 backwards.
    #[inline]
    pub fn normalised(&self) -> R {
        self.presliding.force()
    }
}

/// Built model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointFriction<R> {
    presliding: BlimanSorine<R, 2>,
    contact: LubricatedContact<R>,
    step_time: R,
}

impl<R: Real> JointFriction<R> {
    /// Torque (N m) after one step time at `velocity` (rad/s).
    // Never inlined: the timing budget counts this block by its symbol.
    #[inline(never)]
    pub fn step(&self, state: &mut JointFrictionState<R>, velocity: R) -> Friction<R> {
        self.moved(state, velocity * self.step_time, velocity)
    }

    /// Torque (N m) after a `displacement` (rad) at `velocity` (rad/s), for steps of another
    /// length than the built one. The two have one sign, or are zero.
    pub fn step_displacement(
        &self,
        state: &mut JointFrictionState<R>,
        displacement: R,
        velocity: R,
    ) -> Friction<R> {
        if !displacement.is_finite() {
            return Friction { force: state.force, held: true };
        }
        self.moved(state, displacement, velocity)
    }

    /// g(v) (N m).
    #[inline]
    pub fn level(&self, velocity: R) -> R {
        self.contact.level(velocity)
    }

    /// The displacement is finite here: a finite velocity times at most 1 s is.
    #[inline(always)]
    fn moved(&self, state: &mut JointFrictionState<R>, displacement: R, velocity: R) -> Friction<R> {
        let viscous = self.contact.viscous(velocity);
        // Fv*v is finite exactly when v is and the product doesn't overflow: 0*inf is NaN.
        if !viscous.is_finite() {
            return Friction { force: state.force, held: true };
        }
        self.presliding.slide(&mut state.presliding, displacement);
        state.force = self.contact.level(velocity) * state.normalised() + viscous;
        Friction { force: state.force, held: false }
    }
}

impl<R: Real> FrictionModel<R> for JointFriction<R> {
    type State = JointFrictionState<R>;

    fn force(&self, state: &Self::State) -> R {
        state.force
    }

    fn advance(&self, state: &mut Self::State, slip: &Slip<R>) {
        self.moved(state, slip.displacement(), slip.velocity);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const STEP: f64 = 1e-4;

    fn wave_generator<R: Real>(order: Order) -> JointFrictionParams<R> {
        JointFrictionParams {
            order,
            coulomb: R::lit(0.035),
            static_level: R::lit(0.05),
            stribeck_velocity: R::lit(2.0),
            stribeck_exponent: R::ONE,
            viscous: R::lit(1.2e-4),
            presliding: R::lit(0.02),
            presliding_ratio: R::lit(0.3),
        }
    }

    fn level_only(order: Order) -> JointFrictionParams<f64> {
        JointFrictionParams { static_level: 0.035, viscous: 0.0, ..wave_generator(order) }
    }

    /// Work over a motion of pieces (velocity, duration), in steps short against eps.
    fn work(params: &JointFrictionParams<f64>, pieces: &[(f64, f64)]) -> f64 {
        let model = params.build(STEP).unwrap();
        let mut state = JointFrictionState::default();
        let mut total = 0.0;
        for &(velocity, duration) in pieces {
            let steps = (velocity.abs() * duration / (params.presliding * 0.005)).ceil().max(1.0);
            let displacement = velocity * duration / steps;
            for _ in 0..steps as usize {
                let before = state.normalised();
                model.step_displacement(&mut state, displacement, velocity);
                let mean = 0.5 * (before + state.normalised());
                total += (model.level(velocity) * mean + params.viscous * velocity) * displacement;
            }
        }
        total
    }

    /// Pieces of motion that end where they began.
    fn closed_motion() -> impl Strategy<Value = std::vec::Vec<(f64, f64)>> {
        prop::collection::vec((-30.0..30.0f64, 1e-5..0.02f64), 1..30).prop_map(|mut pieces| {
            let travelled: f64 = pieces.iter().map(|(velocity, duration)| velocity * duration).sum();
            pieces.push((-travelled / 0.01, 0.01));
            pieces
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn no_closed_motion_gains_work_at_a_constant_level(pieces in closed_motion(), two: bool) {
            let params = level_only(if two { Order::Two } else { Order::One });
            prop_assert!(work(&params, &pieces) >= -1e-10);
        }

        /// The default gear's viscous loss covers the gain of order 1 entirely and that of order 2
        /// but for 0.0005 Fc.
        #[test]
        fn random_closed_motion_gains_no_work_with_the_stribeck_level(pieces in closed_motion()) {
            let path: f64 = pieces.iter().map(|(velocity, duration)| velocity.abs() * duration).sum();
            prop_assert!(work(&wave_generator(Order::One), &pieces) >= -1e-10);
            prop_assert!(work(&wave_generator(Order::Two), &pieces) >= -1e-10 - 0.0005 * 0.035 * path);
        }

        #[test]
        fn any_input_bits_give_a_finite_torque(bits in prop::collection::vec(any::<u32>(), 1..200)) {
            let params = JointFrictionParams { viscous: 4.0, ..wave_generator::<f32>(Order::Two) };
            let model = params.build(1e-4).unwrap();
            let mut state = JointFrictionState::default();
            for bits in bits {
                let (before, velocity) = (state, f32::from_bits(bits));
                let friction = model.step(&mut state, velocity);
                prop_assert!(friction.force.is_finite());
                prop_assert!(friction.held || velocity.is_finite());
                if friction.held {
                    prop_assert_eq!(before, state);
                    prop_assert_eq!(friction.force, before.torque());
                }
            }
        }

        #[test]
        fn f32_follows_f64(velocities in prop::collection::vec(-300.0..300.0f32, 1..400)) {
            let single = wave_generator::<f32>(Order::Two).build(1e-4).unwrap();
            let double = wave_generator::<f64>(Order::Two).build(STEP).unwrap();
            let (mut a, mut b) = (JointFrictionState::default(), JointFrictionState::default());
            for velocity in velocities {
                let force = single.step(&mut a, velocity).force;
                let exact = double.step(&mut b, f64::from(velocity)).force;
                prop_assert!((f64::from(force) - exact).abs() < 1e-6 * 0.05 + 1e-7 * exact.abs());
            }
        }
    }

    /// Mean force that drives strokes of a length over eps, slow up to the share `switch` of each
    /// and fast from there, relative to Fc.
    fn gain(order: Order, stroke: f64, switch: f64) -> f64 {
        let params = JointFrictionParams { viscous: 0.0, ..wave_generator(order) };
        let length = stroke * params.presliding;
        let (slow, fast) = ((1e-4, switch * length / 1e-4), (1e4, (1.0 - switch) * length / 1e4));
        let mut pieces = std::vec::Vec::from([(1.0, 0.5 * length)]);
        for k in 0..400 {
            let sign = if k % 2 == 0 { -1.0 } else { 1.0 };
            pieces.extend([slow, fast].map(|(velocity, duration)| (sign * velocity, duration)));
        }
        // The last 200 strokes, when z has settled between two values of opposite sign.
        let (early, all) = (work(&params, &pieces[..401]), work(&params, &pieces));
        (early - all) / (200.0 * length * params.coulomb)
    }

    /// The worst motions that the header names.
    #[test]
    fn the_gain_of_a_varying_level_is_as_stated() {
        let worst = |order| {
            let strokes = (1..40).map(|k| 0.01 * f64::from(k));
            strokes.map(|stroke| gain(order, stroke, 0.46)).fold(0.0, f64::max)
        };
        let (one, two) = (worst(Order::One), worst(Order::Two));
        assert!((0.0065..0.0073).contains(&one), "{one}");
        assert!((0.0075..0.009).contains(&two), "{two}");
        for switch in [0.3, 0.35, 0.4, 0.45, 0.5] {
            assert!(gain(Order::One, 0.7, switch) < 0.0 && gain(Order::Two, 0.7, switch) < 0.0);
        }
    }

    #[test]
    fn steady_sliding_lies_on_the_stribeck_curve() {
        let model = wave_generator::<f64>(Order::Two).build(STEP).unwrap();
        for velocity in [-200.0f64, -2.0, -0.1, 0.3, 5.0] {
            let mut state = JointFrictionState::default();
            let steps = (1.0 / (velocity.abs() * STEP)) as usize + 1;
            let force = (0..steps).map(|_| model.step(&mut state, velocity).force).last().unwrap();
            let level = 0.035 + 0.015 * (-velocity.abs() / 2.0).exp();
            assert!((force - level * velocity.signum() - 1.2e-4 * velocity).abs() < 1e-15);
        }
    }

    /// The number in the header: 1.107 Fs for eta = 0.3.
    #[test]
    fn break_away_from_rest_passes_the_static_level_by_the_peak() {
        let params = JointFrictionParams { viscous: 0.0, ..wave_generator(Order::Two) };
        let model = params.build(STEP).unwrap();
        let mut state = JointFrictionState::default();
        let place = 0.02 * 0.3 / 0.7 * (1.0 / 0.09f64).ln();
        let peak = (0..20_000)
            .map(|_| model.step_displacement(&mut state, place / 10_000.0, 1e-9).force / 0.05)
            .fold(0.0, f64::max);
        let exact = (1.0 - (-place / 0.006).exp()) / 0.7 - 0.3 / 0.7 * (1.0 - (-place / 0.02).exp());
        assert!((peak - exact).abs() < 1e-9);
        assert!((peak - 1.107).abs() < 5e-4);
    }

    #[test]
    fn order_1_never_passes_the_static_level() {
        let params = JointFrictionParams { viscous: 0.0, ..wave_generator(Order::One) };
        let model = params.build(STEP).unwrap();
        let mut state = JointFrictionState::default();
        for _ in 0..2000 {
            assert!(model.step_displacement(&mut state, 1e-4, 1e-9).force <= 0.05);
        }
    }

    #[test]
    fn a_built_in_step_is_a_displacement() {
        let model = wave_generator::<f64>(Order::Two).build(STEP).unwrap();
        let (mut a, mut b) = (JointFrictionState::default(), JointFrictionState::default());
        for velocity in [1.0, -3.0, 0.0, 20.0] {
            let step = model.step(&mut a, velocity);
            assert_eq!(step, model.step_displacement(&mut b, velocity * STEP, velocity));
        }
    }

    #[test]
    fn a_parameter_out_of_range_is_named() {
        let name = |change: fn(&mut JointFrictionParams<f64>)| {
            let mut changed = wave_generator(Order::Two);
            change(&mut changed);
            changed.build(STEP).unwrap_err()
        };
        assert_eq!(name(|p| p.presliding = 0.0), Error::OutOfRange("presliding"));
        assert_eq!(name(|p| p.presliding_ratio = 1.0), Error::OutOfRange("presliding_ratio"));
        assert_eq!(name(|p| p.coulomb = f64::NAN), Error::OutOfRange("coulomb"));
        let params = wave_generator::<f64>(Order::Two);
        assert_eq!(params.build(0.0).unwrap_err(), Error::OutOfRange("step_time"));
    }
}
