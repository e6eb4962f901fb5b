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
//! that G is off by at most half of that, 1.6e-5 of it, everywhere; that of f64 is below what f64 resolves.
//! Inputs are positions, see [`super::fixed`].
//!
//! D. Everett, Transactions of the Faraday Society 51 (1955).

use super::fixed::Fixed;
use super::memory::cheaper;
use super::weights::Weights;
use crate::real::Real;

/// Table for `L` levels.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Everett<R: Real, const L: usize> {
    /// One quantum of an output.
    quantum: R,
    /// G(k + 1, l) at row k, column l <= k, edges counted from -U; zero above the diagonal.
    rows: [[<R::Fixed as Fixed<R>>::Entry; L]; L],
}

/// An output change and its derivative.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Change<F> {
    pub(crate) value: F,
    /// Over the end of the branch, per cell.
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
        Self::rounded(|k, l| sums.corner(k, l))
    }

    /// The table of A(u) - P\[u\], A the mean of the two branches of the major loop of P.
    pub(crate) fn leading(weights: &Weights<R, L>) -> Self {
        let sums = Sums::of(weights);
        Self::rounded(|k, l| sums.major_mean(k) - sums.major_mean(l) - sums.corner(k, l))
    }

    /// From G at the edges k > l.
    fn rounded(corner: impl Fn(usize, usize) -> R) -> Self {
        let corners = || (1..=L).flat_map(|k| (0..k).map(move |l| (k, l)));
        let largest = corners().map(|(k, l)| corner(k, l).abs()).fold(R::ZERO, R::max);
        // Of an empty table every entry is zero.
        let unit = if largest > R::ZERO { largest / R::Fixed::LARGEST } else { R::ONE };
        let mut rows = [[Default::default(); L]; L];
        for (k, l) in corners() {
            if let Some(place) = rows.get_mut(k - 1).and_then(|row| row.get_mut(l)) {
                *place = R::Fixed::entry(corner(k, l) / unit);
            }
        }
        Self { rows, quantum: unit / R::Fixed::SCALE }
    }

    /// G at edges `k` and `l`, counted from -U; zero for k <= l.
    pub fn corner(&self, k: usize, l: usize) -> R {
        let entry = self.rows.get(k.wrapping_sub(1)).and_then(|row| row.get(l)).copied();
        R::Fixed::output(entry.unwrap_or_default()).real() * self.quantum
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
            let start = self.between(to_cell - 1, from_cell, from);
            let slope = self.between(to_cell, from_cell, from) - start;
            return Change { value: start + slope.share(to), slope };
        }
        cheaper();
        // In a cell of the diagonal.
        let slope = R::Fixed::output(self.rows[to_cell][to_cell]);
        Change { value: slope.share(to - from), slope }
    }

    /// Within a row, at a fraction of a cell.
    #[inline(always)]
    fn between(&self, row: usize, cell: usize, fraction: R::Fixed) -> R::Fixed {
        R::Fixed::between(self.rows[row][cell], self.rows[row][cell + 1], fraction)
    }
}
