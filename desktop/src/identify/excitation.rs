//! Which cells of the triangle an input has moved.
//!
//! A cell counts as moved when its relays switched at least once for a tenth of their weight. Of a weight
//! whose cell (and mirror image) never moved, the log says nothing: the smoothness alone gives it.

use strainwave::hysteresis::{Staircase, StaircaseState};

use super::Error;
use super::regressors::{pairs, regressors};
use crate::plant::MEMORY;

/// Fraction of the weight that must have switched.
const MOVED: f64 = 0.1;

/// The cells that an input has moved, with their mirror images.
#[derive(Clone, Debug, PartialEq)]
pub struct Excitation {
    /// Row i, column j <= i.
    pub moved: Vec<Vec<bool>>,
}

impl Excitation {
    /// Of the operator with `L` levels over inputs of +-`half_range`.
    ///
    /// # Errors
    /// As [`Staircase::build`].
    pub fn of<const L: usize>(half_range: f64, inputs: &[f64]) -> Result<Self, Error> {
        let columns = regressors::<L, _>(inputs, |unit| {
            let operator = Staircase::<f64, L, MEMORY>::build(half_range, unit)?;
            let mut state = StaircaseState::default();
            Ok(move |input| operator.step(&mut state, input).output)
        })?;
        let Self { mut moved } = Self::none(L);
        for ((i, j), column) in pairs::<L>().zip(columns.column_iter()) {
            // A pair switches by 2 each, a cell that is its own mirror image by 2.
            let has_moved = column.max() - column.min() >= 2.0 * MOVED;
            moved[i][j] = has_moved;
            moved[L - 1 - j][L - 1 - i] = has_moved;
        }
        Ok(Self { moved })
    }

    /// No cell of a grid.
    pub fn none(levels: usize) -> Self {
        Self { moved: (0..levels).map(|i| vec![false; i + 1]).collect() }
    }

    /// With the cells that another input has moved on the same grid.
    pub fn add(&mut self, other: &Self) {
        let cells = self.moved.iter_mut().flatten().zip(other.moved.iter().flatten());
        cells.for_each(|(moved, other)| *moved |= other);
    }

    /// Fraction of the cells that moved.
    pub fn fraction(&self) -> f64 {
        let cells = self.moved.iter().flatten();
        cells.clone().filter(|moved| **moved).count() as f64 / cells.count() as f64
    }
}
