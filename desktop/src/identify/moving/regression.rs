//! What a moving joint's log shows of the torsion, by regression of the measured output.
//!
//! ```text
//! theta_out - r*theta_motor = c + e(theta_motor) - s*phi + E(r*theta_motor) + n
//! ```
//!
//! Unknowns, priors and noise are those of [`super::residual`], and beside them the factor s = 1 +- [`TORSION`] on the torsion phi
//! that the observer finds from the motor side. No gear file has a place for s: it changes from log to log of one joint, as the load's
//! inertia does, and a joint with another load would be predicted worse by it. It bounds what one with a better torsion could
//! predict.

use nalgebra::DMatrix;

use super::super::Error;
use super::EVERY;
use super::residual::{Problem, TORSION, columns, revolutions, solved};
use crate::identify::replay::ReplayRow;
use crate::io::gear_file::GearFile;

/// The regression of some rows.
pub(crate) struct Regression {
    problem: Problem,
    /// Unknowns, in units of their priors.
    x: Vec<f64>,
    /// Standard error of s.
    pub deviation: f64,
}

impl Regression {
    /// Of rows that the observer of a gear with an ideal mesh was fed with.
    pub fn of(gear: &GearFile, rows: &[ReplayRow]) -> Result<Self, Error> {
        let rows: Vec<_> = rows.iter().step_by(EVERY).copied().collect();
        let problem = Problem { columns: columns(gear, revolutions(&rows)), torsion: true };
        let (factor, x) = solved(&problem.equations(&rows), &rows)?;
        let last = problem.unknowns() - 1;
        let covariance =
            factor.covariance(&DMatrix::identity(last + 1, last + 1), &(0..=last).collect::<Vec<_>>());
        let deviation = covariance.map_or(f64::NAN, |covariance| TORSION * covariance[(last, last)].sqrt());
        Ok(Self { problem, x: x.as_slice().to_vec(), deviation })
    }

    /// s
    pub fn torsion(&self) -> f64 {
        1.0 - TORSION * self.x[self.x.len() - 1]
    }

    /// Rows with what it predicts.
    pub fn predicted(&self, rows: &[ReplayRow]) -> Vec<ReplayRow> {
        let equations = self.problem.equations(rows);
        let sum = |row: usize| self.x.iter().enumerate().map(|(k, x)| x * equations[(row, k)]).sum::<f64>();
        let predicted =
            |(k, row): (usize, &ReplayRow)| ReplayRow { predicted: row.predicted + sum(k), ..*row };
        rows.iter().enumerate().map(predicted).collect()
    }
}
