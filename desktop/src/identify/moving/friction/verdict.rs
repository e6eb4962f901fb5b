//! What a log says of each parameter: its value, how well it is known, and a verdict.
//!
//! The covariance is that of the unknowns that the log carries, their priors with it, from the residual's own noise and
//! correlation. A parameter beyond them keeps the base gear's value; its deviation is that which it would have beside them.

use nalgebra::DVector;

use super::choice::{Choice, NOT_NARROWED, is_at_limit};
use super::fit::Fit;
use super::rollout::Rollout;
use super::unknowns::{Parameter, Unknown};
use crate::identify::Error;

/// Correlation of two unknowns from which on one is traded against the other.
const TRADED: f64 = 0.95;
/// Step of the differences.
const DIFFERENCE: f64 = 1e-4;
/// Deviations of a normal distribution within which 95 % are.
const MOST: f64 = 1.96;

/// What a log says of a parameter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The log shows it.
    Identified,
    /// The log would show it, and what it has been is as good.
    BaseKept,
    /// The log does not narrow what was known before.
    NotExcited,
    /// Its search ended where its range does.
    AtLimit,
    /// The log shows it together with another unknown only.
    Traded(String),
    /// Its torque is not in the log.
    NoLoad,
}

impl std::fmt::Display for Verdict {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Identified => f.write_str("identified"),
            Self::BaseKept => f.write_str("the base gear's predicts as well and stays"),
            Self::NotExcited => f.write_str("not excited, the log does not narrow it"),
            Self::AtLimit => f.write_str("at the limit of its search"),
            Self::Traded(other) => write!(f, "traded against {other}"),
            Self::NoLoad => f.write_str("not identified without tau_out_nm; the base gear's stays"),
        }
    }
}

/// A parameter of the input friction.
#[derive(Clone, Debug, PartialEq)]
pub struct LearntParameter {
    /// Which.
    pub parameter: Parameter,
    /// Of the base gear, in the parameter's unit.
    pub base: f64,
    /// Of the identified gear.
    pub value: f64,
    /// Standard error.
    pub deviation: f64,
    /// In which it is with 95 %.
    pub interval: [f64; 2],
    /// Plain.
    pub verdict: Verdict,
}

impl std::fmt::Display for LearntParameter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { parameter, base, value, deviation, verdict, .. } = self;
        let (key, unit) = (parameter.key(), parameter.unit());
        write!(
            f,
            "friction.input.{key}: {value:.3e} +- {deviation:.1e} {unit}, base gear {base:.3e}: {verdict}"
        )
    }
}

/// Every parameter that the base gear has, and the ripple where there is one.
pub(super) fn parameters(
    rollout: Rollout<'_>,
    torque: &[f64],
    choice: &Choice,
) -> Result<Vec<LearntParameter>, Error> {
    let carried = |parameter| choice.model.unknowns.contains(&Unknown::Of(parameter));
    let constant = [
        Parameter::Coulomb,
        Parameter::Static,
        Parameter::Stribeck,
        Parameter::Viscous,
        Parameter::Presliding,
        Parameter::Driving,
        Parameter::Driven,
    ];
    let ripple = [1, 2].into_iter().flat_map(|k| [Parameter::RippleCosine(k), Parameter::RippleSine(k)]);
    let side = &rollout.gear.friction.input;
    let there = |parameter: &Parameter| parameter.of(side).is_some_and(|value| value > 0.0);
    let reported = constant.into_iter().filter(there).chain(ripple.filter(|parameter| carried(*parameter)));
    reported.map(|parameter| one(rollout, torque, choice, parameter)).collect()
}

fn one(
    rollout: Rollout<'_>,
    torque: &[f64],
    choice: &Choice,
    parameter: Parameter,
) -> Result<LearntParameter, Error> {
    let model = &choice.model;
    let (mut unknowns, mut z) = (model.unknowns.clone(), model.solution.z.clone());
    let carried = unknowns.iter().position(|unknown| *unknown == Unknown::Of(parameter));
    let index = carried.unwrap_or(unknowns.len());
    if carried.is_none() {
        unknowns.push(Unknown::Of(parameter));
        z.push(0.0);
    }
    let fit = Fit { rollout, torque, unknowns: &unknowns };
    let covariance = fit.covariance(&z, &model.solution)?;
    let backwards = !rollout.directions[0];
    let value = |z: &[f64]| {
        let side = rollout.side(&unknowns, z);
        parameter.of(&if backwards { side.backwards() } else { side }).unwrap_or(f64::NAN)
    };
    let slope = DVector::from_fn(z.len(), |k, _| {
        let mut there = z.clone();
        there[k] += DIFFERENCE;
        (value(&there) - value(&z)) / DIFFERENCE
    });
    let (found, deviation) = (value(&z), (slope.transpose() * &covariance * &slope)[(0, 0)].sqrt());
    let own = covariance[(index, index)].sqrt();
    let partner = (0..z.len())
        .filter(|k| *k != index)
        .find(|k| (covariance[(index, *k)] / (own * covariance[(*k, *k)].sqrt())).abs() > TRADED);
    let no_load = matches!(parameter, Parameter::Driving | Parameter::Driven) && !rollout.motion.has_load();
    let verdict = match (carried, partner) {
        _ if no_load => Verdict::NoLoad,
        (None, _) if choice.at_limit.contains(&parameter) => Verdict::AtLimit,
        (Some(_), _) if is_at_limit(unknowns[index], z[index]) => Verdict::AtLimit,
        (_, Some(other)) if own < NOT_NARROWED => Verdict::Traded(unknowns[other].name()),
        _ if own > NOT_NARROWED => Verdict::NotExcited,
        (None, _) => Verdict::BaseKept,
        (Some(_), _) => Verdict::Identified,
    };
    let interval = if parameter.is_logarithmic() {
        [-MOST, MOST].map(|side| found * (side * deviation / found).exp())
    } else {
        [-MOST, MOST].map(|side| found + side * deviation)
    };
    let base = parameter.of(&rollout.gear.friction.input).unwrap_or(f64::NAN);
    Ok(LearntParameter { parameter, base, value: found, deviation, interval, verdict })
}
