//! The weight of the smoothness: by cross-validation, on nothing but the samples that train.
//!
//! The training samples are cut into [`BLOCKS`] pieces of time; each is left out once, predicted by what the
//! others give, and the mean square of what it misses by counts. The history of the input runs through all
//! of them: left out are samples of the output. Of the factors lambda whose mean square is within one
//! standard error of the least, the largest is taken (T. Hastie, R. Tibshirani, J. Friedman, "The elements of
//! statistical learning", 2009, section 7.10): the smoothest table that the log does not speak against. Where a smooth table is no
//! better guess than another ([`Preference::Least`]) it is the lambda of the least mean square.

use nalgebra::{DMatrix, DVector};

use super::Error;
use super::least_squares::Factor;

/// Pieces of the training samples.
pub(super) const BLOCKS: usize = 5;
/// Decades of lambda, the output's span and the total of the standard shape being 1.
const DECADES: std::ops::RangeInclusive<i32> = -10..=0;

/// Choice of lambda.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Smoothing {
    /// By cross-validation.
    Chosen,
    /// This factor.
    Given(f64),
}

/// Which of the factors lambda that predict about as well is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Preference {
    /// The largest.
    Smoothest,
    /// That which predicts best.
    Least,
}

/// A least-squares problem: unknowns of either sign up to `bounded`, then densities.
#[derive(Clone, Debug)]
pub(super) struct Problem {
    /// Q, of lambda 1.
    pub penalty: DMatrix<f64>,
    /// Prior of the penalty.
    pub prior: DVector<f64>,
    pub bounded: usize,
}

impl Problem {
    /// The penalty of densities, pulled to `prior`, behind `free` unknowns without one.
    pub fn new(free: usize, penalty: &DMatrix<f64>, prior: &[f64]) -> Self {
        let penalty = penalty.clone().insert_rows(0, free, 0.0).insert_columns(0, free, 0.0);
        let prior =
            DVector::from_fn(free + prior.len(), |k, _| k.checked_sub(free).map_or(0.0, |k| prior[k]));
        Self { penalty, prior, bounded: free }
    }

    /// The unknowns with the factor lambda.
    pub fn solve(&self, rows: &Factor, smoothing: f64) -> Result<Vec<f64>, Error> {
        rows.solve(&(&self.penalty * (smoothing * rows.rows() as f64)), &self.prior, self.bounded)
    }

    /// lambda, and the mean square over the pieces left out.
    pub fn choose(
        &self,
        blocks: &[Factor],
        smoothing: Smoothing,
        preference: Preference,
    ) -> Result<(f64, f64), Error> {
        let decades = match smoothing {
            Smoothing::Given(smoothing) => vec![smoothing],
            Smoothing::Chosen => DECADES.map(|decade| 10f64.powi(decade)).collect(),
        };
        let others: Vec<_> = (0..blocks.len()).map(|left_out| without(blocks, left_out)).collect();
        let mut tried = Vec::new();
        let mut failed = None;
        for smoothing in decades {
            // Too little smoothness can leave a problem that is none.
            match self.validate(blocks, &others, smoothing) {
                Ok(residual) => tried.push((smoothing, residual)),
                Err(error) => failed = Some(error),
            }
        }
        let least =
            tried.iter().min_by(|a, b| mean(&a.1).total_cmp(&mean(&b.1))).map(|(_, least)| least.clone());
        let least = least.unwrap_or_default();
        let is_taken = |residual: &[f64]| match preference {
            Preference::Smoothest => !is_worse(residual, &least),
            Preference::Least => residual == least,
        };
        let taken = tried.iter().rev().find(|(_, residual)| is_taken(residual));
        let (smoothing, residual) =
            taken.ok_or_else(|| failed.unwrap_or(Error::Solver("no finite residual".into())))?;
        Ok((*smoothing, mean(residual)))
    }

    /// Mean square of each piece, as the `others` predict it.
    fn validate(&self, blocks: &[Factor], others: &[Factor], smoothing: f64) -> Result<Vec<f64>, Error> {
        let residual = |(block, others): (&Factor, &Factor)| {
            let x = self.solve(others, smoothing)?;
            Ok(block.squares(&x) / block.rows() as f64)
        };
        blocks.iter().zip(others).map(residual).collect()
    }
}

/// All pieces but one.
fn without(blocks: &[Factor], left_out: usize) -> Factor {
    Factor::joined(blocks.iter().enumerate().filter(|(k, _)| *k != left_out).map(|(_, block)| block))
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// `residual` exceeds `least` by more than the standard error of the difference.
fn is_worse(residual: &[f64], least: &[f64]) -> bool {
    let differences: Vec<_> = residual.iter().zip(least).map(|(residual, least)| residual - least).collect();
    let (count, mean) = (differences.len() as f64, mean(&differences));
    let spread = differences.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (count - 1.0);
    mean > (spread / count).sqrt()
}
