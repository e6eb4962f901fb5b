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
//! reversals of the operator's input. Identified are the weights mu, one factor 1/s on K1, K2 and K3 of the
//! base gear's line (its knee torques stay), and for each log an offset c, as its angles count from arbitrary zeros.
//!
//! The torsion is not linear in them, so Gauss and Newton's steps: at the present phi, with kappa = dtau/dphi along
//! the branch, the torsion of other parameters is
//!
//! ```text
//! phi + (tau - line(phi/s') - sum mu'_p x_p[phi])/kappa
//! ```
//!
//! linear in mu' and, around s, in s'. The least squares of that give the next parameters, until the
//! prediction no longer moves.
//!
//! Every log starts demagnetised, and the joint is held: the kinematic error is part of c. Its first part trains, the rest is
//! predicted.

use std::iter::repeat_n;
use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use strainwave::hysteresis::table::TABLE_LEVELS;
use strainwave::hysteresis::{TorsionHysteresis, TorsionHysteresisState};

use super::choice::{Problem, Smoothing};
use super::gear_log::GearLog;
use super::law::{Law, OnLaw};
use super::least_squares::Factor;
use super::regressors::{pairs, regressors, weights_of};
use super::sequence::{BLOCKS, blocks, rms, span};
use super::smoothness::{penalty_to_prior, unit_density};
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
/// Halvings of a step that does not lead downhill.
const HALVINGS: i32 = 8;
/// The steps end when the cost falls by less than this fraction.
const SETTLED: f64 = 1e-6;

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

/// Identified gear, with its prediction errors.
#[derive(Clone, Debug, PartialEq)]
pub struct IdentifiedGear {
    /// The base gear with the identified stiffness and hysteresis.
    pub gear: GearFile,
    /// K1, K2, K3 over the base gear's.
    pub stiffness_factor: f64,
    /// c of each log (rad).
    pub offsets: Vec<f64>,
    /// Rows of the table.
    pub levels: usize,
    /// lambda.
    pub smoothing: f64,
    /// Rms over the pieces that the cross-validation left out (rad).
    pub validation_rms: f64,
    /// Rms residual of the trained torsions (rad).
    pub training_rms: f64,
    /// The same of the torsions held out; `None` without any.
    pub held_out_rms: Option<f64>,
    /// Rms error of the base gear on them, its offset fitted to the trained part.
    pub base_held_out_rms: Option<f64>,
    /// Cells that the trained part moved.
    pub excitation: Excitation,
    /// c + phi at every sample of each log (rad).
    pub predicted: Vec<Vec<f64>>,
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
    let mut best: Option<IdentifiedGear> = None;
    for (done, levels) in grids.iter().enumerate() {
        progress(done as f64 / grids.len() as f64);
        let found = match levels {
            6 => Task::<6>::of(base, logs, options)?.run(),
            8 => Task::<8>::of(base, logs, options)?.run(),
            12 => Task::<12>::of(base, logs, options)?.run(),
            _ => Task::<24>::of(base, logs, options)?.run(),
        }?;
        if best.as_ref().is_none_or(|best| found.validation_rms < best.validation_rms) {
            best = Some(found);
        }
    }
    best.ok_or_else(|| strainwave::Error::OutOfRange("levels").into())
}

/// One identification on a grid.
struct Task<'a, const L: usize> {
    base: &'a GearFile,
    logs: &'a [GearLog],
    options: &'a GearOptions,
    half_range: f64,
    /// Samples of each log that train.
    training: Vec<usize>,
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
    offsets: Vec<f64>,
    /// s
    factor: f64,
    /// mu of each pair (N m).
    weights: Vec<f64>,
}

impl Parameters {
    /// A fraction of the way to `target`; weights stay within their bounds.
    fn towards(&self, target: &Self, fraction: f64) -> Self {
        let blend = |a: f64, b: f64| a + fraction * (b - a);
        let blends = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| blend(*a, *b)).collect();
        Self {
            offsets: blends(&self.offsets, &target.offsets),
            factor: blend(self.factor, target.factor),
            weights: blends(&self.weights, &target.weights),
        }
    }
}

impl<'a, const L: usize> Task<'a, L> {
    fn of(base: &'a GearFile, logs: &'a [GearLog], options: &'a GearOptions) -> Result<Self, Error> {
        let params = gear_params::<f64>(base);
        let (half_range, prior) = params.hysteresis_weights::<L>()?;
        let unit: Vec<_> = pairs::<L>().map(|pair| unit_density::<L>(pair) * params.rated_torque).collect();
        let prior: Vec<_> = pairs::<L>().zip(&unit).map(|((i, j), unit)| prior.at(i, j) / unit).collect();
        if !(0.2..=1.0).contains(&options.training) {
            return Err(strainwave::Error::OutOfRange("training").into());
        }
        let training =
            logs.iter().map(|log| log.training(options.training)).collect::<Result<Vec<_>, Error>>()?;
        let spans = logs.iter().zip(&training).map(|(log, training)| span(&log.torsion[..*training]));
        Ok(Self {
            base,
            logs,
            options,
            half_range,
            span: spans.fold(0.0, f64::max),
            training,
            // s cannot be negative either.
            problem: Problem {
                bounded: logs.len(),
                ..Problem::new(logs.len() + 1, &penalty_to_prior::<L>(), &prior)
            },
            unit,
        })
    }

    fn run(&self) -> Result<IdentifiedGear, Error> {
        let prior = self.problem.prior.iter().skip(self.logs.len() + 1);
        let prior = Parameters {
            offsets: vec![0.0; self.logs.len()],
            factor: 1.0,
            weights: prior.zip(&self.unit).map(|(density, unit)| density * unit).collect(),
        };
        let line = self.settle(prior, PRIOR_ALONE)?;
        let (smoothing, validation) = self.problem.choose(&self.pieces(&line)?, self.options.smoothing)?;
        self.finish(self.settle(line, smoothing)?, smoothing, validation)
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
            if self.cost(&next, smoothing)? < cost * (1.0 - SETTLED) {
                return Ok(next);
            }
        }
        Ok(now.clone())
    }

    /// Cost to be minimised, beside the torsions' error.
    fn cost(&self, parameters: &Parameters, smoothing: f64) -> Result<f64, Error> {
        let densities = parameters.weights.iter().zip(&self.unit).map(|(mu, unit)| mu / unit);
        let free = self.logs.len() + 1;
        let x = DVector::from_iterator(self.problem.prior.len(), repeat_n(0.0, free).chain(densities));
        let difference = x - &self.problem.prior;
        let penalty = difference.dot(&(&self.problem.penalty * &difference));
        let predicted = self.predicted(parameters, &self.torsions(parameters)?);
        let residual = self.residual(&predicted, |count, _| 0..count).unwrap_or(f64::NAN);
        Ok((residual / self.span).powi(2) + smoothing * penalty)
    }

    fn law(&self, parameters: &Parameters) -> Result<Law<L>, Error> {
        let line = gear_params::<f64>(self.base).flexspline.line.build()?;
        let weights = weights_of(&parameters.weights, false)?;
        Ok(Law::build(line, parameters.factor, self.half_range, &weights)?)
    }

    /// Each log's torsions for its torques.
    fn torsions(&self, parameters: &Parameters) -> Result<Vec<Vec<OnLaw>>, Error> {
        let law = self.law(parameters)?;
        Ok(self.logs.iter().map(|log| law.torsions(&log.torque)).collect())
    }

    /// The linear problem around some parameters, piece by piece of time.
    fn pieces(&self, now: &Parameters) -> Result<Vec<Factor>, Error> {
        let mut pieces: Vec<Vec<Factor>> = vec![Vec::new(); BLOCKS];
        for (index, points) in self.torsions(now)?.iter().enumerate() {
            let rows = self.rows(now, index, points)?;
            for (piece, factor) in pieces.iter_mut().zip(blocks(&rows, 0..self.training[index])) {
                piece.push(factor);
            }
        }
        Ok(pieces.iter().map(|piece| Factor::joined(piece.iter())).collect())
    }

    /// The parameters in a solution.
    fn target(&self, now: &Parameters, x: &[f64]) -> Parameters {
        let logs = self.logs.len();
        Parameters {
            offsets: x[..logs].iter().map(|x| x * self.span).collect(),
            // A step that halves or doubles the stiffness goes too far for what is linear around here.
            factor: x[logs].clamp(0.5 * now.factor, 2.0 * now.factor),
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
        let (logs, measured) = (self.logs.len(), &self.logs[index].torsion);
        Ok(DMatrix::from_fn(points.len(), logs + 2 + self.unit.len(), |row, column| {
            let point = &points[row];
            let by_factor = point.line_stiffness * point.torsion / point.stiffness;
            match column.checked_sub(logs) {
                None => f64::from(column == index),
                Some(0) => by_factor / now.factor / self.span,
                Some(pair) if pair <= self.unit.len() => {
                    -columns[(row, pair - 1)] * self.unit[pair - 1] / point.stiffness / self.span
                }
                Some(_) => {
                    (measured[row] - point.torsion - point.hysteresis / point.stiffness + by_factor)
                        / self.span
                }
            }
        }))
    }

    fn finish(&self, found: Parameters, smoothing: f64, validation: f64) -> Result<IdentifiedGear, Error> {
        let torsions = self.torsions(&found)?;
        let predicted = self.predicted(&found, &torsions);
        Ok(IdentifiedGear {
            gear: self.gear(&found)?,
            stiffness_factor: 1.0 / found.factor,
            levels: L,
            smoothing,
            validation_rms: validation.sqrt() * self.span,
            training_rms: self.residual(&predicted, |count, _| 0..count).unwrap_or(f64::NAN),
            held_out_rms: self.residual(&predicted, |count, all| count..all),
            base_held_out_rms: self.residual(&self.base_predictions()?, |count, all| count..all),
            excitation: self.excitation(&torsions)?,
            offsets: found.offsets,
            predicted,
        })
    }

    /// c + phi.
    fn predicted(&self, parameters: &Parameters, torsions: &[Vec<OnLaw>]) -> Vec<Vec<f64>> {
        let logs = torsions.iter().zip(&parameters.offsets);
        logs.map(|(points, offset)| points.iter().map(|point| point.torsion + offset).collect()).collect()
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

    /// Torsions of the base gear, with the offset that the trained part of each log has from it.
    fn base_predictions(&self) -> Result<Vec<Vec<f64>>, Error> {
        let law = Law::<TABLE_LEVELS>::of(&gear_params(self.base))?;
        let predict = |(log, count): (&GearLog, &usize)| {
            let torsions = law.torsions(&log.torque);
            let offsets =
                log.torsion[..*count].iter().zip(&torsions).map(|(measured, on)| measured - on.torsion);
            let offset = offsets.sum::<f64>() / *count as f64;
            torsions.iter().map(|on| on.torsion + offset).collect()
        };
        Ok(self.logs.iter().zip(&self.training).map(predict).collect())
    }

    /// Cells that the trained part of any log moved.
    fn excitation(&self, torsions: &[Vec<OnLaw>]) -> Result<Excitation, Error> {
        let mut whole = Excitation::none(L);
        for (points, count) in torsions.iter().zip(&self.training) {
            let inputs: Vec<_> = points[..*count].iter().map(|point| point.torsion).collect();
            whole.add(&Excitation::of::<L>(self.half_range, &inputs)?);
        }
        Ok(whole)
    }

    /// The base gear with what was found.
    fn gear(&self, found: &Parameters) -> Result<GearFile, Error> {
        let weights = weights_of::<L>(&found.weights, false)?;
        let rows = (0..L).map(|i| (0..=i).map(|j| weights.at(i, j)).collect()).collect();
        let mut gear = self.base.clone();
        for stiffness in [&mut gear.stiffness.k1, &mut gear.stiffness.k2, &mut gear.stiffness.k3] {
            *stiffness /= found.factor;
        }
        gear.hysteresis = Hysteresis {
            width_arcmin: self.law(found)?.width(gear.gear.rated_torque).to_degrees() * 60.0,
            half_range: Some(self.half_range),
            weights: Some(rows),
        };
        Ok(gear)
    }
}
