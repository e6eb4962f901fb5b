//! The weight of the smoothness: by cross-validation, on nothing but the samples that train.
//!
//! The training samples are cut into [`BLOCKS`] pieces of time; each is left out once, predicted by what the
//! others give, and the mean square of what it misses by counts. The history of the input runs through all
//! of them: left out are samples of the output. Of the factors lambda whose mean square is within one
//! standard error of the least, the largest is taken (T. Hastie, R. Tibshirani, J. Friedman, "The elements of
//! statistical learning", 2009, section 7.10): the smoothest table that the log does not speak against.

use nalgebra::DMatrix;

use super::Error;
use super::least_squares::Factor;

/// Pieces of the training samples.
pub(super) const BLOCKS: usize = 5;
/// Decades of lambda, the output's span and the total of the standard shape being 1.
const DECADES: std::ops::RangeInclusive<i32> = -14..=0;

/// How lambda is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Smoothing {
    /// By cross-validation.
    Chosen,
    /// This factor.
    Given(f64),
}

/// A solution and what it was chosen by.
#[derive(Clone, Debug)]
pub(super) struct Choice {
    /// Affine part, then densities.
    pub x: Vec<f64>,
    pub smoothing: f64,
    /// Mean square over the pieces left out.
    pub validation: f64,
}

/// Solves the rows of all `blocks`: `affine` unknowns of either sign, then densities, `signed` too when asked for.
pub(super) fn choose(
    blocks: &[Factor],
    affine: usize,
    penalty: &DMatrix<f64>,
    smoothing: Smoothing,
    signed: bool,
) -> Result<Choice, Error> {
    let problem = Problem { penalty: beside(affine, penalty), bounded: affine, signed };
    let (smoothing, validation) = match smoothing {
        Smoothing::Given(smoothing) => (smoothing, mean(&problem.validate(blocks, smoothing)?)),
        Smoothing::Chosen => problem.best(blocks)?,
    };
    let x = problem.solve(&Factor::joined(blocks.iter()), smoothing)?;
    Ok(Choice { x, smoothing, validation })
}

/// The penalty of densities as that of all unknowns.
fn beside(affine: usize, penalty: &DMatrix<f64>) -> DMatrix<f64> {
    let size = affine + penalty.nrows();
    let mut whole = DMatrix::zeros(size, size);
    whole.view_mut((affine, affine), penalty.shape()).copy_from(penalty);
    whole
}

struct Problem {
    penalty: DMatrix<f64>,
    bounded: usize,
    signed: bool,
}

impl Problem {
    fn solve(&self, rows: &Factor, smoothing: f64) -> Result<Vec<f64>, Error> {
        let bounded = if self.signed { self.penalty.nrows() } else { self.bounded };
        rows.solve(&(&self.penalty * (smoothing * rows.rows() as f64)), bounded)
    }

    fn best(&self, blocks: &[Factor]) -> Result<(f64, f64), Error> {
        let mut tried = Vec::new();
        for decade in DECADES {
            let smoothing = 10f64.powi(decade);
            tried.push((smoothing, self.validate(blocks, smoothing)?));
        }
        let least =
            tried.iter().min_by(|a, b| mean(&a.1).total_cmp(&mean(&b.1))).map(|(_, least)| least.clone());
        let least = least.unwrap_or_default();
        let smoothest = tried.iter().rev().find(|(_, missed)| !is_worse(missed, &least));
        let (smoothing, missed) = smoothest.ok_or_else(|| Error::Solver("no finite residual".into()))?;
        Ok((*smoothing, mean(missed)))
    }

    /// Mean square of each piece, left out.
    fn validate(&self, blocks: &[Factor], smoothing: f64) -> Result<Vec<f64>, Error> {
        let missed = |(left_out, block): (usize, &Factor)| {
            let others = blocks.iter().enumerate().filter(|(k, _)| *k != left_out).map(|(_, block)| block);
            let x = self.solve(&Factor::joined(others), smoothing)?;
            Ok(block.squares(&x) / block.rows() as f64)
        };
        blocks.iter().enumerate().map(missed).collect()
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// `missed` exceeds `least` by more than the standard error of the difference.
fn is_worse(missed: &[f64], least: &[f64]) -> bool {
    let differences: Vec<_> = missed.iter().zip(least).map(|(missed, least)| missed - least).collect();
    let (count, mean) = (differences.len() as f64, mean(&differences));
    let spread = differences.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (count - 1.0);
    mean > (spread / count).sqrt()
}
