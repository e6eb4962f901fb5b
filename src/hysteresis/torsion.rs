//! Hysteresis torque over the torsion of the gear.
//!
//! ```text
//! tau_hyst[phi] = A(phi) - P[phi]
//! ```
//!
//! P is the Preisach operator, A the mean of the two branches of its major loop. A trap: with
//! weights mu >= 0 the output of P lags its input, so its loop over phi runs counter-clockwise and
//! integral P dphi over a loop is negative. As a torque, P would drive the gear. The torque of the
//! gear has to lead: -P is dissipative, and A, a function of phi alone, makes the loop close at the
//! ends of the range and puts the catalogue's stiffness line in the middle of the loop, without
//! adding to its area. Over any path
//!
//! ```text
//! integral tau_hyst dphi = change of stored energy + energy dissipated by the relays crossed
//! ```
//!
//! and over any path from the demagnetised state back to phi = 0 it is >= 0.
//!
//! Sign: tau_hyst is part of tau_t, positive when it drives the flexspline forwards, as a spring
//! does at phi > 0. Units: phi (rad), tau_hyst (N m), slope (N m/rad). No time in it: nothing to
//! discretise. The default state is demagnetised: tau_hyst = 0 at phi = 0.
//!
//! Standard shape, half range U and total weight S, at the cell edges (x = phi/U):
//!
//! ```text
//! A = S*x     falling from U: tau_hyst = -S*(1 - x^2)/2     rising from -U: +S*(1 - x^2)/2
//! virgin: S*(|x| - x^2)*sign(x)     beyond +-U: 0
//! ```
//!
//! so S is the gap between the branches at phi = 0. The catalogue instead gives the full width w
//! at zero torque, in series with the stiffness K1 there: K1*w/2 = S/2 * (1 - (w/(2U))^2), hence
//! [`gap_for_width`].

use super::everett::Everett;
use super::inverse::TorsionInverse;
use super::staircase::{Response, Staircase, StaircaseState};
use super::weights::Weights;
use crate::constants::constants;
use crate::error::{Error, require};
use crate::flexspline::stiffness_line::StiffnessLine;
use crate::real::Real;

/// The gap S (N m) that gives a loop of +-`half_range` (rad) the full `width` w (rad) at zero
/// torque, next to a line of `stiffness` K1 (N m/rad) that passes through zero: S = K1*w/(1 - (w/(2U))^2).
///
/// # Errors
/// [`Error::OutOfRange`] `stiffness` or `half_range` when not positive, `width` when not within
/// 0..`half_range`.
pub fn gap_for_width<R: Real>(stiffness: R, width: R, half_range: R) -> Result<R, Error> {
    require(stiffness > R::ZERO && stiffness.is_finite(), "stiffness")?;
    require(half_range > R::ZERO && half_range.is_finite(), "half_range")?;
    require((R::ZERO..=half_range).contains(&width), "width")?;
    let ratio = R::lit(0.5) * width / half_range;
    Ok(stiffness * width / (R::ONE - ratio * ratio))
}

/// Loop of the standard shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorsionHysteresisParams<R> {
    /// U (rad), torsion at which the loop closes; 1e-9..=1e6.
    pub half_range: R,
    /// S (N m), torque between the branches at zero torsion; 0..=1e6.
    pub gap: R,
}

impl<R: Real> TorsionHysteresisParams<R> {
    /// Checks and precomputes.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `half_range`, `gap`, `levels` or `capacity`.
    pub fn build<const L: usize, const MEMORY: usize>(
        &self,
    ) -> Result<TorsionHysteresis<R, L, MEMORY>, Error> {
        require((R::ZERO..=R::lit(1e6)).contains(&self.gap), "gap")?;
        TorsionHysteresis::from_weights(self.half_range, &Weights::uniform(self.gap)?)
    }
}

/// Hysteresis torque of one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HysteresisTorque<R> {
    /// tau_hyst (N m); finite for any input.
    pub torque: R,
    /// dtau_hyst/dphi along the branch, before the torsion (N m/rad); 0 when held.
    pub slope: R,
}

/// Memory of the operator.
pub type TorsionHysteresisState<R, const MEMORY: usize> = StaircaseState<R, MEMORY>;

/// Built model: `L` levels, memory of `MEMORY` turning points.
///
/// The loop of the default gear, 1 arcmin wide at zero torque: over a cycle the torque does positive work, which is lost.
///
/// ```
/// use strainwave::hysteresis::{TorsionHysteresisParams, gap_for_width};
///
/// let (k1, width, half_range) = (3.1e4_f64, 2.9089e-4, 1.4649e-3); // N m/rad, rad, rad
/// let gap = gap_for_width(k1, width, half_range)?;
/// let hysteresis = TorsionHysteresisParams { half_range, gap }.build::<24, 28>()?;
/// let (mut state, mut last, mut work) = (Default::default(), 0.0, 0.0);
/// hysteresis.step(&mut state, half_range);
/// for step in 1..=10_000 {
///     let torsion = half_range * (f64::from(step) / 10_000.0 * std::f64::consts::TAU).cos();
///     let before = if step == 1 { half_range } else { last };
///     work += hysteresis.torque(&state) * (torsion - before);
///     hysteresis.step(&mut state, torsion);
///     last = torsion;
/// }
/// // 4/3*S*U joules a cycle.
/// assert!((work - 4.0 / 3.0 * gap * half_range).abs() < 0.01 * work);
/// # Ok::<(), strainwave::Error>(())
/// ```
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorsionHysteresis<R: Real, const L: usize, const MEMORY: usize> {
    staircase: Staircase<R, L, MEMORY>,
}

impl<R: Real, const L: usize, const MEMORY: usize> TorsionHysteresis<R, L, MEMORY> {
    /// From identified weights (N m) over torsions of +-`half_range` (rad).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `half_range`, `capacity`, or `weight` when one is below zero: such a torque drives.
    pub fn from_weights(half_range: R, weights: &Weights<R, L>) -> Result<Self, Error> {
        require(weights.is_dissipative(), "weight")?;
        Ok(Self { staircase: Staircase::around(half_range, Everett::leading(weights))? })
    }

    /// tau_hyst at the next torsion (rad); between two steps the torsion counts as monotone.
    // Never inlined: the timing budget counts this block by its symbol.
    #[inline(never)]
    pub fn step(&self, state: &mut TorsionHysteresisState<R, MEMORY>, torsion: R) -> HysteresisTorque<R> {
        self.staircase.step(state, torsion).into()
    }

    /// Result of [`Self::step`] without a change of the state.
    #[inline]
    pub fn peek(&self, state: &TorsionHysteresisState<R, MEMORY>, torsion: R) -> HysteresisTorque<R> {
        self.staircase.peek(state, torsion).into()
    }

    /// Greatest slope of any branch (N m/rad), at least 0: the steepest that a reversal can meet.
    #[inline(always)]
    pub fn greatest_slope(&self) -> R {
        self.staircase.greatest_slope()
    }

    /// The inverse: torsion for a given torque through `line` and the hysteresis in parallel.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `line` unless it is stiffer everywhere than the hysteresis falls anywhere.
    pub fn inverse<'s>(
        &'s self,
        line: &'s StiffnessLine<R>,
    ) -> Result<TorsionInverse<'s, R, L, MEMORY>, Error> {
        require(line.least_stiffness() + self.staircase.least_slope() > R::ZERO, "line")?;
        Ok(TorsionInverse { staircase: &self.staircase, line })
    }

    /// tau_hyst of the last step (N m).
    #[inline]
    pub fn torque(&self, state: &TorsionHysteresisState<R, MEMORY>) -> R {
        self.staircase.output(state)
    }
}

impl<R> From<Response<R>> for HysteresisTorque<R> {
    #[inline(always)]
    fn from(response: Response<R>) -> Self {
        Self { torque: response.output, slope: response.slope }
    }
}

#[cfg(test)]
mod tests {
    use super::super::relays::{Relays, RelaysState};
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;

    const U: f64 = 1.5e-3;
    const S: f64 = 9.0;
    const L: usize = 24;
    const MEMORY: usize = 64;

    fn model<R: Real>() -> TorsionHysteresis<R, L, MEMORY> {
        TorsionHysteresisParams { half_range: R::lit(U), gap: R::lit(S) }.build().unwrap()
    }

    /// Torques along torsions in units of U.
    fn torques(torsions: &[f64]) -> Vec<f64> {
        let (model, mut state) = (model::<f64>(), TorsionHysteresisState::default());
        torsions.iter().map(|x| model.step(&mut state, x * U).torque).collect()
    }

    #[test]
    fn a_torque_that_would_drive_is_refused() {
        let weights = Weights::<f64, 8>::signed_from_fn(|i, j| if i == j { 1.0 } else { -0.1 }).unwrap();
        let refused = TorsionHysteresis::<f64, 8, 8>::from_weights(U, &weights).unwrap_err();
        assert_eq!(refused, Error::OutOfRange("weight"));
    }

    #[test]
    fn the_major_loop_has_its_closed_form_and_its_gap() {
        for k in -12..=12 {
            let x = f64::from(k) / 12.0;
            let (falling, rising) = (torques(&[1.0, x])[1], torques(&[-1.0, x])[1]);
            assert!((falling + 0.5 * S * (1.0 - x * x)).abs() < 1e-13);
            assert!((rising - 0.5 * S * (1.0 - x * x)).abs() < 1e-13);
        }
        assert!((torques(&[-1.0, 0.0])[1] - torques(&[1.0, 0.0])[1] - S).abs() < 1e-13);
    }

    #[test]
    fn it_starts_without_torque_and_on_the_virgin_curve() {
        let state = TorsionHysteresisState::default();
        assert!(model::<f64>().peek(&state, 0.0).torque.abs() < 1e-15 * S);
        // Half a quantum of the 16-bit table.
        assert!(
            model::<f32>().peek(&TorsionHysteresisState::default(), 0.0).torque.abs() < 7.7e-6 * S as f32
        );
        for k in -12i32..=12 {
            let x = f64::from(k) / 12.0;
            let expected = S * (x.abs() - x * x) * x.signum();
            assert!((model::<f64>().peek(&state, x * U).torque - expected).abs() < 1e-13);
        }
    }

    /// One arcmin at the default gear's K1, from the torque loop itself.
    #[test]
    fn the_width_at_zero_torque_is_the_given_one() {
        let (k1, width) = (3.1e4, 2.908_882e-4);
        let gap = gap_for_width(k1, width, U).unwrap();
        let model: TorsionHysteresis<f64, L, MEMORY> =
            TorsionHysteresisParams { half_range: U, gap }.build().unwrap();
        let crossing = |start: f64| {
            let mut state = TorsionHysteresisState::default();
            model.step(&mut state, start);
            let (mut low, mut high) = (-U, U);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                let torque = k1 * middle + model.peek(&state, middle).torque;
                (low, high) = if torque < 0.0 { (middle, high) } else { (low, middle) };
            }
            low
        };
        // The table is linear within a cell: 0.1 % of the gap at most at 24 levels.
        assert!(((crossing(U) - crossing(-U)) / width - 1.0).abs() < 1e-3);
        assert_eq!(gap_for_width(k1, 2.0 * U, U), Err(Error::OutOfRange("width")));
        assert_eq!(gap_for_width(0.0, width, U), Err(Error::OutOfRange("stiffness")));
    }

    /// Work of the torque along grid inputs, cell by cell: relays switch in the middle of a cell, so
    /// the trapezoid between its edges is exact.
    struct Walk<'a> {
        relays: &'a Relays<f64, L>,
        memory: RelaysState<f64, L>,
        model: &'a TorsionHysteresis<f64, L, MEMORY>,
        state: TorsionHysteresisState<f64, MEMORY>,
        at: usize,
        torque: f64,
        work: f64,
    }

    impl Walk<'_> {
        fn to(&mut self, target: usize) {
            while self.at != target {
                let next = if target > self.at { self.at + 1 } else { self.at - 1 };
                let (from, to) = (self.relays.edge(self.at), self.relays.edge(next));
                self.relays.step(&mut self.memory, to);
                let torque = self.model.step(&mut self.state, to).torque;
                self.work += 0.5 * (self.torque + torque) * (to - from);
                (self.at, self.torque) = (next, torque);
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn the_area_of_a_closed_loop_is_the_energy_that_the_relays_dissipate(
            mut corners in prop::collection::vec(0..=L, 1..30),
        ) {
            let weights = Weights::uniform(S).unwrap();
            let (relays, model) = (Relays::build(U, &weights).unwrap(), model());
            let mut walk = Walk {
                relays: &relays, memory: RelaysState::default(),
                model: &model, state: TorsionHysteresisState::default(),
                at: L / 2, torque: 0.0, work: 0.0,
            };
            corners.push(L / 2);
            corners.iter().for_each(|&k| walk.to(k));
            let stored = |walk: &Walk| relays.stored(&walk.memory, 0.0);
            // The first lap starts demagnetised: part of its work stays stored.
            let fresh = relays.stored(&RelaysState::default(), 0.0);
            let lost = stored(&walk) - fresh + walk.memory.dissipated();
            prop_assert!((walk.work - lost).abs() <= 1e-9 * walk.memory.dissipated() + 1e-15);
            prop_assert!(stored(&walk) >= fresh - 1e-15 && walk.work >= -1e-15);
            // The second lap closes in the memory too.
            let (work, dissipated) = (walk.work, walk.memory.dissipated());
            corners.iter().for_each(|&k| walk.to(k));
            let area = walk.work - work;
            let lost = walk.memory.dissipated() - dissipated;
            prop_assert!((area - lost).abs() <= 1e-9 * lost + 1e-15);
        }

        #[test]
        fn no_path_back_to_zero_torsion_gains_energy(
            mut corners in prop::collection::vec(-1.3..1.3f64, 1..20),
        ) {
            corners.push(0.0);
            let (model, mut state) = (model::<f64>(), TorsionHysteresisState::default());
            let (mut at, mut torque, mut work) = (0.0, 0.0, 0.0);
            for corner in corners {
                for k in 1..=200 {
                    let next = at + (corner - at) * f64::from(k) / 200.0;
                    let after = model.step(&mut state, next * U).torque;
                    work += 0.5 * (torque + after) * (corner - at) / 200.0;
                    torque = after;
                }
                at = corner;
            }
            // Trapezoids across the kinks at cell edges: slope jump S/6 a cell width, step 0.013.
            prop_assert!(work * U >= -2e-4 * S * U);
        }

        #[test]
        fn f32_follows_f64(torsions in prop::collection::vec(-1.2..1.2f64, 1..200)) {
            let (single, double) = (model::<f32>(), model::<f64>());
            let (mut a, mut b) = (TorsionHysteresisState::default(), TorsionHysteresisState::default());
            for x in torsions {
                let torsion = (x * U) as f32;
                let torque = single.step(&mut a, torsion).torque;
                let exact = double.step(&mut b, f64::from(torsion)).torque;
                prop_assert!((f64::from(torque) - exact).abs() < 3e-5 * S);
            }
        }

        #[test]
        fn any_input_bits_give_a_bounded_torque(bits in prop::collection::vec(any::<u32>(), 1..200)) {
            let (model, mut state) = (model::<f32>(), TorsionHysteresisState::default());
            for bits in bits {
                let (before, torsion) = (state, f32::from_bits(bits));
                let found = model.step(&mut state, torsion);
                prop_assert!(found.torque.abs() <= 0.5001 * S as f32 && found.slope.is_finite());
                let held = state.held() > before.held();
                prop_assert_eq!(held, torsion.is_nan());
                prop_assert!(!held || (found.torque == model.torque(&before) && found.slope == 0.0));
            }
        }
    }

    #[test]
    fn the_slope_is_the_derivative() {
        let (model, mut state) = (model::<f64>(), TorsionHysteresisState::default());
        for x in [0.3, 0.71, 0.2, -0.55, -0.1, 0.4] {
            let rising = x * U > 0.0;
            let found = model.step(&mut state, x * U);
            let h = 1e-7 * U * if rising { 1.0 } else { -1.0 };
            let moved = model.peek(&state, x * U + h).torque;
            let expected = (moved - found.torque) / h;
            // Only where the probe goes on in the direction of the step.
            if (x, rising) != (0.2, true) && (x, rising) != (-0.1, false) {
                assert!((expected - found.slope).abs() < 1e-4 * S / U, "{x}");
            }
        }
    }

    #[test]
    fn the_loop_is_closed_beyond_its_range_and_says_so() {
        let (model, mut state) = (model::<f64>(), TorsionHysteresisState::default());
        let found = model.step(&mut state, 3.0 * U);
        assert!(state.is_saturated() && found.torque.abs() < 1e-13);
    }

    #[test]
    fn a_parameter_out_of_range_is_named() {
        let name = |half_range: f64, gap: f64| {
            let params = TorsionHysteresisParams { half_range, gap };
            params.build::<8, 8>().unwrap_err()
        };
        assert_eq!(name(0.0, 1.0), Error::OutOfRange("half_range"));
        assert_eq!(name(1.0, -1.0), Error::OutOfRange("gap"));
    }
}
