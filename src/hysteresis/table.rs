//! Identified weights as a gear carries them: one table of [`TABLE_LEVELS`], spread over the levels of any build.
//!
//! The weight of a cell is even over it, that of a cell on the diagonal even along its diagonal, as the
//! Everett table interpolates: a finer grid whose edges hold the table's is the same operator, and on
//! any other grid the operator is the same at the edges of that grid. A sum of shares, so that no
//! weight becomes negative.
//!
//! Units: half range (rad), weights (N m).

use super::torsion::TorsionHysteresis;
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
    /// mu_ij with i + j < [`TABLE_LEVELS`], row i after row i - 1 (N m); 0..=1e6.
    pub weights: [R; TABLE_WEIGHTS],
}

impl<R: Real> HysteresisTable<R> {
    /// The table of weights on any grid over torsions of +-`half_range` (rad).
    pub fn of<const L: usize>(half_range: R, weights: &Weights<R, L>) -> Self {
        let mut table = Self { half_range, weights: [R::ZERO; TABLE_WEIGHTS] };
        let source = |i: usize, j: usize| weights.at(i, j);
        for i in 0..TABLE_LEVELS {
            for j in 0..=i.min(TABLE_LEVELS - 1 - i) {
                if let Some(place) = table.weights.get_mut(place(i, j)) {
                    *place = share::<R, L, TABLE_LEVELS>(source, i, j);
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
        // The mirror images are copies, to the last bit.
        let lower = |i: usize, j: usize| if i + j < L { (i, j) } else { (L - 1 - j, L - 1 - i) };
        Weights::from_fn(|i, j| {
            let (i, j) = lower(i, j);
            share::<R, TABLE_LEVELS, L>(|i, j| self.at(i, j), i, j)
        })
    }

    /// The model with `L` levels.
    ///
    /// # Errors
    /// As [`Weights::from_fn`] and [`TorsionHysteresis::from_weights`].
    pub fn build<const L: usize, const MEMORY: usize>(
        &self,
    ) -> Result<TorsionHysteresis<R, L, MEMORY>, Error> {
        TorsionHysteresis::from_weights(self.half_range, &self.weights()?)
    }

    /// mu_ij.
    fn at(&self, i: usize, j: usize) -> R {
        let last = TABLE_LEVELS - 1;
        let place = if i + j <= last { place(i, j) } else { place(last - j, last - i) };
        self.weights.get(place).copied().unwrap_or(R::ZERO)
    }
}

/// Where mu_ij with i + j < [`TABLE_LEVELS`] stands: row i has i + 1 weights, from the middle on one less each.
const fn place(i: usize, j: usize) -> usize {
    if 2 * i <= TABLE_LEVELS {
        i * (i + 1) / 2 + j
    } else {
        TABLE_WEIGHTS - (TABLE_LEVELS - i) * (TABLE_LEVELS - i + 1) / 2 + j
    }
}

/// Weight that cell (i, j) of a grid of `TO` levels takes from the weights of a grid of `FROM` levels.
fn share<R: Real, const FROM: usize, const TO: usize>(
    weight: impl Fn(usize, usize) -> R,
    i: usize,
    j: usize,
) -> R {
    let mut sum = R::ZERO;
    for from_i in covering::<FROM, TO>(i) {
        let along_i = overlap::<R, FROM, TO>(from_i, i);
        for from_j in covering::<FROM, TO>(j).take_while(|from_j| *from_j <= from_i) {
            let part = match (from_i == from_j, i == j) {
                (true, true) => along_i,
                // Of a weight along the diagonal a cell off it has none.
                (true, false) => R::ZERO,
                (false, _) => along_i * overlap::<R, FROM, TO>(from_j, j),
            };
            sum += part * weight(from_i, from_j);
        }
    }
    sum
}

/// Cells of the grid of `FROM` levels that touch cell `k` of the grid of `TO` levels.
fn covering<const FROM: usize, const TO: usize>(k: usize) -> core::ops::Range<usize> {
    k * FROM / TO..((k + 1) * FROM).div_ceil(TO)
}

/// Share of cell `from` that lies in cell `to`; whole numbers until the end, so that a whole cell is 1.
fn overlap<R: Real, const FROM: usize, const TO: usize>(from: usize, to: usize) -> R {
    let start = (from * TO).max(to * FROM);
    let end = ((from + 1) * TO).min((to + 1) * FROM);
    R::from_i32(end.saturating_sub(start) as i32) / R::from_i32(TO as i32)
}

#[cfg(test)]
mod tests {
    use super::super::everett::Everett;
    use super::super::staircase::{Staircase, StaircaseState};
    use super::*;
    use proptest::prelude::*;

    /// Symmetric weights without a pattern.
    fn uneven<const L: usize>() -> Weights<f64, L> {
        Weights::from_fn(|i, j| (((i - j) * 7 + (i + L - 1 - j) * 3) % 11) as f64).unwrap()
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
        assert_eq!(HysteresisTable::of(1.0, &weights).weights().unwrap(), weights);
        assert_eq!(
            HysteresisTable::of(1.0, &Weights::<f32, 24>::uniform(3.0).unwrap()).weights().unwrap(),
            Weights::<f32, 24>::uniform(3.0).unwrap()
        );
    }

    #[test]
    fn any_grid_has_the_table_s_operator_at_its_edges() {
        fn agrees<const L: usize>() {
            let table = HysteresisTable::of(1.0, &uneven::<TABLE_LEVELS>());
            let fine = Everett::build(&uneven::<TABLE_LEVELS>());
            let weights = table.weights::<L>().unwrap();
            let other = Everett::build(&weights);
            let middle = |edge: usize| (edge as f64 / L as f64 - 0.5) * TABLE_LEVELS as f64;
            for k in 0..=L {
                for l in 0..k {
                    let place = |edge| Everett::<f64, TABLE_LEVELS>::place(middle(edge));
                    let wanted = fine.change(place(k), place(l)).value;
                    assert!((other.corner(k, l) - wanted).abs() < 1e-11, "{L}: {k} {l}");
                }
            }
            assert!((weights.total() - uneven::<TABLE_LEVELS>().total()).abs() < 1e-11);
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
            let weights = HysteresisTable::of(1.0, &uneven::<8>()).weights::<TABLE_LEVELS>().unwrap();
            let fine = Staircase::<f64, TABLE_LEVELS, 64>::build(1.0, &weights).unwrap();
            let (mut a, mut b) = (StaircaseState::default(), StaircaseState::default());
            for input in inputs {
                let difference = coarse.step(&mut a, input).output - fine.step(&mut b, input).output;
                prop_assert!(difference.abs() < 1e-11);
            }
        }
    }
}
