//! Which unknowns the log carries: from the Coulomb and viscous factors on, a group at a time, by cross-validation.
//!
//! Each of [`SEGMENTS`] pieces of the motor's path is held out once and predicted, the block going on through it. A group stays when
//! the robust loss of what is held out falls by more than its standard error, over pieces of [`PIECE`] rows, and no
//! parameter of it ends at its limit. Groups that do not are tried again when another one has come in after them.

use super::fit::{Fit, Solution};
use super::rollout::Rollout;
use super::spectrum;
use super::unknowns::{Parameter, Unknown};
use crate::identify::Error;
use crate::io::gear_file::Friction;

/// Pieces of the path.
const SEGMENTS: usize = 4;
/// Rows whose losses are summed before their deviation is taken: 0.1 s.
const PIECE: usize = 25;
/// Revolutions from which on ripple is not taken for a slope of the load.
const REVOLUTIONS: f64 = 1.0;
/// Distance to the end of a range that counts as there.
const AT_LIMIT: f64 = 1e-3;
/// Further starts of what the torque does not depend on linearly.
const STARTS: [f64; 2] = [-1.2, 1.2];

/// Unknowns with their solution.
#[derive(Clone, Debug)]
pub(super) struct Model {
    /// Which.
    pub unknowns: Vec<Unknown>,
    /// Their values.
    pub solution: Solution,
    /// Residual of every row where it was held out (N m).
    held_out: Vec<f64>,
}

/// What the log carries.
#[derive(Clone, Debug)]
pub(super) struct Choice {
    /// Its model.
    pub model: Model,
    /// Parameters beyond it that have ended at their limit.
    pub at_limit: Vec<Parameter>,
}

/// Is this value of an unknown at an end of its range?
pub(super) fn is_at_limit(unknown: Unknown, z: f64) -> bool {
    unknown.range().iter().any(|end| (z - end).abs() < AT_LIMIT)
}

/// Offset, load, start, Coulomb and viscous factors.
pub(super) fn first(rollout: &Rollout<'_>) -> Vec<Unknown> {
    let mut unknowns = vec![Unknown::Offset, Unknown::Inertia, Unknown::Start];
    if !rollout.motion.has_load() {
        unknowns.push(Unknown::Slope);
    }
    let side = &rollout.gear.friction.input;
    let known = [Parameter::Coulomb, Parameter::Viscous];
    unknowns.extend(known.into_iter().filter(|known| is_positive(side, *known)).map(Unknown::Of));
    unknowns
}

/// Further groups, in the order in which they are tried.
pub(super) fn groups(rollout: &Rollout<'_>) -> Vec<Vec<Unknown>> {
    let side = &rollout.gear.friction.input;
    let mut groups = vec![vec![Parameter::Presliding], vec![Parameter::Static], vec![Parameter::Stribeck]];
    if rollout.motion.has_load() {
        groups.push(vec![Parameter::Driving, Parameter::Driven]);
    }
    groups.iter_mut().for_each(|group| group.retain(|parameter| is_positive(side, *parameter)));
    if rollout.motion.revolutions() >= REVOLUTIONS {
        groups.push([1, 2].into_iter().flat_map(|k| [Parameter::RippleCosine(k), Parameter::RippleSine(k)]).collect());
    }
    groups.retain(|group| !group.is_empty());
    groups.into_iter().map(|group| group.into_iter().map(Unknown::Of).collect()).collect()
}

/// A factor on none finds nothing.
fn is_positive(side: &Friction, parameter: Parameter) -> bool {
    parameter.of(side).is_some_and(|value| value > 0.0)
}

/// Chooses what the log carries beyond a first solution.
pub(super) fn choose(
    rollout: Rollout<'_>,
    torque: &[f64],
    (unknowns, solution): (Vec<Unknown>, Solution),
) -> Result<Choice, Error> {
    let fit = Fit { rollout, torque, unknowns: &unknowns };
    let solution = fit.robust(solution)?;
    let held_out = held_out(&fit, &solution)?;
    let mut choice = Choice { model: Model { unknowns, solution, held_out }, at_limit: Vec::new() };
    let rejected = choice.extend(rollout, torque, groups(&rollout))?;
    let before = choice.model.unknowns.len();
    let waves = choice.extend(rollout, torque, choice.waves(&rollout))?;
    if choice.model.unknowns.len() > before || waves.is_empty() {
        choice.extend(rollout, torque, rejected)?;
    }
    Ok(choice)
}

impl Choice {
    /// Takes what improves the model; answers with the other groups.
    fn extend(
        &mut self,
        rollout: Rollout<'_>,
        torque: &[f64],
        groups: Vec<Vec<Unknown>>,
    ) -> Result<Vec<Vec<Unknown>>, Error> {
        let mut rejected = Vec::new();
        for group in groups {
            match self.model.with(rollout, torque, &group)? {
                Attempt::Better(model) => {
                    self.at_limit.retain(|parameter| !group.contains(&Unknown::Of(*parameter)));
                    self.model = model;
                }
                Attempt::AtLimit(parameter) => {
                    self.at_limit.push(parameter);
                    rejected.push(group);
                }
                Attempt::NoBetter => rejected.push(group),
            }
        }
        Ok(rejected)
    }

    /// Sine and cosine of each wave that shows in the residual.
    fn waves(&self, rollout: &Rollout<'_>) -> Vec<Vec<Unknown>> {
        let Solution { left, noise, .. } = &self.model.solution;
        let rows = rollout.motion.rows().zip(left.iter().copied());
        let deviation = noise.of_row() * (2.0 / left.len() as f64).sqrt();
        let waves = spectrum::waves(rows, deviation, rollout.directions);
        waves.into_iter().map(|wave| vec![Unknown::Sine(wave), Unknown::Cosine(wave)]).collect()
    }
}

enum Attempt {
    Better(Model),
    NoBetter,
    AtLimit(Parameter),
}

impl Model {
    /// With a further group.
    fn with(&self, rollout: Rollout<'_>, torque: &[f64], group: &[Unknown]) -> Result<Attempt, Error> {
        let unknowns = [&self.unknowns[..], group].concat();
        let fit = Fit { rollout, torque, unknowns: &unknowns };
        let solution = self.solution_of(&fit, group)?;
        let limit = unknowns.iter().zip(&solution.z).find_map(|(unknown, z)| match unknown {
            Unknown::Of(parameter) if group.contains(unknown) && is_at_limit(*unknown, *z) => Some(*parameter),
            _ => None,
        });
        if let Some(parameter) = limit {
            return Ok(Attempt::AtLimit(parameter));
        }
        let held_out = held_out(&fit, &solution)?;
        Ok(if self.is_worse_than(&held_out) {
            Attempt::Better(Self { unknowns, solution, held_out })
        } else {
            Attempt::NoBetter
        })
    }

    /// The best from a few starts.
    fn solution_of(&self, fit: &Fit<'_>, group: &[Unknown]) -> Result<Solution, Error> {
        let curved = matches!(group, [Unknown::Of(parameter)] if parameter.is_logarithmic());
        let starts = std::iter::once(0.0).chain(STARTS.into_iter().filter(|_| curved));
        let mut best: Option<Solution> = None;
        for start in starts {
            let found = fit.again(&fit.widened(&self.solution, start), &self.solution)?;
            if best.as_ref().is_none_or(|best| found.cost < best.cost) {
                best = Some(found);
            }
        }
        fit.robust(best.unwrap_or_else(|| self.solution.clone()))
    }

    /// Another model's residuals on what was held out are smaller by more than chance.
    fn is_worse_than(&self, other: &[f64]) -> bool {
        let noise = &self.solution.noise;
        let gains: Vec<_> =
            self.held_out.iter().zip(other).map(|(own, other)| noise.loss(*own) - noise.loss(*other)).collect();
        let pieces: Vec<f64> = gains.chunks(PIECE).map(|piece| piece.iter().sum()).collect();
        let count = pieces.len() as f64;
        let mean = pieces.iter().sum::<f64>() / count;
        let variance = pieces.iter().map(|piece| (piece - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
        mean > (variance / count).sqrt()
    }
}

/// Residual of every row by the solution of the pieces that it is not in (N m).
fn held_out(fit: &Fit<'_>, solution: &Solution) -> Result<Vec<f64>, Error> {
    let pieces = pieces(&fit.rollout);
    let mut held_out = vec![0.0; pieces.len()];
    for piece in 0..SEGMENTS {
        let trains: Vec<_> = pieces.iter().map(|own| *own != piece).collect();
        if trains.iter().all(|trains| *trains) || !trains.contains(&true) {
            continue;
        }
        let found = fit.part(solution, &trains)?;
        let rows = held_out.iter_mut().zip(&found.left).zip(&trains);
        rows.filter(|(_, trains)| !**trains).for_each(|((held_out, left), _)| *held_out = *left);
    }
    Ok(held_out)
}

/// Which piece of the path each row is in.
fn pieces(rollout: &Rollout<'_>) -> Vec<usize> {
    let rows = || rollout.motion.rows().map(|step| step.speed.abs());
    let whole: f64 = rows().sum();
    let mut gone = 0.0;
    let piece = |speed: f64| {
        gone += speed;
        ((gone / whole * SEGMENTS as f64) as usize).min(SEGMENTS - 1)
    };
    rows().map(piece).collect()
}
