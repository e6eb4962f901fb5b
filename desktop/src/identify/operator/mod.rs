//! Preisach operator of any actuator from its input and output: asymmetric, after any start.
//!
//! ```text
//! y = c + k*(u - middle) + sum mu_ij x_ij[u] + r[u]
//! min   sum of (y_measured - y)^2/N + lambda*|D mu|^2,     all mu_ij >= 0, or all <= 0, or with `signed` of either sign
//! ```
//!
//! | file | |
//! | --- | --- |
//! | `grid` | the triangle's cells |
//! | `history` | x_ij, the state of each cell along the input |
//! | `model` | the operator itself |
//! | `problem` | the least squares, on one grid with one penalty |
//! | `logs` | logs, which parts of them train, loops to be left out |
//! | `file` | the operator as a TOML file |
//! | `errors` | what is missed, in spans of the output, beside a straight line |
//! | `excitation` | which cells the inputs moved |
//!
//! Start: relays that the log has not switched yet give the rest r, which is not known. It is the same whenever as many of them
//! are left, so r is a function of what is left alone; it is identified with the weights, a function for each log, and ends where the
//! input reaches an end of the range. Of logs that begin at an end of the range nothing is left to identify.
//!
//! lambda, the number of levels and what the penalty prefers (densities even in all directions, or along the diagonal) are chosen by
//! cross-validation within what trains: whole loops are left out where there are enough, else pieces of time.
//!
//! Units: those of input and output. The triangle spans the inputs that train; inputs beyond them move the line alone, as nothing is known
//! of relays there.

mod errors;
mod excitation;
mod file;
mod grid;
mod history;
mod logs;
mod model;
mod problem;

pub use errors::{Errors, Line};
pub use grid::Grid;
pub use model::{LARGEST, LEVELS, Operator, Point};

use self::problem::{Prepared, Solution};
use super::Error;
use super::choice::Smoothing;
use super::sequence::LEAST_SAMPLES;
use crate::io::log::InputOutput;

/// Grids that are tried when none is given.
pub const CHOSEN_LEVELS: [usize; 3] = [8, 12, 16];
/// Grid and smoothness on which the sign of the weights is chosen.
const TRIAL: (usize, f64) = (8, 1e-4);

/// Options of the identification.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OperatorOptions {
    /// Fraction of each log, from its start, that trains; the rest is predicted. 0.2..=1.
    pub training: f64,
    /// Levels of the grid, one of [`LEVELS`]; chosen by cross-validation when there are none.
    pub levels: Option<usize>,
    /// The smoothness.
    pub smoothing: Smoothing,
    /// Weights may have either sign.
    pub signed: bool,
}

impl Default for OperatorOptions {
    fn default() -> Self {
        Self { training: 0.5, levels: None, smoothing: Smoothing::Chosen, signed: false }
    }
}

/// Identified operator, with its errors.
#[derive(Clone, Debug, PartialEq)]
pub struct IdentifiedOperator {
    /// The operator.
    pub operator: Operator,
    /// lambda.
    pub smoothing: f64,
    /// The penalty prefers densities that are even along the diagonal.
    pub along_diagonal: bool,
    /// Rms over what the cross-validation left out, in spans.
    pub validation_rms: f64,
    /// Span of the trained outputs.
    pub span: f64,
    /// Errors of what trained.
    pub training: Errors,
    /// Errors of the rest and of the logs that did not train; `None` without any.
    pub held_out: Option<Errors>,
    /// y along each log, those that trained first.
    pub predicted: Vec<Vec<f64>>,
    /// Rows of each log that trained, from its first; none of those held out.
    pub counts: Vec<usize>,
    /// Straight line through what trained.
    pub line: Line,
    /// Fraction of the cells that what trained moved.
    pub excited: f64,
}

/// Identifies an operator from the first part of each log of `trained`, and predicts the rest of them and the logs `held_out`;
/// `progress` is called with the fraction done.
///
/// # Errors
/// [`Error`] when the logs are too short, one is not finite or never reverses, or an option is out of range.
pub fn identify_operator(
    trained: &[InputOutput],
    held_out: &[InputOutput],
    options: &OperatorOptions,
    mut progress: impl FnMut(f64),
) -> Result<IdentifiedOperator, Error> {
    let counts = trained.iter().map(|log| log.training(options.training)).collect::<Result<Vec<_>, _>>()?;
    let samples = counts.iter().sum();
    if samples < LEAST_SAMPLES {
        return Err(Error::TooShort { samples, least: LEAST_SAMPLES });
    }
    let grids = options.levels.map_or(CHOSEN_LEVELS.to_vec(), |levels| vec![levels]);
    if grids.iter().any(|levels| !LEVELS.contains(levels)) {
        return Err(strainwave::Error::OutOfRange("levels").into());
    }
    let (low, high) = logs::range(trained, &counts);
    let sign = if options.signed {
        None
    } else {
        Some(sign(Grid { low, high, levels: TRIAL.0 }, trained, &counts)?)
    };
    let mut best: Option<Solution> = None;
    for (done, levels) in grids.iter().enumerate() {
        let prepared = Prepared::of(Grid { low, high, levels: *levels }, trained, &counts, sign);
        for along_diagonal in [false, true] {
            let part = 2 * done + usize::from(along_diagonal);
            progress(part as f64 / (2 * grids.len()) as f64);
            let found = prepared.solve(along_diagonal, options.smoothing)?;
            if best.as_ref().is_none_or(|best| found.validation < best.validation) {
                best = Some(found);
            }
        }
    }
    let best = best.ok_or(strainwave::Error::OutOfRange("levels"))?;
    let operator = best.operator.clone();
    let rest = |log: &InputOutput| operator.outputs_from(&log.input, log.output[0]);
    let mut predicted = best.predicted(trained);
    predicted.extend(held_out.iter().map(rest));
    Ok(finish(trained, held_out, &counts, best, predicted))
}

/// Of the weights: 1 or -1, whichever fits better.
fn sign(grid: Grid, trained: &[InputOutput], counts: &[usize]) -> Result<f64, Error> {
    let squares = |sign| {
        let prepared = Prepared::of(grid, trained, counts, Some(sign));
        prepared.solve(false, Smoothing::Given(TRIAL.1)).map(|found| found.squares)
    };
    Ok(if squares(1.0)? <= squares(-1.0)? { 1.0 } else { -1.0 })
}

fn finish(
    trained: &[InputOutput],
    held_out: &[InputOutput],
    counts: &[usize],
    best: Solution,
    predicted: Vec<Vec<f64>>,
) -> IdentifiedOperator {
    let span = logs::output_span(trained, counts);
    let line = Line::of(trained, counts);
    let all = || trained.iter().chain(held_out).zip(&predicted);
    let firsts = || counts.iter().copied().chain(std::iter::repeat(0));
    let training = all().zip(firsts()).map(|((log, y), count)| (log.part(0..count), &y[..count]));
    let rest = all().zip(firsts()).map(|((log, y), count)| (log.part(count..log.input.len()), &y[count..]));
    let (training, held_out) = (Errors::of(training, &line, span), Errors::of(rest, &line, span));
    IdentifiedOperator {
        smoothing: best.smoothing,
        along_diagonal: best.along_diagonal,
        validation_rms: best.validation.sqrt(),
        span,
        training: training.unwrap_or_default(),
        held_out,
        excited: excitation::moved(
            *best.operator.grid(),
            trained.iter().zip(counts).map(|(log, count)| log.part(0..*count).0),
        ),
        counts: firsts().take(predicted.len()).collect(),
        line,
        operator: best.operator,
        predicted,
    }
}
