//! Inverse of the operator: the input for a target output, on the same memory.
//!
//! ```text
//! u with line(u) + y[u] = w,   y[u]: output of the operator for an input that changes monotonically to u
//! ```
//!
//! line is a stiffness line in parallel with the operator, or none. Where the sum rises along every branch, the branch
//! of the target output is found as that of an input is: the outputs of the turning points are nested as their
//! inputs are. On the branch the cell is found by bisection, and in the cell the equation solved: it is linear,
//! on the virgin curve quadratic, with the line's knees between. So the forward operator returns the target
//! output to rounding.
//!
//! In a cell where y is constant, because no relay switches there, any input solves the equation; one of the cell is
//! returned. An output that no input reaches gives the end of the range, one that is not finite the present input.

use super::everett::Climb;
use super::memory::{StaircaseState, TurningPoint};
use super::staircase::Staircase;
use crate::branch::cheaper;
use crate::error::{Error, require};
use crate::fixed::Fixed;
use crate::flexspline::stiffness_line::StiffnessLine;
use crate::real::Real;

/// The inverse of an operator whose output never falls along a rising input.
///
/// The operator answers the found input with the wanted output, whatever its past:
///
/// ```
/// use strainwave::hysteresis::{Staircase, StaircaseState, Weights};
///
/// let operator = Staircase::<f64, 24, 28>::build(1.0, &Weights::uniform(2.0)?)?;
/// let inverse = operator.inverse()?;
/// let mut state = StaircaseState::default();
/// for wanted in [0.3, 1.5, -0.8, 0.2, 0.21, -1.9] {
///     let input = inverse.input(&state, wanted);
///     assert!((operator.step(&mut state, input).output - wanted).abs() < 1e-12);
/// }
/// # Ok::<(), strainwave::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Inverse<'s, R: Real, const L: usize, const MEMORY: usize> {
    pub(super) staircase: &'s Staircase<R, L, MEMORY>,
}

impl<R: Real, const L: usize, const MEMORY: usize> Staircase<R, L, MEMORY> {
    /// The inverse: input for a given output.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `table` when the output falls along a rising input, as it may with weights below zero.
    pub fn inverse(&self) -> Result<Inverse<'_, R, L, MEMORY>, Error> {
        require(self.least_slope >= R::ZERO, "table")?;
        Ok(Inverse { staircase: self })
    }
}

/// The torsion for a torque through a stiffness line and the hysteresis in parallel.
///
/// How far the motor has to wind the gear up for a torque, coming from above or from below:
///
/// ```
/// use strainwave::flexspline::stiffness_line::StiffnessLineParams;
/// use strainwave::hysteresis::{TorsionHysteresisParams, TorsionHysteresisState};
///
/// let line = StiffnessLineParams { stiffness: [3.1e4, 5.0e4, 5.7e4], knee_torque: [14.0, 48.0] }.build()?;
/// let hysteresis = TorsionHysteresisParams { half_range: line.torsion(67.0), gap: 9.1 }.build::<24, 28>()?;
/// let inverse = hysteresis.inverse(&line)?;
/// let wind_up_for_20_after = |torque: f64| {
///     let mut state = TorsionHysteresisState::default();
///     let torsion = inverse.torsion(&state, torque);
///     hysteresis.step(&mut state, torsion);
///     let torsion = inverse.torsion(&state, 20.0);
///     assert!((line.torque(torsion) + hysteresis.step(&mut state, torsion).torque - 20.0).abs() < 1e-9);
///     torsion
/// };
/// let between = wind_up_for_20_after(67.0) - wind_up_for_20_after(-67.0);
/// assert!(between > 0.1e-3 && between < 0.3e-3); // rad
/// # Ok::<(), strainwave::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct TorsionInverse<'s, R: Real, const L: usize, const MEMORY: usize> {
    pub(super) staircase: &'s Staircase<R, L, MEMORY>,
    pub(super) line: &'s StiffnessLine<R>,
}

impl<R: Real, const L: usize, const MEMORY: usize> TorsionInverse<'_, R, L, MEMORY> {
    /// The torsion (rad) of the next step for which line and hysteresis sum to `torque` (N m); beyond +-U the line
    /// alone.
    #[inline(never)] // The timing budget counts this block by its symbol.
    pub fn torsion(&self, state: &StaircaseState<R, MEMORY>, torque: R) -> R {
        let staircase = self.staircase;
        if !torque.is_finite() {
            cheaper();
            return staircase.input(state);
        }
        let total = |point: &TurningPoint<R>| self.total(staircase.input_at(point.position), point.output);
        let along = if state.is_falling() { -torque } else { torque };
        let target = Target::of(state, along, total(&state.now()), |torque| -torque);
        let reached = |edge, output| self.total(staircase.edge(edge), output) >= target.to;
        let (climb, bend) = match target.start(state, total) {
            Some(start) => (staircase.everett().climb(&start, reached), R::Fixed::default()),
            None => staircase.everett().climb_virgin_curve(reached),
        };
        target.in_frame(self.in_cell(&climb, bend, target.to))
    }

    /// Line and hysteresis.
    #[inline(always)]
    fn total(&self, torsion: R, output: R::Fixed) -> R {
        self.line.torque(torsion) + self.staircase.real(output)
    }

    /// From the lower edge of the cell on, piece by piece of the line.
    #[inline(always)]
    fn in_cell(&self, climb: &Climb<R::Fixed>, bend: R::Fixed, torque: R) -> R {
        let staircase = self.staircase;
        let [start, slope, bend] = [climb.start, climb.slope, bend].map(|output| staircase.real(output));
        let [lower, upper] = [climb.cell, climb.cell + 1].map(|edge| staircase.edge(edge));
        let mut torsion = lower;
        for _ in 0..PIECES {
            let fraction = (torsion - lower) * staircase.cells_per_unit();
            let missing = torque - self.line.torque(torsion) - start - fraction * (slope + fraction * bend);
            let (stiffness, end) = self.line.piece_from(torsion);
            let rise = slope + bend * (fraction + fraction) + stiffness * staircase.cell_width();
            let found = torsion + quadratic_root(missing, rise, bend) * staircase.cell_width();
            if found <= end.min(upper) {
                return found;
            }
            torsion = end.min(upper);
        }
        // Above the end of the range the line alone gives the torque.
        self.line.torsion(torque)
    }
}

/// Pieces of a line that may lie in a cell: its three on either side of zero, where it has but one.
const PIECES: usize = 5;

impl<R: Real, const L: usize, const MEMORY: usize> Inverse<'_, R, L, MEMORY> {
    /// The input that the next step must have for the output to be `output`; within +-U.
    // Never inlined: the timing budget counts this block by its symbol.
    #[inline(never)]
    pub fn input(&self, state: &StaircaseState<R, MEMORY>, output: R) -> R {
        let staircase = self.staircase;
        if !output.is_finite() {
            cheaper();
            return staircase.input(state);
        }
        let along = staircase.quanta(output).in_frame(state.frame());
        let target = Target::of(state, along, state.now().output, |output| !output);
        let width = target.in_frame(staircase.cell_width());
        let Some(start) = target.start(state, |point| point.output) else {
            cheaper();
            return self.on_virgin_curve(target.to) * width;
        };
        let climb = staircase.everett().climb(&start, |_, output| output >= target.to);
        let value = target.to - climb.start;
        let fraction = if value < climb.slope {
            value.real() / climb.slope.real()
        } else {
            cheaper();
            R::ONE
        };
        staircase.cells(climb.cell, fraction) * width
    }

    #[inline(always)]
    fn on_virgin_curve(&self, to: R::Fixed) -> R {
        let (climb, bend) = self.staircase.everett().climb_virgin_curve(|_, output| output >= to);
        let fraction = quadratic_root((to - climb.start).real(), climb.slope.real(), bend.real());
        // In a cell without a slope, not a number counts as its end.
        self.staircase.cells(climb.cell, fraction.min(R::ONE))
    }
}

/// Target, in the frame of its branch.
struct Target<K> {
    to: K,
    /// In the other frame.
    mirror: K,
    /// Value of the last step.
    now: K,
    /// The frame is not that of the last step.
    turned: bool,
    falling: bool,
}

impl<K: PartialOrd + Copy> Target<K> {
    /// `along` and `now` in the frame of the last step.
    #[inline(always)]
    fn of<R: Real, const MEMORY: usize>(
        state: &StaircaseState<R, MEMORY>,
        along: K,
        now: K,
        mirrored: impl Fn(K) -> K,
    ) -> Self {
        let turned = along < now;
        let mirror = mirrored(along);
        let (to, mirror) = if turned { (mirror, along) } else { (along, mirror) };
        Self { to, mirror, now, turned, falling: state.is_falling() != turned }
    }

    /// Start of its branch; the virgin curve has none.
    #[inline(always)]
    fn start<R: Real, const MEMORY: usize>(
        &self,
        state: &StaircaseState<R, MEMORY>,
        key: impl Fn(&TurningPoint<R>) -> K,
    ) -> Option<TurningPoint<R>> {
        state.start_of_branch(self.turned, self.to, self.mirror, self.now, key)
    }

    #[inline(always)]
    fn in_frame<R: Real>(&self, input: R) -> R {
        if self.falling { -input } else { input }
    }
}

/// x >= 0 with slope*x + bend*x^2 = `value` >= 0, where that rises.
#[inline(always)]
fn quadratic_root<R: Real>(value: R, slope: R, bend: R) -> R {
    // The sum, not the difference of nearly equal numbers.
    let square = slope * slope + R::lit(4.0) * bend * value;
    (value + value) / (slope + square.sqrt_or_zero())
}

#[cfg(test)]
mod tests {
    use super::super::torsion::{TorsionHysteresis, TorsionHysteresisState, gap_for_width};
    use super::super::weights::Weights;
    use super::*;
    use crate::flexspline::stiffness_line::StiffnessLineParams;
    use proptest::prelude::*;
    use std::vec::Vec;

    const U: f64 = 1.5e-3;
    const S: f64 = 9.0;
    const MEMORY: usize = 28;

    fn staircase<R: Real, const L: usize>(uneven: bool) -> Staircase<R, L, MEMORY> {
        let weight = |i: usize, j: usize| 1.0 + if uneven { ((i - j) * (i + L - 1 - j)) as f64 } else { 0.0 };
        let total: f64 = (0..L).flat_map(|i| (0..=i).map(move |j| weight(i, j))).sum();
        let weights = Weights::from_fn(|i, j| R::lit(S / total * weight(i, j))).unwrap();
        Staircase::build(R::lit(U), &weights).unwrap()
    }

    /// Largest distance of a target output from the one that the input gives, and of an input
    /// from the one that its output gives, as fractions of their spans.
    fn round_trip<R: Real, const L: usize>(uneven: bool, history: &[f64], ends: &[f64]) -> [f64; 2] {
        let model = staircase::<R, L>(uneven);
        let mut state = StaircaseState::default();
        for u in history {
            model.step(&mut state, R::lit(u * U));
        }
        let inverse = model.inverse().unwrap();
        let mut worst = [0.0f64; 2];
        for end in ends {
            let target = R::lit(end * S);
            let found = model.peek(&state, inverse.input(&state, target)).output;
            worst[0] = worst[0].max((found - target).to_f64().abs() / (2.0 * S));
            let input = R::lit(end * U);
            let back = inverse.input(&state, model.peek(&state, input).output);
            worst[1] = worst[1].max((back - input).to_f64().abs() / (2.0 * U));
        }
        worst
    }

    fn line() -> StiffnessLine<f64> {
        StiffnessLineParams { stiffness: [3.1e4, 5.0e4, 5.7e4], knee_torque: [14.0, 48.0] }.build().unwrap()
    }

    fn torsion_model<const L: usize>() -> TorsionHysteresis<f64, L, MEMORY> {
        let half_range = line().torsion(67.0);
        let gap = gap_for_width(3.1e4, 2.908_882e-4, half_range).unwrap();
        TorsionHysteresis::from_weights(half_range, &Weights::uniform(gap).unwrap()).unwrap()
    }

    fn fractions(length: usize) -> impl Strategy<Value = Vec<f64>> {
        prop::collection::vec(-1.0..=1.0f64, 1..length)
    }

    proptest! {
        #[test]
        fn it_undoes_the_operator_and_is_undone_by_it(uneven: bool, history in fractions(40), ends in fractions(20)) {
            for found in [
                round_trip::<f64, 24>(uneven, &history, &ends), round_trip::<f64, 9>(uneven, &history, &ends),
            ] {
                prop_assert!(found[0] < 1e-14 && found[1] < 1e-12, "{:?}", found);
            }
            // Where the weights are below half an entry the table is flat, and any input as good.
            let found = round_trip::<f32, 24>(uneven, &history, &ends);
            prop_assert!(found[0] < 3e-6 && (uneven || found[1] < 1e-5), "{:?}", found);
        }

        #[test]
        fn the_line_and_the_hysteresis_carry_the_wanted_torque(history in fractions(40), ends in fractions(20)) {
            let (line, model) = (line(), torsion_model::<24>());
            let half_range = line.torsion(67.0);
            let mut state = TorsionHysteresisState::default();
            for u in history {
                model.step(&mut state, 1.2 * u * half_range);
            }
            let inverse = model.inverse(&line).unwrap();
            for end in ends {
                let torque = 80.0 * end;
                let torsion = inverse.torsion(&state, torque);
                let found = line.torque(torsion) + model.peek(&state, torsion).torque;
                prop_assert!((found - torque).abs() < 1e-11, "{} {} {}", torque, found, torsion);
            }
        }

        #[test]
        fn any_bits_give_an_input_within_the_range(bits: u32, history in fractions(20)) {
            let model = staircase::<f32, 24>(false);
            let mut state = StaircaseState::default();
            for u in history {
                model.step(&mut state, (u * U) as f32);
            }
            let target = f32::from_bits(bits);
            let input = model.inverse().unwrap().input(&state, target);
            prop_assert!(input.abs() <= U as f32);
            prop_assert!(target.is_finite() || (input - model.input(&state)).abs() < 1e-6 * U as f32);
        }
    }

    #[test]
    fn an_output_beyond_saturation_gives_the_end_of_the_range() {
        let (model, state) = (staircase::<f64, 24>(false), StaircaseState::default());
        assert_eq!(model.inverse().unwrap().input(&state, 1.1 * S), U);
        assert_eq!(model.inverse().unwrap().input(&state, -f64::MAX), -U);
        let (line, model) = (line(), torsion_model::<24>());
        let inverse = model.inverse(&line).unwrap();
        assert!(
            (inverse.torsion(&TorsionHysteresisState::default(), -100.0) - line.torsion(-100.0)).abs()
                < 1e-15
        );
    }

    #[test]
    fn where_no_relay_switches_an_input_is_found_all_the_same() {
        // Only the relays of the outermost corner: flat but for the ends.
        let weights = Weights::from_fn(|i, j| if i == 7 && j == 0 { S } else { 0.0 }).unwrap();
        let model = Staircase::<f64, 8, MEMORY>::build(U, &weights).unwrap();
        let mut state = StaircaseState::default();
        for u in [0.0, 1.0, 0.2, 0.5] {
            model.step(&mut state, u * U);
            for target in [-S, -0.3 * S, model.output(&state), S] {
                let input = model.inverse().unwrap().input(&state, target);
                assert!((model.peek(&state, input).output - target).abs() < 1e-12, "{u} {target} {input}");
            }
        }
    }

    #[test]
    fn what_does_not_rise_is_refused_by_name() {
        let signed = Weights::<f64, 8>::signed_from_fn(|i, j| if i == j { 1.0 } else { -0.5 }).unwrap();
        let model = Staircase::<f64, 8, MEMORY>::build(U, &signed).unwrap();
        assert_eq!(model.inverse().unwrap_err(), Error::OutOfRange("table"));
        let soft = StiffnessLineParams { stiffness: [1e3; 3], knee_torque: [14.0, 48.0] }.build().unwrap();
        assert_eq!(torsion_model::<24>().inverse(&soft).unwrap_err(), Error::OutOfRange("line"));
    }
}
