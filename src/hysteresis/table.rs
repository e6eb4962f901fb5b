//! Identified weights as a gear stores them: one table of [`TABLE_LEVELS`], spread over the levels of any build.
//!
//! The weight of a cell is even over it, that of a cell on the diagonal even along its diagonal, as the
//! Everett table interpolates: a finer grid whose edges hold the table's is the same operator, and on
//! any other grid the operator is the same at the edges of that grid. A sum of fractions, so that no
//! weight becomes negative.
//!
//! Units: half range (rad), weights (N m).

use super::weights::Weights;
use crate::error::Error;
use crate::real::Real;

/// Levels of the table; even.
pub const TABLE_LEVELS: usize = 24;
/// Weights in the table: those on and below the line alpha = -beta. The others are their mirror images.
pub const TABLE_WEIGHTS: usize = TABLE_LEVELS * (TABLE_LEVELS + 2) / 4;

/// Weights of a gear's hysteresis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HysteresisTable<R> {
    /// U (rad), torsion at which the loop closes; 1e-9..=1e6.
    pub half_range: R,
    /// mu_ij with i + j < [`TABLE_LEVELS`], row i after row i - 1 (N m); 0..=1e6, of [`Self::signed_weights`] from -1e6.
    pub weights: [R; TABLE_WEIGHTS],
}

impl<R: Real> HysteresisTable<R> {
    /// The table over torsions of +-`half_range` (rad) of the weights mu_ij = `weight(i, j)`, j <= i, on a grid of
    /// `levels`, which are taken to be symmetric.
    pub fn from_fn(half_range: R, levels: usize, weight: impl Fn(usize, usize) -> R) -> Self {
        let mut table = Self { half_range, weights: [R::ZERO; TABLE_WEIGHTS] };
        for i in 0..TABLE_LEVELS {
            for j in 0..=i.min(TABLE_LEVELS - 1 - i) {
                if let Some(place) = table.weights.get_mut(place(i, j)) {
                    *place = resampled(&weight, levels, TABLE_LEVELS, (i, j));
                }
            }
        }
        table
    }

    /// The weights on the grid of `L` levels.
    ///
    /// # Errors
    /// As [`Weights::from_fn`].
    pub fn weights<const L: usize>(&self) -> Result<Weights<R, L>, Error> {
        Weights::from_fn(|i, j| self.on_grid::<L>(i, j))
    }

    /// The same of weights of either sign.
    ///
    /// # Errors
    /// As [`Weights::signed_from_fn`].
    pub fn signed_weights<const L: usize>(&self) -> Result<Weights<R, L>, Error> {
        Weights::signed_from_fn(|i, j| self.on_grid::<L>(i, j))
    }

    /// mu_ij on a grid of `L` levels.
    fn on_grid<const L: usize>(&self, i: usize, j: usize) -> R {
        // The mirror images are copies, to the last bit.
        let place = if i + j < L { (i, j) } else { (L - 1 - j, L - 1 - i) };
        resampled(|i, j| self.at(i, j), TABLE_LEVELS, L, place)
    }

    /// mu_ij.
    fn at(&self, i: usize, j: usize) -> R {
        let last = TABLE_LEVELS - 1;
        let place = if i + j <= last { place(i, j) } else { place(last - j, last - i) };
        self.weights.get(place).copied().unwrap_or(R::ZERO)
    }
}

/// Index of mu_ij with i + j < [`TABLE_LEVELS`]: row i has i + 1 weights, from the middle on one less each.
const fn place(i: usize, j: usize) -> usize {
    if 2 * i <= TABLE_LEVELS {
        i * (i + 1) / 2 + j
    } else {
        TABLE_WEIGHTS - (TABLE_LEVELS - i) * (TABLE_LEVELS - i + 1) / 2 + j
    }
}

/// Weight that cell (i, j) of a grid of `to` levels takes from the weights of a grid of `from` levels.
fn resampled<R: Real>(
    weight: impl Fn(usize, usize) -> R,
    from: usize,
    to: usize,
    (i, j): (usize, usize),
) -> R {
    let mut sum = R::ZERO;
    for from_i in covering(i, from, to) {
        let along_i = overlap::<R>((from_i, from), (i, to));
        for from_j in covering(j, from, to).take_while(|from_j| *from_j <= from_i) {
            let part = match (from_i == from_j, i == j) {
                (true, true) => along_i,
                // Of a weight along the diagonal a cell off it has none.
                (true, false) => R::ZERO,
                (false, _) => along_i * overlap::<R>((from_j, from), (j, to)),
            };
            sum += part * weight(from_i, from_j);
        }
    }
    sum
}

/// Cells of a grid of `from` levels that touch cell `k` of a grid of `to` levels.
fn covering(k: usize, from: usize, to: usize) -> core::ops::Range<usize> {
    let to = to.max(1);
    k * from / to..((k + 1) * from).div_ceil(to)
}

/// Fraction of a cell that lies in another, each with its number of levels; whole numbers until the end, so that
/// a whole cell is 1.
fn overlap<R: Real>((cell, levels): (usize, usize), (other, other_levels): (usize, usize)) -> R {
    let start = (cell * other_levels).max(other * levels);
    let end = ((cell + 1) * other_levels).min((other + 1) * levels);
    R::from_i32(end.saturating_sub(start) as i32) / R::from_i32(other_levels as i32)
}

#[cfg(test)]
mod tests {
    use super::super::staircase::{Staircase, StaircaseState};
    use super::*;
    use proptest::prelude::*;

    /// Symmetric weights without a pattern.
    fn uneven<const L: usize>() -> Weights<f64, L> {
        Weights::from_fn(|i, j| (((i - j) * 7 + (i + L - 1 - j) * 3) % 11) as f64).unwrap()
    }

    fn table<const L: usize>(weights: &Weights<f64, L>) -> HysteresisTable<f64> {
        HysteresisTable::from_fn(1.0, L, |i, j| weights.at(i, j))
    }

    #[test]
    fn every_weight_has_its_own_place() {
        let mut taken = [false; TABLE_WEIGHTS];
        for i in 0..TABLE_LEVELS {
            for j in 0..=i.min(TABLE_LEVELS - 1 - i) {
                assert!(!core::mem::replace(&mut taken[place(i, j)], true), "({i}, {j})");
            }
        }
        assert!(taken.iter().all(|taken| *taken));
    }

    #[test]
    fn weights_of_its_own_grid_come_back_bit_by_bit() {
        let weights = uneven::<TABLE_LEVELS>();
        assert_eq!(table(&weights).weights().unwrap(), weights);
    }

    #[test]
    fn any_grid_has_the_table_s_operator_at_its_edges() {
        fn agrees<const L: usize>() {
            let table_weights = uneven::<TABLE_LEVELS>();
            let weights = table(&table_weights).weights::<L>().unwrap();
            let expected = Staircase::<f64, TABLE_LEVELS, 64>::build(1.0, &table_weights).unwrap();
            let found = Staircase::<f64, L, 64>::build(1.0, &weights).unwrap();
            let (mut a, mut b) = (StaircaseState::default(), StaircaseState::default());
            for k in 0..20 * L {
                let edge = 2.0 * (k * k * 7 % (L + 1)) as f64 / L as f64 - 1.0;
                let difference = expected.step(&mut a, edge).output - found.step(&mut b, edge).output;
                assert!(difference.abs() < 1e-6 * weights.total(), "{L}: {edge} {difference:e}");
            }
            assert!((weights.total() - table_weights.total()).abs() < 1e-11);
        }
        agrees::<6>();
        agrees::<16>();
        agrees::<48>();
        agrees::<64>();
    }

    proptest! {
        /// The table of a coarser grid whose edges are its own is the same operator between them too.
        #[test]
        fn a_coarse_grid_is_carried_without_loss(inputs in prop::collection::vec(-1.2..1.2f64, 1..60)) {
            let coarse = Staircase::<f64, 8, 64>::build(1.0, &uneven()).unwrap();
            let weights = table(&uneven::<8>()).weights::<TABLE_LEVELS>().unwrap();
            let fine = Staircase::<f64, TABLE_LEVELS, 64>::build(1.0, &weights).unwrap();
            let (mut a, mut b) = (StaircaseState::default(), StaircaseState::default());
            for input in inputs {
                let difference = coarse.step(&mut a, input).output - fine.step(&mut b, input).output;
                prop_assert!(difference.abs() < 1e-6 * weights.total());
            }
        }
    }
}
