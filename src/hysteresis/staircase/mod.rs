//! Preisach operator from its past extrema: the real-time realisation.
//!
//! The output only depends on the turning points of the input that later ones haven't wiped out, see
//! `memory.rs`. Each is kept with the output y_k that it had, so that a step is one look into the
//! Everett table:
//!
//! ```text
//! y(u) = y_k + G(u, r_k)                       on the branch from the last turning point r_k
//! y(u) = sign(u) * G(|u|, -|u|)/2              on the virgin curve, when there is none
//! ```
//!
//! Wiping-out: when u reaches the turning point before the last, both are dropped. r_1 is the
//! largest |u| so far, and what is before it is -r_1, where the demagnetised operator would also
//! be on its virgin curve. The default state is demagnetised: no turning point, output 0 at u = 0.
//!
//! Beyond +-U the input counts as +-U. One that is not a number leaves everything as it is.
//!
//! I. Mayergoyz, "Mathematical models of hysteresis and their applications", 2003, section 1.3.

#[cfg(test)]
mod tests;

use super::everett::Everett;
pub use super::memory::StaircaseState;
use super::memory::{Position, TurningPoint};
use super::weights::Weights;
use crate::branch::cheaper;
use crate::constants::constants;
use crate::error::{Error, require};
use crate::fixed::Fixed;
use crate::real::Real;

/// Output of one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Response<R> {
    /// y; finite for any input.
    pub output: R,
    /// dy/du along the branch, before the input; 0 when held.
    pub slope: R,
}

/// Built operator: `L` levels, memory of `MEMORY` turning points.
#[derive(Clone, Copy, Debug, PartialEq)]
// In this order, so that no address needs computing.
///
/// Wiping-out and congruency: a minor loop comes back to where it began, and leaves no trace on the branch that it
/// interrupted.
///
/// ```
/// use strainwave::hysteresis::{Staircase, StaircaseState, Weights};
///
/// let operator = Staircase::<f32, 24, 28>::build(1.0, &Weights::uniform(2.0)?)?;
/// let through = |inputs: &[f32]| {
///     let mut state = StaircaseState::default();
///     inputs.iter().map(|input| operator.step(&mut state, *input).output).last().unwrap()
/// };
/// let direct = through(&[-1.0, 0.6]);
/// assert_eq!(through(&[-1.0, 0.4, -0.2, 0.4, 0.6]), direct); // the minor loop from 0.4 is forgotten
/// assert!(through(&[1.0, 0.0]) > through(&[-1.0, 0.0]) + 0.9); // the output lags: it depends on the past
/// # Ok::<(), strainwave::Error>(())
/// ```
#[constants]
pub struct Staircase<R: Real, const L: usize, const MEMORY: usize> {
    /// From an input to what [`Fixed::position`] takes.
    scale: R,
    middle: R,
    /// Slope of the output per quantum over a cell.
    slope: R,
    half_range: R,
    cell_width: R,
    cells_per_unit: R,
    quanta_per_output: R,
    /// Least and greatest slope of any branch.
    pub(super) least_slope: R,
    greatest_slope: R,
    everett: Everett<R, L>,
}

impl<R: Real, const L: usize, const MEMORY: usize> Staircase<R, L, MEMORY> {
    /// Sums the weights for inputs of +-`half_range` U, 1e-9..=1e6.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `half_range`, or `capacity` when `MEMORY` is not in 8..=1000.
    pub fn build(half_range: R, weights: &Weights<R, L>) -> Result<Self, Error> {
        Self::around(half_range, Everett::build(weights))
    }

    /// The operator of a table.
    pub(crate) fn around(half_range: R, everett: Everett<R, L>) -> Result<Self, Error> {
        require((R::lit(1e-9)..=R::lit(1e6)).contains(&half_range), "half_range")?;
        require((8..=1000).contains(&MEMORY), "capacity")?;
        let cells_per_unit = R::from_i32(L as i32) / (half_range + half_range);
        Ok(Self {
            scale: (R::Fixed::UPPER_END - R::Fixed::CENTRE) / half_range,
            middle: R::Fixed::CENTRE,
            slope: cells_per_unit * everett.quantum(),
            everett,
            half_range,
            cell_width: R::ONE / cells_per_unit,
            cells_per_unit,
            quanta_per_output: if everett.quantum() > R::ZERO { R::ONE / everett.quantum() } else { R::ZERO },
            least_slope: everett.slopes().fold(R::MAX, R::min) * cells_per_unit,
            greatest_slope: everett.slopes().fold(R::ZERO, R::max) * cells_per_unit,
        })
    }

    /// y at the next input; the input between two steps counts as monotone.
    #[inline(always)]
    pub fn step(&self, state: &mut StaircaseState<R, MEMORY>, input: R) -> Response<R> {
        let position = R::Fixed::position(input * self.scale + self.middle);
        if position == Position::<R>::default() {
            return self.at_lower_end(state, input);
        }
        let (to, start) = state.go(position);
        let slope = self.arrive(state, to, start);
        Response { output: self.output(state), slope: slope.real() * self.slope }
    }

    /// The step for an input at the lower end of the range or below it; not a number is there too.
    #[cold]
    #[inline(never)]
    fn at_lower_end(&self, state: &mut StaircaseState<R, MEMORY>, input: R) -> Response<R> {
        let mut slope = R::ZERO;
        if input < R::ZERO {
            let to = state.fall_to_end();
            slope = self.arrive(state, to, None).real() * self.slope;
        } else {
            state.hold();
        }
        Response { output: self.output(state), slope }
    }

    /// Completes the step to a position in the frame of the branch; the slope over a cell there.
    #[inline(always)]
    fn arrive(
        &self,
        state: &mut StaircaseState<R, MEMORY>,
        to: Position<R>,
        start: Option<TurningPoint<R>>,
    ) -> R::Fixed {
        let (output, slope) = match start {
            Some(start) => {
                let change = self.everett.rise(to, start.position);
                (start.output + change.value, change.slope)
            }
            None => {
                cheaper();
                // The weights are symmetric: half of G(v, -v) lies on either side of the line alpha = -beta,
                // and the derivatives of G over its two arguments are opposite there.
                let change = self.everett.rise(to, !to);
                (change.value.half(), change.slope)
            }
        };
        state.arrive(to, output);
        slope
    }

    /// Result of [`Self::step`] without a change of the state.
    #[inline]
    pub fn peek(&self, state: &StaircaseState<R, MEMORY>, input: R) -> Response<R> {
        let mut next = *state;
        self.step(&mut next, input)
    }

    /// y after the last step.
    #[inline(always)]
    pub fn output(&self, state: &StaircaseState<R, MEMORY>) -> R {
        self.real(state.output())
    }

    /// The input of the last step, or the end of the range that it was beyond.
    #[inline(always)]
    pub fn input(&self, state: &StaircaseState<R, MEMORY>) -> R {
        let input = self.input_at(state.now().position);
        if state.is_falling() { -input } else { input }
    }

    /// That at a position.
    #[inline(always)]
    pub(crate) fn input_at(&self, position: Position<R>) -> R {
        R::Fixed::distance(position).real() * R::lit(1.0 / R::Fixed::HALF_RANGE.to_f64()) * self.half_range
    }

    /// That at an edge of the grid.
    #[inline(always)]
    pub(crate) fn edge(&self, edge: usize) -> R {
        self.within(edge, R::ZERO)
    }

    /// That at a fraction of a cell.
    #[inline(always)]
    pub(crate) fn within(&self, cell: usize, fraction: R) -> R {
        self.cells(cell, fraction) * self.cell_width
    }

    /// That in cells.
    #[inline(always)]
    pub(crate) fn cells(&self, cell: usize, fraction: R) -> R {
        let half_cell = if L.is_multiple_of(2) { R::ZERO } else { R::lit(0.5) };
        R::from_i32(cell as i32 - (L / 2) as i32) + (fraction - half_cell)
    }

    /// An output.
    #[inline(always)]
    pub(crate) fn real(&self, output: R::Fixed) -> R {
        output.real() * self.everett.quantum()
    }

    /// An output in quanta.
    #[inline(always)]
    pub(crate) fn quanta(&self, output: R) -> R::Fixed {
        R::Fixed::truncated(output * self.quanta_per_output)
    }

    /// h.
    #[inline(always)]
    pub(crate) fn cell_width(&self) -> R {
        self.cell_width
    }

    /// 1/h.
    #[inline(always)]
    pub(crate) fn cells_per_unit(&self) -> R {
        self.cells_per_unit
    }

    /// Least slope of any branch.
    pub(crate) fn least_slope(&self) -> R {
        self.least_slope
    }

    /// Greatest slope of any branch, at least 0.
    pub(crate) fn greatest_slope(&self) -> R {
        self.greatest_slope
    }

    /// The table.
    pub fn everett(&self) -> &Everett<R, L> {
        &self.everett
    }
}
