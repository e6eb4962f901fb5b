//! Which cells the inputs that train have moved: a tenth of a cell's relays switched at least once, as for a gear's weights.

use super::grid::Grid;
use super::history::History;

/// Change of a cell's state when a tenth of its relays switch.
const MOVED: f64 = 0.2;

/// Fraction of the cells that any of these inputs moved.
pub(super) fn moved<'a>(grid: Grid, inputs: impl Iterator<Item = &'a [f64]>) -> f64 {
    let mut moved = vec![false; grid.size()];
    for input in inputs {
        let mut history = History::new(grid);
        let mut ends = vec![[f64::INFINITY, f64::NEG_INFINITY]; grid.size()];
        for u in input {
            for ([least, most], state) in ends.iter_mut().zip(history.step(*u)) {
                (*least, *most) = (least.min(*state), most.max(*state));
            }
        }
        moved.iter_mut().zip(ends).for_each(|(moved, [least, most])| *moved |= most - least >= MOVED);
    }
    moved.iter().filter(|moved| **moved).count() as f64 / grid.size() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rise from end to end switches every cell, a small loop at the middle those around it.
    #[test]
    fn a_sweep_moves_every_cell_and_a_small_loop_few() {
        let grid = Grid { low: 0.0, high: 8.0, levels: 8 };
        let sweep: Vec<_> = (0..=80).map(|k| 0.1 * f64::from(k)).collect();
        assert_eq!(moved(grid, std::iter::once(sweep.as_slice())), 1.0);
        let small = [4.0, 4.9, 4.0, 4.9];
        assert!(moved(grid, std::iter::once(small.as_slice())) < 0.2);
        assert_eq!(moved(grid, [small.as_slice(), &sweep].into_iter()), 1.0);
    }
}
