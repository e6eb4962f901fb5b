//! Weights of a gear from measured logs: torque over torsion.
//!
//! ```text
//! tau = line(phi/s) + tau_hyst[phi]          phi = theta_measured - c,    theta_measured = r*theta_motor - theta_out
//! min   sum of (theta_measured - c - phi(tau; s, mu))^2/N + lambda*|D mu|^2      mu >= 0
//! ```
//!
//! The torque tau (N m) drives, the torsion phi (rad) is what is predicted: by the inverse of the gear's own
//! operator, torque over torsion. The torque regressed on the measured torsion would be simpler, but there
//! the encoders' noise, and all that the torsion does without the torque having been measured, would be
//! reversals of the operator's input. Identified are one factor 1/s on K1, K2 and K3 of the base gear's line (its knee
//! torques stay), for each log its start ([`Start`]), and the weights mu. The line comes first (`line.rs`); the weights are
//! identified only where the torque of a log goes both ways (`gear_log.rs`), else those of the base gear stay.
//!
//! The torsion is not linear in them, so Gauss and Newton's steps: at the present phi, with kappa = dtau/dphi along
//! the branch, the torsion of other parameters is
//!
//! ```text
//! phi + (tau - line(phi/s') - sum mu'_p x_p[phi])/kappa
//! ```
//!
//! linear in mu' and, around s, in s'. The least squares of that give the next parameters, until the
//! prediction no longer moves; no step leads to a gear that its file's own check refuses. The start states are renewed between.
//!
//! The joint is held: the kinematic error is part of c. A log's first part trains, the rest is predicted.

mod covariance;

use std::iter::repeat_n;
use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use strainwave::hysteresis::table::TABLE_LEVELS;
use strainwave::hysteresis::{TorsionHysteresis, TorsionHysteresisState};

use super::choice::{Preference, Problem, Smoothing};
use super::covariance::Covariance;
use super::gear_log::GearLog;
use super::identified_gear::{IdentifiedGear, IdentifiedTable};
use super::law::{Law, OnLaw};
use super::least_squares::Factor;
use super::line::{LIMITS, Line};
use super::regressors::{pairs, regressors, weights_of};
use super::sequence::{BLOCKS, blocks, rms, span};
use super::smoothness::{penalty_to_prior, unit_density};
use super::start::Start;
use super::{Error, Excitation};
use crate::design::joint::gear_params;
use crate::io::gear_file::{GearFile, Hysteresis};
use crate::plant::MEMORY;

/// Grids that may be chosen: the gear's table holds each without loss.
pub const LEVELS: [usize; 4] = [6, 8, 12, 24];
/// Most of Gauss and Newton's steps.
const STEPS: usize = 30;
/// The lambda with which offsets and stiffness are found before the weights: the prior's stay.
const PRIOR_ALONE: f64 = 1e3;
/// Most times that the start states are renewed.
const RENEWALS: usize = 4;
/// Halvings of a step that does not lead downhill, or to a gear that is refused.
const HALVINGS: i32 = 8;
/// The steps end when the cost falls by less than this fraction.
const SETTLED: f64 = 1e-6;

/// Name of the factor on the stiffness in the covariance.
pub const STIFFNESS: &str = "stiffness factor";
/// Name of the sum of the weights there (N m).
pub const TOTAL: &str = "sum of the weights";

/// Name of a log's offset in the covariance (rad); logs count from 0.
pub fn offset_name(log: usize) -> String {
    format!("offset of log {}", log + 1)
}

/// Options of the identification.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GearOptions {
    /// Fraction of each log, from its start, that trains; the rest is predicted. 0.2..=1.
    pub training: f64,
    /// One of [`LEVELS`]; chosen by cross-validation when there is none.
    pub levels: Option<usize>,
    /// The smoothness.
    pub smoothing: Smoothing,
}

impl Default for GearOptions {
    fn default() -> Self {
        Self { training: 0.5, levels: None, smoothing: Smoothing::Chosen }
    }
}

/// Identifies a gear's hysteresis, and a factor on its stiffness line; `progress` is called with the fraction done.
///
/// # Errors
/// [`Error`] when a log is too short, not finite or never reverses, or an option is out of range.
pub fn identify_gear(
    base: &GearFile,
    logs: &[GearLog],
    options: &GearOptions,
    mut progress: impl FnMut(f64),
) -> Result<IdentifiedGear, Error> {
    let grids: Vec<_> =
        LEVELS.into_iter().filter(|grid| options.levels.is_none_or(|chosen| chosen == *grid)).collect();
    if grids.is_empty() {
        return Err(strainwave::Error::OutOfRange("levels").into());
    }
    let job = Job::of(base, logs, options)?;
    if !job.loops() {
        return job.line_alone();
    }
    let mut best: Option<(f64, IdentifiedGear)> = None;
    for (done, levels) in grids.iter().enumerate() {
        progress(done as f64 / grids.len() as f64);
        let (validation, found) = match levels {
            6 => Task::<6>::of(&job)?.run(),
            8 => Task::<8>::of(&job)?.run(),
            12 => Task::<12>::of(&job)?.run(),
            _ => Task::<24>::of(&job)?.run(),
        }?;
        if best.as_ref().is_none_or(|(least, _)| validation < *least) {
            best = Some((validation, found));
        }
    }
    best.map_or_else(|| job.line_alone(), |(_, found)| Ok(found))
}

/// What is identified from, and the line that it gives.
struct Job<'a> {
    base: &'a GearFile,
    logs: &'a [GearLog],
    options: &'a GearOptions,
    /// Samples of each log that train.
    training: Vec<usize>,
    line: Line,
}

impl<'a> Job<'a> {
    fn of(base: &'a GearFile, logs: &'a [GearLog], options: &'a GearOptions) -> Result<Self, Error> {
        if !(0.2..=1.0).contains(&options.training) {
            return Err(strainwave::Error::OutOfRange("training").into());
        }
        let training =
            logs.iter().map(|log| log.training(options.training)).collect::<Result<Vec<_>, Error>>()?;
        let line = Line::identify(base, logs, &training)?;
        Ok(Self { base, logs, options, training, line })
    }

    /// The torque of a log goes both ways.
    fn loops(&self) -> bool {
        self.logs.iter().zip(&self.training).any(|(log, count)| log.loops(*count))
    }

    /// The base gear with the factor on its line.
    fn line_alone(&self) -> Result<IdentifiedGear, Error> {
        let mut law = Law::<TABLE_LEVELS>::of(&gear_params(self.base))?;
        law.factor = self.line.factor;
        let mut gear = self.base.clone();
        soften(&mut gear, self.line.factor);
        let predicted = self.predicted(&law, &self.line.starts);
        let deviation = self.line.deviation / self.line.factor.powi(2);
        let covariance = Covariance::of_one(STIFFNESS, deviation);
        self.result(gear, self.line.factor, self.line.starts.clone(), None, predicted, covariance)
    }

    fn result(
        &self,
        gear: GearFile,
        factor: f64,
        starts: Vec<Start>,
        table: Option<IdentifiedTable>,
        predicted: Vec<Vec<f64>>,
        covariance: Covariance,
    ) -> Result<IdentifiedGear, Error> {
        let base_predicted = self.base_predictions()?;
        Ok(IdentifiedGear {
            gear,
            stiffness_factor: 1.0 / factor,
            stiffness_deviation: self.line.deviation / self.line.factor,
            starts,
            table,
            training_rms: self.residual(&predicted, |count, _| 0..count).unwrap_or(f64::NAN),
            held_out_rms: self.residual(&predicted, |count, all| count..all),
            base_held_out_rms: self.residual(&base_predicted, |count, all| count..all),
            predicted,
            base_predicted,
            training: self.training.clone(),
            covariance,
        })
    }

    /// The starts that the trained part of each log fits best.
    fn starts<const L: usize>(&self, law: &Law<L>) -> Vec<Start> {
        let logs = self.logs.iter().zip(&self.training);
        logs.map(|(log, count)| Start::of(law, log, *count, self.base.gear.rated_torque)).collect()
    }

    /// c + phi of each log.
    fn predicted<const L: usize>(&self, law: &Law<L>, starts: &[Start]) -> Vec<Vec<f64>> {
        let predict = |(log, start): (&GearLog, &Start)| {
            start.predicted(&law.torsions_after(start.extreme_torque, &log.torque))
        };
        self.logs.iter().zip(starts).map(predict).collect()
    }

    /// Torsions of the base gear.
    fn base_predictions(&self) -> Result<Vec<Vec<f64>>, Error> {
        let law = Law::<TABLE_LEVELS>::of(&gear_params(self.base))?;
        Ok(self.predicted(&law, &self.starts(&law)))
    }

    /// Rms residual of some samples of each log, of its trained and all.
    fn residual(
        &self,
        predicted: &[Vec<f64>],
        samples: impl Fn(usize, usize) -> Range<usize>,
    ) -> Option<f64> {
        let logs = self.logs.iter().zip(predicted).zip(&self.training);
        let residual: Vec<_> = logs
            .flat_map(|((log, predicted), count)| {
                samples(*count, predicted.len()).map(|k| log.torsion[k] - predicted[k])
            })
            .collect();
        rms(&residual)
    }
}

/// Divides the stiffness line by `factor`.
fn soften(gear: &mut GearFile, factor: f64) {
    for stiffness in [&mut gear.stiffness.k1, &mut gear.stiffness.k2, &mut gear.stiffness.k3] {
        *stiffness /= factor;
    }
}

/// One identification on a grid.
struct Task<'a, const L: usize> {
    job: &'a Job<'a>,
    half_range: f64,
    /// Span of the trained torsions (rad).
    span: f64,
    /// mu of each pair at density 1, the rated torque being the total (N m).
    unit: Vec<f64>,
    /// Offsets of the logs, s, densities.
    problem: Problem,
}

/// Parameters of one step.
#[derive(Clone, Debug, PartialEq)]
struct Parameters {
    starts: Vec<Start>,
    /// s
    factor: f64,
    /// mu of each pair (N m).
    weights: Vec<f64>,
}

impl Parameters {
    /// A fraction of the way to `target`; weights stay within their bounds, start states as they are.
    fn towards(&self, target: &Self, fraction: f64) -> Self {
        let blend = |a: f64, b: f64| a + fraction * (b - a);
        let start = |(a, b): (&Start, &Start)| Start { offset: blend(a.offset, b.offset), ..*a };
        Self {
            starts: self.starts.iter().zip(&target.starts).map(start).collect(),
            factor: blend(self.factor, target.factor),
            weights: self.weights.iter().zip(&target.weights).map(|(a, b)| blend(*a, *b)).collect(),
        }
    }
}

impl<'a, const L: usize> Task<'a, L> {
    fn of(job: &'a Job) -> Result<Self, Error> {
        let params = gear_params::<f64>(job.base);
        let (half_range, prior) = params.hysteresis_weights::<L>()?;
        let unit: Vec<_> = pairs::<L>().map(|pair| unit_density::<L>(pair) * params.rated_torque).collect();
        let prior: Vec<_> = pairs::<L>().zip(&unit).map(|((i, j), unit)| prior.at(i, j) / unit).collect();
        let logs = job.logs.len();
        let spans = job.logs.iter().zip(&job.training).map(|(log, training)| span(&log.torsion[..*training]));
        Ok(Self {
            job,
            half_range,
            span: spans.fold(0.0, f64::max),
            // s cannot be negative either.
            problem: Problem { bounded: logs, ..Problem::new(logs + 1, &penalty_to_prior::<L>(), &prior) },
            unit,
        })
    }

    /// With the mean square over the pieces that the cross-validation left out, in spans.
    fn run(&self) -> Result<(f64, IdentifiedGear), Error> {
        let prior = self.problem.prior.iter().skip(self.job.logs.len() + 1);
        let prior = Parameters {
            starts: self.job.line.starts.clone(),
            factor: self.job.line.factor,
            weights: prior.zip(&self.unit).map(|(density, unit)| density * unit).collect(),
        };
        let line = self.settle(prior, PRIOR_ALONE)?;
        let (smoothing, validation) =
            self.problem.choose(&self.pieces(&line)?, self.job.options.smoothing, Preference::Smoothest)?;
        let found = self.renew_starts(self.settle(line, smoothing)?, smoothing)?;
        let validation_rms = validation.sqrt() * self.span;
        Ok((validation, self.finish(found, smoothing, validation_rms)?))
    }

    /// Start states of these parameters, and the parameters for those, until they stay.
    fn renew_starts(&self, mut now: Parameters, smoothing: f64) -> Result<Parameters, Error> {
        for _ in 0..RENEWALS {
            let renewed = Parameters { starts: self.job.starts(&self.law(&now)?), ..now.clone() };
            if self.cost(&renewed, smoothing)? >= self.cost(&now, smoothing)? * (1.0 - SETTLED) {
                break;
            }
            now = self.settle(renewed, smoothing)?;
        }
        Ok(now)
    }

    /// Steps downhill until none leads further.
    fn settle(&self, mut now: Parameters, smoothing: f64) -> Result<Parameters, Error> {
        for _ in 0..STEPS {
            let rows = Factor::joined(self.pieces(&now)?.iter());
            let target = self.target(&now, &self.problem.solve(&rows, smoothing)?);
            let next = self.downhill(&now, &target, smoothing)?;
            if next == now {
                break;
            }
            now = next;
        }
        Ok(now)
    }

    /// From `now` towards `target`, as far as the cost falls; `now` when it does not.
    fn downhill(&self, now: &Parameters, target: &Parameters, smoothing: f64) -> Result<Parameters, Error> {
        let cost = self.cost(now, smoothing)?;
        for halvings in 0..HALVINGS {
            let next = now.towards(target, 0.5f64.powi(halvings));
            let falls = self.cost(&next, smoothing)? < cost * (1.0 - SETTLED);
            if falls && self.gear(&next)?.check().is_ok() {
                return Ok(next);
            }
        }
        Ok(now.clone())
    }

    /// Cost to be minimised, beside the torsions' error.
    fn cost(&self, parameters: &Parameters, smoothing: f64) -> Result<f64, Error> {
        let densities = parameters.weights.iter().zip(&self.unit).map(|(mu, unit)| mu / unit);
        let free = self.job.logs.len() + 1;
        let x = DVector::from_iterator(self.problem.prior.len(), repeat_n(0.0, free).chain(densities));
        let difference = x - &self.problem.prior;
        let penalty = difference.dot(&(&self.problem.penalty * &difference));
        let predicted = self.job.predicted(&self.law(parameters)?, &parameters.starts);
        let residual = self.job.residual(&predicted, |count, _| 0..count).unwrap_or(f64::NAN);
        Ok((residual / self.span).powi(2) + smoothing * penalty)
    }

    fn law(&self, parameters: &Parameters) -> Result<Law<L>, Error> {
        let line = gear_params::<f64>(self.job.base).flexspline.line.build()?;
        let weights = weights_of(&parameters.weights, false)?;
        Ok(Law::build(line, parameters.factor, self.half_range, &weights)?)
    }

    /// Each log's torsions for its torques, behind that of the extreme torque that it came from.
    fn torsions(&self, parameters: &Parameters) -> Result<Vec<Vec<OnLaw>>, Error> {
        let law = self.law(parameters)?;
        let torsions = |(log, start): (&GearLog, &Start)| {
            law.torsions(&[&[start.extreme_torque], log.torque.as_slice()].concat())
        };
        Ok(self.job.logs.iter().zip(&parameters.starts).map(torsions).collect())
    }

    /// The linear problem around some parameters, piece by piece of time.
    fn pieces(&self, now: &Parameters) -> Result<Vec<Factor>, Error> {
        let mut pieces: Vec<Vec<Factor>> = vec![Vec::new(); BLOCKS];
        for (index, points) in self.torsions(now)?.iter().enumerate() {
            let rows = self.rows(now, index, points)?;
            for (piece, factor) in pieces.iter_mut().zip(blocks(&rows, 0..self.job.training[index])) {
                piece.push(factor);
            }
        }
        Ok(pieces.iter().map(|piece| Factor::joined(piece.iter())).collect())
    }

    /// The parameters in a solution.
    fn target(&self, now: &Parameters, x: &[f64]) -> Parameters {
        let (logs, [least, most]) = (self.job.logs.len(), LIMITS);
        let start = |(start, x): (&Start, &f64)| Start { offset: x * self.span, ..*start };
        Parameters {
            starts: now.starts.iter().zip(x).map(start).collect(),
            // A step that halves or doubles the stiffness goes too far for what is linear around here.
            factor: x[logs].clamp(0.5 * now.factor, 2.0 * now.factor).clamp(least, most),
            weights: x[logs + 1..].iter().zip(&self.unit).map(|(x, unit)| x * unit).collect(),
        }
    }

    /// Rows [offsets, s, densities | torsion], of spans, linear around the present torsions of a log.
    fn rows(&self, now: &Parameters, index: usize, points: &[OnLaw]) -> Result<DMatrix<f64>, Error> {
        let inputs: Vec<_> = points.iter().map(|point| point.torsion).collect();
        let columns = regressors::<L, _>(&inputs, |unit| {
            let model = TorsionHysteresis::<f64, L, MEMORY>::from_weights(self.half_range, unit)?;
            let mut state = TorsionHysteresisState::default();
            Ok(move |torsion| model.step(&mut state, torsion).torque)
        })?;
        let (logs, measured) = (self.job.logs.len(), &self.job.logs[index].torsion);
        Ok(DMatrix::from_fn(measured.len(), logs + 2 + self.unit.len(), |row, column| {
            let point = &points[row + 1];
            let by_factor = point.line_stiffness * point.torsion / point.stiffness;
            match column.checked_sub(logs) {
                None => f64::from(column == index),
                Some(0) => by_factor / now.factor / self.span,
                Some(pair) if pair <= self.unit.len() => {
                    -columns[(row + 1, pair - 1)] * self.unit[pair - 1] / point.stiffness / self.span
                }
                Some(_) => {
                    (measured[row] - point.torsion - point.hysteresis / point.stiffness + by_factor)
                        / self.span
                }
            }
        }))
    }

    fn finish(
        &self,
        found: Parameters,
        smoothing: f64,
        validation_rms: f64,
    ) -> Result<IdentifiedGear, Error> {
        let excitation = self.excitation(&self.torsions(&found)?)?;
        let table = IdentifiedTable { levels: L, smoothing, validation_rms, excitation };
        let predicted = self.job.predicted(&self.law(&found)?, &found.starts);
        let covariance = self.covariance(&found, smoothing)?;
        self.job.result(self.gear(&found)?, found.factor, found.starts, Some(table), predicted, covariance)
    }

    /// Cells that the trained part of any log moved.
    fn excitation(&self, torsions: &[Vec<OnLaw>]) -> Result<Excitation, Error> {
        let mut whole = Excitation::none(L);
        for (points, count) in torsions.iter().zip(&self.job.training) {
            let inputs: Vec<_> = points[1..=*count].iter().map(|point| point.torsion).collect();
            whole.add(&Excitation::of::<L>(self.half_range, &inputs)?);
        }
        Ok(whole)
    }

    /// The base gear with what was found.
    fn gear(&self, found: &Parameters) -> Result<GearFile, Error> {
        let weights = weights_of::<L>(&found.weights, false)?;
        let rows = (0..L).map(|i| (0..=i).map(|j| weights.at(i, j)).collect()).collect();
        let mut gear = self.job.base.clone();
        soften(&mut gear, found.factor);
        gear.hysteresis = Hysteresis {
            width_arcmin: self.law(found)?.width(gear.gear.rated_torque).to_degrees() * 60.0,
            half_range: Some(self.half_range),
            weights: Some(rows),
        };
        Ok(gear)
    }
}
