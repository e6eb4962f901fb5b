//! Which unknowns the log carries: from the Coulomb and viscous factors on, a group at a time, by cross-validation.
//!
//! Segments of [`SEGMENT`] rows belong to [`PARTS`] parts in turn; each part is held out once and predicted by the solution of the
//! others, the block going on through it. A group stays when the robust loss of what is held out falls and no parameter of it ends at its
//! limit. Groups that do not are tried again at the end, alone and together. A parameter that the log does not narrow to
//! [`NOT_NARROWED`] of what was known before it goes at last.

use super::fit::{Fit, Solution};
use super::rollout::Rollout;
use super::spectrum;
use super::unknowns::{Parameter, Unknown};
use crate::identify::Error;
use crate::io::gear_file::Friction;

/// Rows of a segment: 0.2 s, beyond which residuals are not alike.
const SEGMENT: usize = 50;
/// Parts that the segments belong to.
const PARTS: usize = 10;
/// Revolutions from which on ripple is not taken for a slope of the load.
const REVOLUTIONS: f64 = 1.0;
/// Distance to the end of a range that counts as there.
const AT_LIMIT: f64 = 1e-3;
/// Deviation over the prior's from which on the log does not narrow a parameter.
pub(super) const NOT_NARROWED: f64 = 0.5;
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
        groups.push(
            [1, 2].into_iter().flat_map(|k| [Parameter::RippleCosine(k), Parameter::RippleSine(k)]).collect(),
        );
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
    let model = Model::of(&Fit { rollout, torque, unknowns: &unknowns }, solution)?;
    let (model, factors) = model.or_base(rollout, torque)?;
    let mut choice = Choice { model, at_limit: Vec::new() };
    let mut rejected = choice.extend(rollout, torque, groups(&rollout))?;
    rejected.extend(factors);
    choice.extend(rollout, torque, choice.waves(&rollout))?;
    let rejected = choice.extend(rollout, torque, rejected)?;
    choice.extend(rollout, torque, vec![rejected.concat()])?;
    while let Some(parameter) = choice.model.ended() {
        choice.model = choice.model.without(rollout, torque, &[Unknown::Of(parameter)])?;
        choice.at_limit.push(parameter);
    }
    while let Some(parameter) = choice.model.not_narrowed(rollout, torque)? {
        choice.model = choice.model.without(rollout, torque, &[Unknown::Of(parameter)])?;
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
        for group in groups.into_iter().filter(|group| !group.is_empty()) {
            match self.model.with(rollout, torque, &group)? {
                Attempt::Better(model) => {
                    self.at_limit.retain(|parameter| !group.contains(&Unknown::Of(*parameter)));
                    self.model = model;
                }
                Attempt::AtLimit(parameter) => {
                    self.at_limit.retain(|own| *own != parameter);
                    self.at_limit.push(parameter);
                    rejected.push(group);
                }
                Attempt::NoBetter => {
                    self.at_limit.retain(|parameter| !group.contains(&Unknown::Of(*parameter)));
                    rejected.push(group);
                }
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
    fn of(fit: &Fit<'_>, solution: Solution) -> Result<Self, Error> {
        let solution = fit.robust(solution)?;
        let held_out = held_out(fit, &solution)?;
        Ok(Self { unknowns: fit.unknowns.to_vec(), solution, held_out })
    }

    /// This one of the first unknowns, or where the base gear's factors predict as well one without them, and they; what has ended
    /// at a limit is kept, to be told.
    fn or_base(self, rollout: Rollout<'_>, torque: &[f64]) -> Result<(Self, Option<Vec<Unknown>>), Error> {
        let factors: Vec<_> =
            self.unknowns.iter().copied().filter(|unknown| matches!(unknown, Unknown::Of(_))).collect();
        let base = self.without(rollout, torque, &factors)?;
        let ended = self.unknowns.iter().zip(&self.solution.z).any(|(unknown, z)| is_at_limit(*unknown, *z));
        Ok(if ended || base.is_worse_than(&self.held_out) { (self, None) } else { (base, Some(factors)) })
    }

    /// A parameter beyond the factors that has come to its limit since it was taken.
    fn ended(&self) -> Option<Parameter> {
        self.unknowns.iter().zip(&self.solution.z).find_map(|(unknown, z)| match unknown {
            Unknown::Of(Parameter::Coulomb | Parameter::Viscous) => None,
            Unknown::Of(parameter) if is_at_limit(*unknown, *z) => Some(*parameter),
            _ => None,
        })
    }

    /// The parameter that the log narrows least, of those that it hardly does.
    fn not_narrowed(&self, rollout: Rollout<'_>, torque: &[f64]) -> Result<Option<Parameter>, Error> {
        let Self { unknowns, solution, .. } = self;
        let covariance = Fit { rollout, torque, unknowns }.covariance(&solution.z, solution)?;
        let parameters = unknowns.iter().enumerate().filter_map(|(k, unknown)| match unknown {
            Unknown::Of(parameter) if !is_at_limit(*unknown, solution.z[k]) => {
                Some((*parameter, covariance[(k, k)].sqrt()))
            }
            _ => None,
        });
        let least = parameters.max_by(|a, b| a.1.total_cmp(&b.1));
        Ok(least.filter(|(_, deviation)| *deviation > NOT_NARROWED).map(|(parameter, _)| parameter))
    }

    /// Without some unknowns.
    fn without(&self, rollout: Rollout<'_>, torque: &[f64], left_out: &[Unknown]) -> Result<Self, Error> {
        let (unknowns, z): (Vec<_>, Vec<_>) = self
            .unknowns
            .iter()
            .zip(&self.solution.z)
            .filter(|(unknown, _)| !left_out.contains(unknown))
            .unzip();
        let fit = Fit { rollout, torque, unknowns: &unknowns };
        Self::of(&fit, fit.again(&z, &self.solution)?)
    }

    /// With a further group.
    fn with(&self, rollout: Rollout<'_>, torque: &[f64], group: &[Unknown]) -> Result<Attempt, Error> {
        let unknowns = [&self.unknowns[..], group].concat();
        let fit = Fit { rollout, torque, unknowns: &unknowns };
        let solution = self.solution_of(&fit, group)?;
        let limit = unknowns.iter().zip(&solution.z).find_map(|(unknown, z)| match unknown {
            Unknown::Of(parameter) if group.contains(unknown) && is_at_limit(*unknown, *z) => {
                Some(*parameter)
            }
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

    /// Another model's residuals on what was held out are smaller.
    fn is_worse_than(&self, other: &[f64]) -> bool {
        let loss = |left: &[f64]| left.iter().map(|left| self.solution.noise.loss(*left)).sum::<f64>();
        loss(&self.held_out) > loss(other)
    }
}

/// Residual of every row by the solution without its part (N m).
fn held_out(fit: &Fit<'_>, solution: &Solution) -> Result<Vec<f64>, Error> {
    let parts: Vec<_> = (0..solution.left.len()).map(|row| row / SEGMENT % PARTS).collect();
    fit.left_out(solution, &parts)
}
