//! Bounded, regularised linear least squares.
//!
//! ```text
//! min  |A x - b|^2 + (x - p)'Q(x - p)        x_k >= 0 for the bounded k
//! ```
//!
//! The rows of [A | b] are reduced to their triangular factor first: it has the same squares for every x, and
//! the factors of several pieces of a log join to that of any of their unions. What remains is a quadratic
//! program of the size of x, for Clarabel's interior-point method.
//!
//! P. Goulart, Y. Chen, "Clarabel: an interior-point solver for conic programs with quadratic objectives",
//! arXiv 2405.12762 (2024).

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus};
use nalgebra::{DMatrix, DVector};

use super::Error;

/// Tolerance of the solver on the duality gap: the error of x goes with its root.
const TOLERANCE: f64 = 1e-12;

/// An unknown below it is at its bound; the problem is scaled, so that they are of the order of 1.
const AT_BOUND: f64 = 1e-7;

/// Triangular factor of the rows [A | b], and how many they were.
#[derive(Clone, Debug)]
pub(super) struct Factor {
    triangle: DMatrix<f64>,
    rows: usize,
}

/// Rows [A | b] that are reduced as they come: the memory that they take does not grow with their number.
pub(super) struct Reduction {
    columns: usize,
    /// Not reduced yet, row by row.
    rows: Vec<f64>,
    factor: Option<Factor>,
}

/// Most rows that are held before they are reduced; as many as there are columns where those are more.
const MOST_HELD: usize = 1024;

impl Reduction {
    /// Of rows with this many numbers.
    pub fn new(columns: usize) -> Self {
        Self { columns, rows: Vec::new(), factor: None }
    }

    /// Takes a row.
    pub fn push(&mut self, row: impl IntoIterator<Item = f64>) {
        self.rows.extend(row);
        if self.rows.len() >= self.columns * MOST_HELD.max(self.columns) {
            self.reduce();
        }
    }

    /// The factor of all rows.
    pub fn finish(mut self) -> Factor {
        self.reduce();
        self.factor.unwrap_or_else(|| Factor { triangle: DMatrix::zeros(0, self.columns), rows: 0 })
    }

    fn reduce(&mut self) {
        if self.rows.is_empty() {
            return;
        }
        let count = self.rows.len() / self.columns;
        let last = Factor::of(DMatrix::from_row_slice(count, self.columns, &self.rows));
        self.rows.clear();
        self.factor = Some(match self.factor.take() {
            Some(before) => Factor::joined([before, last].iter()),
            None => last,
        });
    }
}

impl Factor {
    /// The factor of rows [A | b].
    pub fn of(rows: DMatrix<f64>) -> Self {
        let count = rows.nrows();
        Self { triangle: rows.qr().r(), rows: count }
    }

    /// The factor of the rows of all.
    pub fn joined<'a>(parts: impl Iterator<Item = &'a Self> + Clone) -> Self {
        let rows = parts.clone().map(|part| part.rows).sum();
        let blocks: Vec<_> = parts.flat_map(|part| part.triangle.row_iter()).collect();
        Self { triangle: DMatrix::from_rows(&blocks).qr().r(), rows }
    }

    /// Number of reduced rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// |A x - b|^2.
    pub fn squares(&self, x: &[f64]) -> f64 {
        let residual = |row: usize| {
            let sum: f64 = x.iter().enumerate().map(|(k, x)| self.triangle[(row, k)] * x).sum();
            sum - self.triangle[(row, x.len())]
        };
        (0..self.triangle.nrows()).map(|row| residual(row).powi(2)).sum()
    }

    /// The x that minimises |A x - b|^2 + (x - p)'Q(x - p) with x_k >= 0 from `bounded` on; Q is `penalty`, p `prior`.
    pub fn solve(
        &self,
        penalty: &DMatrix<f64>,
        prior: &DVector<f64>,
        bounded: usize,
    ) -> Result<Vec<f64>, Error> {
        let size = penalty.nrows();
        let (matrix, right) = (self.triangle.columns(0, size), self.triangle.column(size));
        let squares = matrix.transpose() * matrix + penalty;
        let linear = -(matrix.transpose() * right + penalty * prior);
        let objective = columns(size, size, |column, entry| {
            (0..=column).for_each(|row| entry(row, squares[(row, column)]));
        });
        let constraints = columns(size - bounded, size, |column, entry| {
            if column >= bounded {
                entry(column - bounded, -1.0);
            }
        });
        let mut x = minimise(&objective, linear.as_slice(), &constraints)?;
        // An interior point ends just inside its bounds, or by rounding just outside.
        x[bounded..].iter_mut().filter(|x| **x < AT_BOUND).for_each(|x| *x = 0.0);
        Ok(x)
    }

    /// Inverse of A'A + Q over the `free` unknowns; those at a bound are known, their rows and columns are 0. `None` where one of the
    /// free ones is not determined.
    pub fn covariance(&self, penalty: &DMatrix<f64>, free: &[usize]) -> Option<DMatrix<f64>> {
        let size = penalty.nrows();
        let matrix = self.triangle.columns(0, size);
        let squares = matrix.transpose() * matrix + penalty;
        let inverse = squares.select_rows(free).select_columns(free).cholesky()?.inverse();
        let mut whole = DMatrix::zeros(size, size);
        for (row, at_row) in free.iter().enumerate() {
            for (column, at_column) in free.iter().enumerate() {
                whole[(*at_row, *at_column)] = inverse[(row, column)];
            }
        }
        Some(whole)
    }
}

/// A sparse matrix column by column; `fill` gives the entries of a column from the top.
fn columns(rows: usize, count: usize, fill: impl Fn(usize, &mut dyn FnMut(usize, f64))) -> CscMatrix<f64> {
    let (mut starts, mut places, mut values) = (vec![0], Vec::new(), Vec::new());
    for column in 0..count {
        fill(column, &mut |row, value| {
            if value != 0.0 {
                places.push(row);
                values.push(value);
            }
        });
        starts.push(places.len());
    }
    CscMatrix::new(rows, count, starts, places, values)
}

/// The x that minimises x'P x/2 + q'x with A x <= 0.
fn minimise(
    objective: &CscMatrix<f64>,
    linear: &[f64],
    constraints: &CscMatrix<f64>,
) -> Result<Vec<f64>, Error> {
    let settings = DefaultSettingsBuilder::default()
        .verbose(false)
        .tol_gap_abs(TOLERANCE)
        .tol_gap_rel(TOLERANCE)
        .build()
        .map_err(|error| Error::Solver(error.to_string()))?;
    let (right, cones) = (vec![0.0; constraints.m], [NonnegativeConeT(constraints.m)]);
    let mut solver = DefaultSolver::new(objective, linear, constraints, &right, &cones, settings)
        .map_err(|error| Error::Solver(error.to_string()))?;
    solver.solve();
    match solver.solution.status {
        SolverStatus::Solved | SolverStatus::AlmostSolved => Ok(solver.solution.x),
        status => Err(Error::Solver(format!("{status:?}"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> DMatrix<f64> {
        DMatrix::from_fn(40, 4, |row, column| ((row * 7 + column * 13) as f64).sin() + f64::from(column == 1))
    }

    fn squares(rows: &DMatrix<f64>, x: &[f64]) -> f64 {
        (0..rows.nrows())
            .map(|r| ((0..3).map(|k| rows[(r, k)] * x[k]).sum::<f64>() - rows[(r, 3)]).powi(2))
            .sum()
    }

    #[test]
    fn a_factor_has_the_squares_of_its_rows_however_they_are_joined() {
        let rows = rows();
        let parts = [Factor::of(rows.rows(0, 2).into()), Factor::of(rows.rows(2, 38).into())];
        for factor in [Factor::of(rows.clone()), Factor::joined(parts.iter())] {
            assert_eq!(factor.rows(), 40);
            for x in [[0.0; 3], [1.0, -2.0, 0.5]] {
                assert!((factor.squares(&x) - squares(&rows, &x)).abs() < 1e-11);
            }
        }
    }

    #[test]
    fn rows_that_are_reduced_as_they_come_have_the_same_squares() {
        let x = [1.0, -2.0, 0.5];
        for count in [0, 1, MOST_HELD - 1, MOST_HELD, 2 * MOST_HELD + 3] {
            let row = |row: usize| (0..4).map(move |column| ((row * 7 + column * 13) as f64).sin());
            let mut reduction = Reduction::new(4);
            for k in 0..count {
                reduction.push(row(k));
                assert!(reduction.rows.len() < 4 * MOST_HELD);
            }
            let all = DMatrix::from_row_iterator(count, 4, (0..count).flat_map(row));
            let (factor, expected) = (reduction.finish(), squares(&all, &x));
            assert_eq!(factor.rows(), count);
            assert!((factor.squares(&x) - expected).abs() <= 1e-12 * expected, "{count}");
        }
    }

    #[test]
    fn the_solution_is_optimal_on_both_sides_of_the_bound() {
        let factor = Factor::of(rows());
        let penalty = DMatrix::identity(3, 3) * 0.1;
        let prior = DVector::from_vec(vec![0.0, -1.0, 0.5]);
        let pulled = |x: &[f64]| x.iter().zip(&prior).map(|(x, p)| (x - p).powi(2)).sum::<f64>();
        let cost = |x: &[f64]| factor.squares(x) + 0.1 * pulled(x);
        let x = factor.solve(&penalty, &prior, 1).unwrap();
        assert!(x[1..].iter().all(|x| *x >= 0.0) && x[1..].contains(&0.0), "{x:?}");
        for k in 0..3 {
            for step in [-1e-3, 1e-3] {
                let mut other = x.clone();
                other[k] += step;
                assert!(cost(&other) > cost(&x) || (k > 0 && other[k] < 0.0), "{k} {step}");
            }
        }
    }

    /// The covariance times A'A + Q is the identity over the free unknowns; of what nothing tells there is none.
    #[test]
    fn a_covariance_is_that_of_the_free_unknowns() {
        let (rows, penalty) = (rows(), DMatrix::identity(3, 3) * 0.1);
        let a = rows.columns(0, 3);
        let squares = (a.transpose() * a + &penalty).select_rows(&[0, 2]).select_columns(&[0, 2]);
        let factor = Factor::of(rows.clone());
        let found = factor.covariance(&penalty, &[0, 2]).unwrap();
        assert!(found.row(1).iter().chain(found.column(1).iter()).all(|entry| *entry == 0.0));
        let product = found.select_rows(&[0, 2]).select_columns(&[0, 2]) * squares;
        assert!((product - DMatrix::identity(2, 2)).amax() < 1e-12);
        let untold = Factor::of(DMatrix::zeros(5, 4));
        assert_eq!(untold.covariance(&DMatrix::zeros(3, 3), &[0]), None);
    }

    #[test]
    fn a_solution_inside_the_bounds_is_that_of_the_rows() {
        let truth = [-1.5, 0.0, 2.0];
        let mut rows = rows();
        for r in 0..rows.nrows() {
            rows[(r, 3)] = (0..3).map(|k| rows[(r, k)] * truth[k]).sum();
        }
        let x = Factor::of(rows).solve(&DMatrix::zeros(3, 3), &DVector::zeros(3), 1).unwrap();
        x.iter().zip(truth).for_each(|(found, expected)| assert!((found - expected).abs() < 1e-5, "{x:?}"));
    }
}
