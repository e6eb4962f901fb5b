//! The triangle of a Preisach operator over a range of its input, cut into cells.
//!
//! Places are counted in cells from the lower end of the range, 0..=L. Cell (i, j), j <= i < L, holds the relays that switch
//! up between the places i and i + 1 and down between j and j + 1, evenly; on the diagonal only those below it, half a
//! cell. Cells are listed row by row. Unlike the gear's own weights ([`strainwave::hysteresis::Weights`]) they need
//! not be symmetric: the range need not be, and an actuator may have a preferred direction.

/// Range and number of levels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Lower end of the range.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// L
    pub levels: usize,
}

impl Grid {
    /// (i, j) of every cell.
    pub fn cells(&self) -> impl Iterator<Item = (usize, usize)> + Clone + use<> {
        (0..self.levels).flat_map(|i| (0..=i).map(move |j| (i, j)))
    }

    /// Number of cells.
    pub fn size(&self) -> usize {
        self.levels * (self.levels + 1) / 2
    }

    /// Middle of the range.
    pub fn middle(&self) -> f64 {
        0.5 * (self.low + self.high)
    }

    /// Half of the range.
    pub fn half_range(&self) -> f64 {
        0.5 * (self.high - self.low)
    }

    /// Place of an input; an end of the range for one outside it.
    pub(super) fn place(&self, input: f64) -> f64 {
        let levels = self.levels as f64;
        ((input - self.low) / (self.high - self.low) * levels).clamp(0.0, levels)
    }
}

/// Fraction of a cell's relays that switch up below the place `alpha` and down above the place `beta`.
pub(super) fn fraction((i, j): (usize, usize), alpha: f64, beta: f64) -> f64 {
    let below = (alpha - i as f64).clamp(0.0, 1.0);
    let above = (j as f64 + 1.0 - beta).clamp(0.0, 1.0);
    if i == j { (below + above - 1.0).max(0.0).powi(2) } else { below * above }
}

/// Weight of a cell of an operator with even density and the total 1.
pub(super) fn unit_weight(grid: &Grid, (i, j): (usize, usize)) -> f64 {
    let halves = if i == j { 1.0 } else { 2.0 };
    halves / (grid.levels * grid.levels) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_even_density_switches_by_the_area_of_its_triangle() {
        let grid = Grid { low: -1.0, high: 3.0, levels: 7 };
        assert_eq!(grid.cells().count(), grid.size());
        let total: f64 = grid.cells().map(|cell| unit_weight(&grid, cell)).sum();
        assert!((total - 1.0).abs() < 1e-12);
        for (low, high) in [(-1.0, 3.0), (-0.3, 2.1), (0.4, 0.5)] {
            let (beta, alpha) = (grid.place(low), grid.place(high));
            let of = |cell| unit_weight(&grid, cell) * fraction(cell, alpha, beta);
            let switched: f64 = grid.cells().map(of).sum();
            assert!((switched - ((high - low) / 4.0f64).powi(2)).abs() < 1e-12, "{low} {high}");
        }
        assert_eq!([grid.place(-9.0), grid.place(9.0)], [0.0, 7.0]);
    }
}
