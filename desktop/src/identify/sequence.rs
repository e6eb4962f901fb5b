//! Weights of any actuator from a recorded input and output, such as reversal curves or loops.
//!
//! The sequence starts demagnetised: an actuator that was not is first led to an end of its range, in the
//! record. Samples count alike; a log whose time stamps jitter is resampled before.

use std::ops::Range;

use nalgebra::DMatrix;
use strainwave::hysteresis::{Staircase, StaircaseState, Weights};

pub(super) use super::choice::BLOCKS;
use super::choice::{Preference, Problem, Smoothing};
use super::least_squares::Factor;
use super::regressors::{pairs, regressors, weights_of};
use super::reversal::reversals;
use super::smoothness::{penalty, unit_density};
use super::{Error, Excitation};
use crate::plant::MEMORY;

/// Fewest samples that train.
pub(super) const LEAST_SAMPLES: usize = 50;
/// Fraction of the input's span that it must turn back by to have reversed.
pub(super) const REVERSAL: f64 = 0.01;

/// A recorded input and output.
#[derive(Clone, Copy, Debug)]
pub struct Sequence<'a> {
    /// u, in its unit.
    pub input: &'a [f64],
    /// y, in its unit.
    pub output: &'a [f64],
}

/// Options of the identification.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// U: the grid covers inputs of +-U.
    pub half_range: f64,
    /// Fraction of the samples, from the first on, that train; the rest is predicted. 0.2..=1.
    pub training: f64,
    /// The smoothness.
    pub smoothing: Smoothing,
    /// An offset of the output is identified too.
    pub offset: bool,
    /// Weights may be negative.
    pub signed: bool,
}

impl Options {
    /// Over +-`half_range`: half of the samples train, no offset, weights are not negative.
    pub fn new(half_range: f64) -> Self {
        Self { half_range, training: 0.5, smoothing: Smoothing::Chosen, offset: false, signed: false }
    }
}

/// Identified weights, with their prediction errors.
#[derive(Clone, Debug, PartialEq)]
pub struct Identified<const L: usize> {
    /// mu, in the unit of the output.
    pub weights: Weights<f64, L>,
    /// Offset of the output against the operator's.
    pub offset: f64,
    /// lambda.
    pub smoothing: f64,
    /// Rms residual of the trained samples.
    pub training_rms: f64,
    /// The same of the samples held out; `None` without any.
    pub held_out_rms: Option<f64>,
    /// Which cells the trained samples moved.
    pub excitation: Excitation,
    /// offset + sum mu_p x_p at every sample.
    pub predicted: Vec<f64>,
}

/// Identifies the weights on a grid of `L` levels.
///
/// # Errors
/// [`Error`] when the sequence is too short, not finite or never reverses, or an option is out of range.
pub fn identify<const L: usize>(sequence: Sequence, options: &Options) -> Result<Identified<L>, Error> {
    let Sequence { input, output } = sequence;
    let training = check(sequence, options)?;
    let columns = regressors::<L, _>(input, |unit| operator::<L>(options.half_range, unit))?;
    let span = span(output).max(f64::MIN_POSITIVE);
    let affine = usize::from(options.offset);
    let densities: Vec<_> = pairs::<L>().map(unit_density::<L>).collect();
    let rows = DMatrix::from_fn(input.len(), affine + densities.len() + 1, |row, column| {
        match column.checked_sub(affine) {
            None => 1.0,
            Some(pair) if pair < densities.len() => columns[(row, pair)] * densities[pair],
            Some(_) => output[row] / span,
        }
    });
    let mut problem = Problem::new(affine, &penalty::<L>(), &vec![0.0; densities.len()]);
    if options.signed {
        problem.bounded = affine + densities.len();
    }
    let blocks = blocks(&rows, 0..training);
    let (smoothing, _) = problem.choose(&blocks, options.smoothing, Preference::Smoothest)?;
    let x = problem.solve(&Factor::joined(blocks.iter()), smoothing)?;
    let values: Vec<_> = x[affine..].iter().zip(&densities).map(|(x, unit)| x * unit * span).collect();
    let offset = x[..affine].iter().sum::<f64>() * span;
    let predicted: Vec<_> = columns
        .row_iter()
        .map(|row| offset + row.iter().zip(&values).map(|(x, mu)| x * mu).sum::<f64>())
        .collect();
    let residual: Vec<_> = output.iter().zip(&predicted).map(|(y, predicted)| y - predicted).collect();
    Ok(Identified {
        weights: weights_of(&values, options.signed)?,
        offset,
        smoothing,
        training_rms: rms(&residual[..training]).unwrap_or(f64::NAN),
        held_out_rms: rms(&residual[training..]),
        excitation: Excitation::of::<L>(options.half_range, &input[..training])?,
        predicted,
    })
}

/// The number of samples that train.
fn check(Sequence { input, output }: Sequence, options: &Options) -> Result<usize, Error> {
    require_finite(input, output)?;
    if !(0.2..=1.0).contains(&options.training) {
        return Err(strainwave::Error::OutOfRange("training").into());
    }
    let training = (input.len() as f64 * options.training) as usize;
    if training < LEAST_SAMPLES {
        let least = (LEAST_SAMPLES as f64 / options.training).ceil() as usize;
        return Err(Error::TooShort { samples: input.len(), least });
    }
    require_reversal("input", &input[..training])?;
    Ok(training)
}

/// Refuses what is not finite or not of one log.
pub(super) fn require_finite(input: &[f64], output: &[f64]) -> Result<(), Error> {
    if input.len() != output.len() {
        return Err(Error::Lengths { inputs: input.len(), outputs: output.len() });
    }
    let is_finite = |(u, y): (&f64, &f64)| u.is_finite() && y.is_finite();
    let fault = input.iter().zip(output).position(|pair| !is_finite(pair));
    fault.map_or(Ok(()), |sample| Err(Error::NotFinite { sample }))
}

pub(super) fn require_reversal(name: &'static str, input: &[f64]) -> Result<(), Error> {
    let span = span(input);
    if span > 0.0 && reversals(input, REVERSAL * span) > 0 {
        return Ok(());
    }
    Err(Error::NeverReverses { input: name, fraction: REVERSAL, span })
}

pub(super) fn span(values: &[f64]) -> f64 {
    let (least, most) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
    most - least
}

/// `None` of nothing.
pub(super) fn rms(values: &[f64]) -> Option<f64> {
    let mean_square = values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64;
    (!values.is_empty()).then_some(mean_square.sqrt())
}

/// The rows of some samples, reduced piece by piece of time.
pub(super) fn blocks(rows: &DMatrix<f64>, samples: Range<usize>) -> Vec<Factor> {
    pieces_of_time(samples).map(|piece| Factor::of(rows.rows(piece.start, piece.len()).into())).collect()
}

/// Samples of each piece of time.
pub(super) fn pieces_of_time(samples: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    let edge = move |k: usize| samples.start + samples.len() * k / BLOCKS;
    (0..BLOCKS).map(move |k| edge(k)..edge(k + 1))
}

fn operator<const L: usize>(
    half_range: f64,
    weights: &Weights<f64, L>,
) -> Result<impl FnMut(f64) -> f64 + use<L>, strainwave::Error> {
    let model = Staircase::<f64, L, MEMORY>::build(half_range, weights)?;
    let mut state = StaircaseState::default();
    Ok(move |input| model.step(&mut state, input).output)
}
