//! Everett table: the output changes of a Preisach operator between two extrema.
//!
//! ```text
//! G(a, b) = y after the input went monotonically from b to a, minus y before it     (a fresh branch)
//!         = 2 * sum of mu over beta > b, alpha < a        for a >= b
//! G(b, a) = -G(a, b)
//! ```
//!
//! Everett's function is half of it. A fresh branch is one that starts at an extremum of the input
//! and has wiped out nothing. The table holds G at the cell edges; within a cell it is bilinear, and
//! in a cell on the diagonal proportional to a - b. That interpolant is itself the G of a Preisach
//! operator: with the weight of a cell spread evenly over it, and that of a diagonal cell along its
//! diagonal. So every law of the operator also holds between grid inputs, and the output is
//! continuous in the input.
//!
//! Entries are integers, one of which is the quantum: that of f32 is 1/32 767 of the largest |G|, so
//! that the error of G is at most half of that, 1.6e-5 of it; that of f64 is below what f64 resolves.
//! Inputs are positions, see [`crate::fixed`].
//!
//! D. Everett, Transactions of the Faraday Society 51 (1955).

use super::memory::TurningPoint;
use super::weights::Weights;
use crate::branch::cheaper;
use crate::constants::constants;
use crate::fixed::Fixed;
use crate::real::Real;

/// Table for `L` levels.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Everett<R: Real, const L: usize> {
    /// One quantum of an output.
    quantum: R,
    /// G(k + 1, l) at column l, row k >= l, edges counted from -U; zero above the diagonal. A branch lies between two
    /// columns.
    columns: [[<R::Fixed as Fixed<R>>::Entry; L]; L],
}

/// An output change and its derivative.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Change<F> {
    pub(crate) value: F,
    /// Over the end of the branch, per cell.
    pub(crate) slope: F,
}

/// The output along a cell: start + slope*x at the fraction x of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Climb<F> {
    pub(crate) cell: usize,
    pub(crate) start: F,
    pub(crate) slope: F,
}

/// Sums of weights, before they are rounded.
struct Sums<R, const L: usize>([[R; L]; L]);

impl<R: Real, const L: usize> Sums<R, L> {
    fn of(weights: &Weights<R, L>) -> Self {
        let mut sums = Self([[R::ZERO; L]; L]);
        for k in 0..L {
            // G(k+1, l) = G(k, l) + 2 * sum of mu_kj over j >= l: column by column from the diagonal.
            let mut row_sum = R::ZERO;
            for l in (0..=k).rev() {
                row_sum += weights.at(k, l);
                let value = sums.corner(k, l) + row_sum + row_sum;
                if let Some(place) = sums.0.get_mut(k).and_then(|row| row.get_mut(l)) {
                    *place = value;
                }
            }
        }
        sums
    }

    fn corner(&self, k: usize, l: usize) -> R {
        self.0.get(k.wrapping_sub(1)).and_then(|row| row.get(l)).copied().unwrap_or(R::ZERO)
    }

    /// Mean of the two major branches at an edge: (-S + G(k, 0) + S - G(L, k))/2.
    fn major_mean(&self, edge: usize) -> R {
        R::lit(0.5) * (self.corner(edge, 0) - self.corner(L, edge))
    }
}

impl<R: Real, const L: usize> Everett<R, L> {
    /// The table of the operator with these weights.
    pub fn build(weights: &Weights<R, L>) -> Self {
        let sums = Sums::of(weights);
        Self::rounded(R::lit(0.5) * weights.magnitude(), |k, l| sums.corner(k, l))
    }

    /// The table of A(u) - P\[u\], A the mean of the two branches of the major loop of P.
    pub(crate) fn leading(weights: &Weights<R, L>) -> Self {
        let sums = Sums::of(weights);
        Self::rounded(R::ZERO, |k, l| sums.major_mean(k) - sums.major_mean(l) - sums.corner(k, l))
    }

    /// Rise of G over each cell of its upper end, in outputs.
    pub(crate) fn slopes(&self) -> impl Iterator<Item = R> {
        let cells = (0..L).flat_map(|k| (0..=k).map(move |l| (k, l)));
        cells.map(|(k, l)| (self.entry(k + 1, l) - self.entry(k, l)).real() * self.quantum)
    }

    /// From G at the edges k > l, with room for outputs of twice the `reach`: weights of either sign can give more
    /// than any G, because they cancel in it.
    fn rounded(reach: R, corner: impl Fn(usize, usize) -> R) -> Self {
        let corners = || (1..=L).flat_map(|k| (0..k).map(move |l| (k, l)));
        let largest = corners().map(|(k, l)| corner(k, l).abs()).fold(reach, R::max);
        // Of an empty table every entry is zero, and so is every output.
        let (unit, quantum) = if largest > R::ZERO {
            (largest / R::Fixed::LARGEST, largest / R::Fixed::LARGEST / R::Fixed::SCALE)
        } else {
            (R::ONE, R::ZERO)
        };
        let mut columns = [[Default::default(); L]; L];
        for (k, l) in corners() {
            if let Some(place) = columns.get_mut(l).and_then(|column| column.get_mut(k - 1)) {
                *place = R::Fixed::entry(corner(k, l) / unit);
            }
        }
        Self { quantum, columns }
    }

    /// G at edges `k` and `l`, counted from -U; zero for k <= l.
    pub fn corner(&self, k: usize, l: usize) -> R {
        self.entry(k, l).real() * self.quantum
    }

    /// One quantum of an output.
    #[inline(always)]
    pub(crate) fn quantum(&self) -> R {
        self.quantum
    }

    /// G(to, from) for to >= from.
    #[inline(always)]
    pub(crate) fn rise(
        &self,
        to: <R::Fixed as Fixed<R>>::Position,
        from: <R::Fixed as Fixed<R>>::Position,
    ) -> Change<R::Fixed> {
        let ((to_cell, to), (from_cell, from)) = (R::Fixed::place(to, L), R::Fixed::place(from, L));
        if to_cell > from_cell {
            // The corners of a cell off the diagonal: two rows, in each two columns.
            let corner = from_cell * L + to_cell;
            let entries = self.columns.as_flattened();
            let start = R::Fixed::between(entries[corner - 1], entries[corner + L - 1], from);
            let slope = R::Fixed::between(entries[corner], entries[corner + L], from) - start;
            return Change { value: start + slope.scaled(to), slope };
        }
        cheaper();
        // In a cell of the diagonal.
        let slope = R::Fixed::output(self.columns[to_cell][to_cell]);
        Change { value: slope.scaled(to - from), slope }
    }

    /// The cell of a branch in which the output has `reached` its target, a function of an edge and the output
    /// there; the last one when it does in none.
    #[inline(always)]
    pub(crate) fn climb(
        &self,
        start: &TurningPoint<R>,
        reached: impl Fn(usize, R::Fixed) -> bool,
    ) -> Climb<R::Fixed> {
        let (first, from) = R::Fixed::place(start.position, L);
        let output = |edge: usize| {
            // Of the last column only the cell on the diagonal counts, which is not between two.
            let next = (first + 1).min(L - 1);
            let between =
                R::Fixed::between(self.columns[first][edge - 1], self.columns[next][edge - 1], from);
            start.output + between
        };
        // Up to the start the entries are zero.
        let cell = last_below::<L>(0, |edge| reached(edge, output(edge)));
        if cell > first {
            let lower = output(cell);
            return Climb { cell, start: lower, slope: output(cell + 1) - lower };
        }
        cheaper();
        // On the diagonal: through the start.
        let slope = self.entry(cell + 1, cell);
        Climb { cell, start: start.output - slope.scaled(from), slope }
    }

    /// The same of the virgin curve, on which both ends of G move: its curvature in the cells is the second value.
    #[inline(always)]
    pub(crate) fn climb_virgin_curve(
        &self,
        reached: impl Fn(usize, R::Fixed) -> bool,
    ) -> (Climb<R::Fixed>, R::Fixed) {
        let output = |edge: usize| self.entry(edge, L - edge).half();
        // With an odd number of levels the middle cell is on the diagonal, where G is antisymmetric.
        let cell = last_below::<L>(L / 2, |edge| reached(edge, output(edge)));
        let start = if cell + cell < L { R::Fixed::default() - output(cell + 1) } else { output(cell) };
        let middle = self.entry(cell + 1, L - cell).half();
        let slope = (middle - start) + (middle - start);
        (Climb { cell, start, slope }, (output(cell + 1) - middle) - (middle - start))
    }

    #[inline(always)]
    fn entry(&self, k: usize, l: usize) -> R::Fixed {
        let entry = self.columns.get(l).and_then(|column| column.get(k.wrapping_sub(1))).copied();
        R::Fixed::output(entry.unwrap_or_default())
    }
}

/// The last edge from `first` to `L` - 1 that is not `reached`, by halving what is left.
#[inline(always)]
fn last_below<const L: usize>(first: usize, reached: impl Fn(usize) -> bool) -> usize {
    let mut below = first;
    let mut left = L - first;
    while left > 1 {
        let edge = below + left / 2;
        below = core::hint::select_unpredictable(reached(edge), below, edge);
        left -= left / 2;
    }
    below
}
