//! An identified Preisach operator.
//!
//! ```text
//! y = c + k*(u - middle) + sum mu_ij * x_ij[u]
//! ```
//!
//! Units are those of the input u and of the output y. Weights mu of one sign make the operator dissipate: positive ones where the output
//! lags its input, as displacement over force does, negative ones where it leads, as force over displacement does.

use super::grid::Grid;
use super::history::History;
use crate::identify::Error;

/// Checked operator.
#[derive(Clone, Debug, PartialEq)]
pub struct Operator {
    grid: Grid,
    offset: f64,
    slope: f64,
    weights: Vec<f64>,
}

/// Fewest and most levels.
pub const LEVELS: std::ops::RangeInclusive<usize> = 2..=64;
/// Largest magnitude of a number of an operator.
pub const LARGEST: f64 = 1e30;

/// Output along an input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// y, relays in an unknown state left out.
    pub output: f64,
    /// Fraction of the triangle in an unknown state; it never rises.
    pub unknown: f64,
    /// Distance of the highest and the lowest input so far (cells).
    pub apart: f64,
}

impl Operator {
    /// From its numbers; a weight for each cell, row by row.
    ///
    /// # Errors
    /// [`strainwave::Error::OutOfRange`] `levels`, `range`, `offset`, `slope` or `weights`.
    pub fn build(grid: Grid, offset: f64, slope: f64, weights: Vec<f64>) -> Result<Self, Error> {
        let is_number = |value: f64| value.abs() <= LARGEST;
        let checks = [
            (LEVELS.contains(&grid.levels), "levels"),
            (is_number(grid.low) && is_number(grid.high) && grid.low < grid.high, "range"),
            (is_number(offset), "offset"),
            (is_number(slope), "slope"),
            (weights.len() == grid.size() && weights.iter().all(|weight| is_number(*weight)), "weights"),
        ];
        match checks.iter().find(|(holds, _)| !holds) {
            Some((_, name)) => Err(strainwave::Error::OutOfRange(name).into()),
            None => Ok(Self { grid, offset, slope, weights }),
        }
    }

    /// Range and levels.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// c, the line's output in the middle of the range.
    pub fn offset(&self) -> f64 {
        self.offset
    }

    /// k, also outside the range, where no relay switches.
    pub fn slope(&self) -> f64 {
        self.slope
    }

    /// mu of every cell, row by row.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Output along an input, from an unknown state.
    pub fn points(&self, input: &[f64]) -> Vec<Point> {
        let mut history = History::new(self.grid);
        let point = |u: &f64| {
            let hysteresis: f64 = history.step(*u).iter().zip(&self.weights).map(|(x, mu)| x * mu).sum();
            let line = self.offset + self.slope * (u - self.grid.middle());
            let (unknown, apart) = history.unknown();
            Point { output: line + hysteresis, unknown, apart }
        };
        input.iter().map(point).collect()
    }

    /// Output along an input that starts with the output `first`: relays in an unknown state give what it is off by, those of
    /// them that have not switched yet in proportion to their number.
    pub fn outputs_from(&self, input: &[f64], first: f64) -> Vec<f64> {
        let points = self.points(input);
        let rest = match points.first() {
            Some(point) if point.unknown > 0.0 => (first - point.output) / point.unknown,
            _ => 0.0,
        };
        points.iter().map(|point| point.output + rest * point.unknown).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn operator(weights: impl Fn(usize, usize) -> f64) -> Operator {
        let grid = Grid { low: -1.0, high: 1.0, levels: 8 };
        let weights = grid.cells().map(|(i, j)| weights(i, j)).collect();
        Operator::build(grid, 0.5, 2.0, weights).unwrap()
    }

    /// From corner to corner in 100 steps each.
    fn path(corners: &[f64]) -> Vec<f64> {
        let leg = |pair: &[f64]| -> Vec<f64> {
            (0..100).map(|k| pair[0] + (pair[1] - pair[0]) * f64::from(k) / 100.0).collect()
        };
        corners.windows(2).flat_map(leg).chain(corners.last().copied()).collect()
    }

    fn outputs(operator: &Operator, input: &[f64]) -> Vec<f64> {
        operator.points(input).iter().map(|point| point.output).collect()
    }

    #[test]
    fn minor_loops_between_the_same_ends_are_congruent_and_closed() {
        let operator = operator(|i, j| 0.01 * (1 + i * i + 3 * j) as f64);
        let minor = [0.2, -0.4, 0.2];
        let after = |history: &[f64]| {
            let all = outputs(&operator, &path(&[history, &minor].concat()));
            all[all.len() - 201..].to_vec()
        };
        let (one, other) = (after(&[-1.0, 1.0, -0.9]), after(&[1.0, -1.0, 0.7, -0.8]));
        let apart = one[0] - other[0];
        assert!(one.iter().zip(&other).all(|(a, b)| (a - b - apart).abs() < 1e-12) && apart.abs() > 1e-3);
        assert!((one[0] - one[200]).abs() < 1e-12);
    }

    #[test]
    fn a_loop_of_positive_weights_takes_energy_and_one_of_negative_weights_gives_it() {
        let input = path(&[-1.0, 0.6, -0.7, 0.6]);
        let area = |weight: f64| {
            let output = outputs(&operator(|_, _| weight), &input);
            let last: Vec<_> = input.iter().zip(&output).rev().take(201).collect();
            last.windows(2).map(|pair| 0.5 * (pair[0].1 + pair[1].1) * (pair[0].0 - pair[1].0)).sum::<f64>()
        };
        // Counted backwards and over u: the integral of u dy is its negative.
        assert!(area(0.1) < -1e-3 && (area(0.1) + area(-0.1)).abs() < 1e-12, "{}", area(0.1));
    }

    #[test]
    fn an_unknown_start_is_what_the_first_output_says() {
        let operator = operator(|_, _| 0.03);
        let whole = path(&[-1.0, 0.4, -0.3, 0.1, -0.2, 1.0]);
        let expected = outputs(&operator, &whole);
        // From a turn on: what came before is not in the log.
        let found = operator.outputs_from(&whole[200..], expected[200]);
        let points = operator.points(&whole[200..]);
        assert!(points[0].unknown > 0.1 && points.windows(2).all(|pair| pair[1].unknown <= pair[0].unknown));
        let off = |row: usize, output: f64| (output - expected[200 + row]).abs();
        assert!(off(0, found[0]) < 1e-12 && off(0, points[0].output) > 0.02);
        // At the end of the range the state is known, whatever it was.
        let last = points.len() - 1;
        assert!(points[last].unknown == 0.0 && off(last, found[last]) < 1e-12);
    }

    #[test]
    fn numbers_out_of_range_are_named() {
        let grid = Grid { low: 0.0, high: 1.0, levels: 2 };
        let refused = |grid, offset, slope, weights: &[f64]| {
            Operator::build(grid, offset, slope, weights.to_vec()).unwrap_err().to_string()
        };
        let weights = [1.0, 2.0, 3.0];
        assert_eq!(refused(Grid { levels: 1, ..grid }, 0.0, 0.0, &weights), "levels is out of range");
        assert_eq!(refused(Grid { high: 0.0, ..grid }, 0.0, 0.0, &weights), "range is out of range");
        assert_eq!(refused(grid, f64::NAN, 0.0, &weights), "offset is out of range");
        assert_eq!(refused(grid, 0.0, 1e31, &weights), "slope is out of range");
        assert_eq!(refused(grid, 0.0, 0.0, &weights[1..]), "weights is out of range");
    }
}
