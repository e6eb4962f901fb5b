//! Bliman-Sorine friction, eqs. (7)-(8): dynamics in the path length instead of in time.
//!
//! ```text
//! s = integral |v| dt        dx_i/ds = (f_i*sign(v) - x_i)/eps_i,   i = 1..P        F = sum x_i
//! ```
//!
//! That is eq. (8) with A = diag(-1/eps_i), B = [f_i/eps_i], C = [1 .. 1]. The levels f_i (N) or
//! (N m) carry a sign; their sum is the kinetic level, which one-way motion tends to. The distances
//! eps_i (m) or (rad) are those over which the force builds up.
//!
//! | order | levels | distances | |
//! | --- | --- | --- | --- |
//! | 1 | f1 | eps | Dahl's model with exponent 1 |
//! | 2 | f1, -f2 | eta*eps, eps | peaks at s = eps*eta/(1-eta) * ln(f1/(eta*f2)), then falls to f1 - f2 |
//!
//! Sign: F opposes the motion when subtracted, F*v > 0 in one-way sliding.
//!
//! Discretisation: exact. Over a step of constant direction and length ds
//!
//! ```text
//! x_i <- x_i + (1 - e^(-ds/eps_i)) * (f_i*sign - x_i)
//! ```
//!
//! so the force is independent of the rate and of how a stroke is cut into steps, and no step is
//! too long. In f32 a step shorter than about 2^-24 eps is lost to rounding.
//!
//! From rest the force is dissipative where its transfer function from sign(v) to F is positive real, which
//! `build` checks ([`super::positive_real`]). That of order 2, f1/(1 + eta*eps*p) - f2/(1 + eps*p), is for
//! f1 > f2 and eta < 1. A general A, B, C is [`super::StateSpace`].
//!
//! Known weakness: static friction is a peak over the path, not a level that a rest restores: after a stop
//! and a start in the same direction there is none. No effect of speed.
//!
//! P.-A. Bliman, M. Sorine, "Easy-to-use realistic dry friction models for automatic control",
//! European Control Conference, 1995; P. Dahl, "A solid friction model", 1968.

use super::positive_real::is_positive_real;
use super::{FrictionModel, Slip};
use crate::constants::constants;
use crate::error::{Error, require};
use crate::real::Real;

/// Levels and distances of order `P`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlimanSorineParams<R, const P: usize> {
    /// Signed levels f_i (N) or (N m); within +-1e6, together dissipative.
    pub levels: [R; P],
    /// Distances eps_i (m) or (rad), 1e-12..=1e6.
    pub distances: [R; P],
}

impl<R: Real, const P: usize> BlimanSorineParams<R, P> {
    /// Checks and precomputes.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `levels` or `distances`.
    pub fn build(&self) -> Result<BlimanSorine<R, P>, Error> {
        let model = self.build_dissipative()?;
        require(self.is_dissipative(), "levels")?;
        Ok(model)
    }

    /// For levels that are dissipative by construction: without that check, and so without its f64.
    pub(super) fn build_dissipative(&self) -> Result<BlimanSorine<R, P>, Error> {
        let greatest = R::lit(1e6);
        require(self.levels.iter().all(|level| level.abs() <= greatest), "levels")?;
        require(self.distances.iter().all(|d| (R::lit(1e-12)..=greatest).contains(d)), "distances")?;
        Ok(BlimanSorine { levels: self.levels, rates: self.distances.map(|distance| R::ONE / distance) })
    }

    fn is_dissipative(&self) -> bool {
        let distances = self.distances.map(Real::to_f64);
        let entry = |i: usize, j: usize| if i == j { -1.0 / distances[i] } else { 0.0 };
        let a = core::array::from_fn(|i| core::array::from_fn(|j| entry(i, j)));
        let b = core::array::from_fn(|i| self.levels[i].to_f64() / distances[i]);
        is_positive_real(&a, &b, &[1.0; P])
    }
}

/// Internal forces x_i; all zero at rest in the middle of presliding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlimanSorineState<R, const P: usize> {
    forces: [R; P],
}

impl<R: Real, const P: usize> Default for BlimanSorineState<R, P> {
    fn default() -> Self {
        Self { forces: [R::ZERO; P] }
    }
}

impl<R: Real, const P: usize> BlimanSorineState<R, P> {
    /// F = sum x_i (N) or (N m).
    #[inline(always)]
    pub fn force(&self) -> R {
        // Not from zero on: adding it is an addition.
        self.forces.iter().copied().reduce(|sum, force| sum + force).unwrap_or(R::ZERO)
    }

    /// sum w_i*x_i (N) or (N m).
    #[inline(always)]
    pub(super) fn weighted(&self, weights: &[R; P]) -> R {
        let products = self.forces.iter().zip(weights).map(|(force, weight)| *force * *weight);
        products.reduce(|sum, force| sum + force).unwrap_or(R::ZERO)
    }
}

/// Built model of order `P`.
///
/// Order 2 breaks away at a peak and falls to the kinetic level f1 - f2. The peak is where the closed form has it, and
/// however the stroke is cut into steps, the force is the same:
///
/// ```
/// use strainwave::friction::{BlimanSorine, FrictionModel, Slip};
///
/// let (f1, f2, eps, eta) = (1.5_f64, 0.5, 2e-4, 0.3);
/// let friction = BlimanSorine::order_2(f1, f2, eps, eta)?;
/// let after = |path: f64, steps: u32| {
///     let mut state = Default::default();
///     let slip = Slip::new(path / f64::from(steps), 1.0);
///     (0..steps).fold(0.0, |_, _| friction.step(&mut state, &slip).force)
/// };
/// let peak = eps * eta / (1.0 - eta) * (f1 / (eta * f2)).ln();
/// assert!(after(peak, 1) > after(0.9 * peak, 1) && after(peak, 1) > after(1.1 * peak, 1));
/// assert!((after(peak, 1) - after(peak, 1000)).abs() < 1e-13);
/// assert!((after(100.0 * eps, 1) - (f1 - f2)).abs() < 1e-13);
/// # Ok::<(), strainwave::Error>(())
/// ```
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlimanSorine<R, const P: usize> {
    levels: [R; P],
    /// 1/eps_i.
    rates: [R; P],
}

impl<R: Real> BlimanSorine<R, 1> {
    /// A = -1/eps, B = f1/eps: Dahl's model. `f1` > 0 (N) or (N m), `eps` > 0 (m) or (rad).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `f1` or `eps`.
    pub fn order_1(f1: R, eps: R) -> Result<Self, Error> {
        require(f1 > R::ZERO && f1 <= R::lit(1e6), "f1")?;
        BlimanSorineParams { levels: [f1], distances: [eps] }
            .build_dissipative()
            .map_err(|_| Error::OutOfRange("eps"))
    }
}

impl<R: Real> BlimanSorine<R, 2> {
    /// A = diag(-1/(eta*eps), -1/eps), B = [f1/(eta*eps), -f2/eps]; `f1` > `f2` > 0 (N) or (N m),
    /// `eps` > 0 (m) or (rad), 0 < `eta` < 1.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `f1`, `f2`, `eps` or `eta`.
    pub fn order_2(f1: R, f2: R, eps: R, eta: R) -> Result<Self, Error> {
        require(f1 > R::ZERO && f1 <= R::lit(1e6), "f1")?;
        require(f2 > R::ZERO && f2 < f1, "f2")?;
        require(eta > R::ZERO && eta < R::ONE, "eta")?;
        BlimanSorineParams { levels: [f1, -f2], distances: [eta * eps, eps] }
            .build_dissipative()
            .map_err(|_| Error::OutOfRange("eps"))
    }
}

impl<R: Real, const P: usize> BlimanSorine<R, P> {
    /// Moves by `displacement` = v*dt (m) or (rad), finite.
    #[inline(always)]
    pub fn slide(&self, state: &mut BlimanSorineState<R, P>, displacement: R) {
        // No motion has no direction either, but then the path length is 0 and nothing changes.
        self.approach(state, displacement.abs(), R::ONE.copysign(displacement));
    }

    /// The same model with levels times `level` and distances times `distance`.
    pub(super) fn scaled(&self, level: R, distance: R) -> Self {
        Self { levels: self.levels.map(|f| f * level), rates: self.rates.map(|rate| rate / distance) }
    }

    /// Moves by a path length (m) or (rad) towards the levels times `target`.
    #[inline(always)]
    pub(super) fn approach(&self, state: &mut BlimanSorineState<R, P>, path: R, target: R) {
        // First all factors: the compiler makes one vector of them where it has any.
        let covered = self.rates.map(|rate| (path * rate).one_minus_exp_neg());
        for ((force, &level), covered) in state.forces.iter_mut().zip(&self.levels).zip(covered) {
            *force += covered * (level * target - *force);
        }
    }
}

impl<R: Real, const P: usize> FrictionModel<R> for BlimanSorine<R, P> {
    type State = BlimanSorineState<R, P>;
    const RATE_INDEPENDENT: bool = true;

    #[inline(always)]
    fn force(&self, state: &Self::State) -> R {
        state.force()
    }

    #[inline(always)]
    fn advance(&self, state: &mut Self::State, slip: &Slip<R>) {
        self.slide(state, slip.displacement());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;

    const F1: f64 = 1.5;
    const F2: f64 = 0.5;
    const EPS: f64 = 0.02;
    const ETA: f64 = 0.3;

    fn order_2<R: Real>() -> BlimanSorine<R, 2> {
        BlimanSorine::order_2(R::lit(F1), R::lit(F2), R::lit(EPS), R::lit(ETA)).unwrap()
    }

    /// F(s) of one-way motion from rest, section 3 of Bliman and Sorine.
    fn one_way(s: f64) -> f64 {
        F1 * (1.0 - (-s / (ETA * EPS)).exp()) - F2 * (1.0 - (-s / EPS).exp())
    }

    fn travel<R: Real, const P: usize>(
        model: &BlimanSorine<R, P>,
        state: &mut BlimanSorineState<R, P>,
        displacement: R,
    ) -> R {
        model.slide(state, displacement);
        state.force()
    }

    fn walk<R: Real, const P: usize>(model: &BlimanSorine<R, P>, displacements: &[R]) -> Vec<R> {
        let mut state = BlimanSorineState::default();
        displacements.iter().map(|&d| travel(model, &mut state, d)).collect()
    }

    /// Work of the trapezoid between exact end points plus a bound of its error, h^2 F''/12.
    fn work<const P: usize>(model: &BlimanSorine<f64, P>, displacements: &[f64]) -> f64 {
        const CUTS: usize = 64;
        let mut state = BlimanSorineState::default();
        let mut total = 0.0;
        for &d in displacements {
            for _ in 0..CUTS {
                let before = state.force();
                let after = travel(model, &mut state, d / CUTS as f64);
                total += 0.5 * (before + after) * d / CUTS as f64;
            }
        }
        total
    }

    proptest! {
        #[test]
        fn one_way_motion_follows_the_closed_form_for_any_cut(
            cuts in prop::collection::vec(1e-6..0.05f64, 1..40), backwards: bool,
        ) {
            let sign = if backwards { -1.0 } else { 1.0 };
            let steps: Vec<f64> = cuts.iter().map(|d| sign * d).collect();
            let mut s = 0.0;
            for (force, d) in walk(&order_2(), &steps).iter().zip(&cuts) {
                s += d;
                prop_assert!((force - sign * one_way(s)).abs() < 1e-13);
            }
        }

        #[test]
        fn the_force_does_not_depend_on_the_rate(
            strokes in prop::collection::vec(-0.05..0.05f64, 1..20), cuts in 2..50usize,
        ) {
            let fast = walk(&order_2(), &strokes);
            let slow: Vec<f64> =
                strokes.iter().flat_map(|d| std::iter::repeat_n(d / cuts as f64, cuts)).collect();
            let slow = walk(&order_2(), &slow);
            for (k, force) in fast.iter().enumerate() {
                prop_assert!((force - slow[(k + 1) * cuts - 1]).abs() < 1e-13);
            }
        }

        #[test]
        fn no_motion_from_rest_gains_energy(mut strokes in prop::collection::vec(-0.05..0.05f64, 1..30)) {
            let back: f64 = -strokes.iter().sum::<f64>();
            strokes.push(back);
            let level = BlimanSorine::order_1(F1 - F2, EPS).unwrap();
            prop_assert!(work(&order_2(), &strokes) >= -1e-9);
            prop_assert!(work(&level, &strokes) >= -1e-9);
        }

        #[test]
        fn f32_follows_f64(strokes in prop::collection::vec(-0.02..0.02f32, 1..400)) {
            let exact: Vec<f64> = strokes.iter().map(|&d| f64::from(d)).collect();
            for (single, double) in walk(&order_2::<f32>(), &strokes).iter().zip(walk(&order_2(), &exact)) {
                prop_assert!((f64::from(*single) - double).abs() < 2e-6);
            }
        }
    }

    #[test]
    fn the_peak_is_where_the_closed_form_puts_it() {
        let place = EPS * ETA / (1.0 - ETA) * (F1 / (ETA * F2)).ln();
        let forces = walk(&order_2(), &[place / 1000.0; 2000]);
        let peak = forces.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        assert_eq!(peak.0, 999);
        assert!((peak.1 - one_way(place)).abs() < 1e-13);
        assert!(peak.1 > F1 - F2);
    }

    #[test]
    fn long_sliding_tends_to_the_kinetic_level_and_no_step_is_too_long() {
        for step in [1e-3, 1.0, 1e300] {
            let force = *walk(&order_2(), &[step; 2000]).last().unwrap();
            assert!((force - (F1 - F2)).abs() < 1e-15);
        }
    }

    #[test]
    fn order_1_is_dahls_model() {
        // Dahl with exponent 1, dF/dx = sigma*(1 - F/Fc*sign(v)), by fourth-order Runge-Kutta.
        let (level, sigma) = (2.0, 2.0 / EPS);
        let model = BlimanSorine::order_1(level, EPS).unwrap();
        let mut state = BlimanSorineState::default();
        let mut dahl = 0.0;
        for k in 0..4000 {
            let d = 1e-4 * (f64::from(k) * 0.01).sin();
            let slope = |force: f64| sigma * (1.0 - force / level * d.signum());
            let k1 = slope(dahl);
            let k2 = slope(dahl + 0.5 * d * k1);
            let k3 = slope(dahl + 0.5 * d * k2);
            let k4 = slope(dahl + d * k3);
            dahl += d / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
            assert!((travel(&model, &mut state, d) - dahl).abs() < 1e-10);
        }
    }

    #[test]
    fn a_parameter_out_of_range_is_named() {
        let named = |result: Result<BlimanSorine<f64, 2>, Error>| result.unwrap_err();
        assert_eq!(named(BlimanSorine::order_2(f64::NAN, F2, EPS, ETA)), Error::OutOfRange("f1"));
        assert_eq!(named(BlimanSorine::order_2(F1, F1, EPS, ETA)), Error::OutOfRange("f2"));
        assert_eq!(named(BlimanSorine::order_2(F1, F2, 0.0, ETA)), Error::OutOfRange("eps"));
        assert_eq!(named(BlimanSorine::order_2(F1, F2, EPS, 1.0)), Error::OutOfRange("eta"));
        let params = BlimanSorineParams { levels: [1.0, -2.0], distances: [1.0, 1.0] };
        assert_eq!(params.build().unwrap_err(), Error::OutOfRange("levels"));
    }
}
