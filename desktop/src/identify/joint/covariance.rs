//! Covariance of what is identified: that of the last linear problem of the torsion, with the noise of `line.rs`.

use nalgebra::DMatrix;

use super::{Parameters, STIFFNESS, TOTAL, Task, offset_name};
use crate::identify::Error;
use crate::identify::covariance::Covariance;
use crate::identify::least_squares::Factor;
use crate::identify::line::weight;
use crate::identify::regressors::pairs;

impl<const L: usize> Task<'_, L> {
    /// Of the factor on the stiffness, the sum of the weights and the offsets.
    pub(super) fn covariance(&self, found: &Parameters, smoothing: f64) -> Result<Covariance, Error> {
        let rows = Factor::joined(self.pieces(found)?.iter());
        let logs = self.job.logs.len();
        let weighing = found.weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0);
        let free: Vec<_> = (0..=logs).chain(weighing.map(|(pair, _)| logs + 1 + pair)).collect();
        let penalty = &self.problem.penalty * (smoothing * rows.rows() as f64);
        let undetermined = || Error::Solver("the parameters are not determined".into());
        let unknowns = rows.covariance(&penalty, &free).ok_or_else(undetermined)? * self.noise().powi(2);
        let cells: Vec<_> =
            pairs::<L>().map(|(i, j)| if i + j + 1 == L { 1.0 } else { 2.0 }).zip(&self.unit).collect();
        let sums = DMatrix::from_fn(logs + 2, unknowns.nrows(), |row, column| match (row, column) {
            (0, column) if column == logs => -found.factor.powi(-2),
            (1, column) if column > logs => cells[column - logs - 1].0 * cells[column - logs - 1].1,
            (row, column) if row >= 2 && column == row - 2 => self.span,
            _ => 0.0,
        });
        let names = [STIFFNESS, TOTAL].map(String::from).into_iter().chain((0..logs).map(offset_name));
        Ok(Covariance::of_sums(names.collect(), &sums, &unknowns))
    }

    /// Standard deviation of a row where rows count as independent, over all logs, in spans.
    fn noise(&self) -> f64 {
        let logs = || self.job.logs.iter().zip(&self.job.training);
        let rows: usize = self.job.training.iter().sum();
        let squares: f64 = logs().map(|(log, count)| *count as f64 / weight(log.interval())).sum();
        (squares / rows as f64).sqrt() / self.span
    }
}
