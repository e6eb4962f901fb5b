//! What a log says of each parameter: its value, how well it is known, and a verdict.
//!
//! A parameter that the log does not carry keeps the base gear's value. The covariance is that of all of them together, carried and
//! kept, their priors with it, from the residual's own noise and correlation: a Stribeck speed that is kept is not known, and what
//! is not known of it is not known of the levels. The interval is about the solution of all of them, too. About the chosen
//! values it would not hold: what is kept where it should have been taken pulls the others along, and how often cross-validation
//! does so depends on the true values. Where a chosen value is outside, the interval is extended to it.
//!
//! H. Leeb, B. Poetscher, "Model selection and inference: facts and fiction", Econometric Theory 21 (2005).

use nalgebra::{DMatrix, DVector};

use super::choice::{Choice, Model, NOT_NARROWED, is_at_limit};
use super::fit::{Fit, Solution};
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
    /// In which it is with 95 %, whichever parameters the log was found to carry.
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
    let reported: Vec<_> = reported.collect();
    let Model { unknowns, solution, .. } = &choice.model;
    let all = All::of(Fit { rollout, torque, unknowns }, solution, &reported, &choice.at_limit)?;
    Ok(reported.into_iter().map(|parameter| all.learnt(choice, parameter)).collect())
}

/// The unknowns that the log carries, then the reported parameters that stay as they are.
struct All<'a> {
    rollout: Rollout<'a>,
    /// How many of the unknowns are carried.
    carried: usize,
    unknowns: Vec<Unknown>,
    /// Of the identified gear.
    z: Vec<f64>,
    /// Of the least squares of all of them, about which the covariance is.
    centre: Vec<f64>,
    covariance: DMatrix<f64>,
}

impl<'a> All<'a> {
    fn of(
        carried: Fit<'a>,
        solution: &Solution,
        reported: &[Parameter],
        at_limit: &[Parameter],
    ) -> Result<Self, Error> {
        let has_load = carried.rollout.motion.has_load();
        let kept = reported.iter().filter(|parameter| !carried.unknowns.contains(&Unknown::Of(**parameter)));
        let (solved, fixed): (Vec<Parameter>, Vec<_>) = kept
            .partition(|parameter| !at_limit.contains(parameter) && (has_load || !is_of_load(**parameter)));
        let mut unknowns =
            [carried.unknowns, &solved.into_iter().map(Unknown::Of).collect::<Vec<_>>()].concat();
        let mut centre = centre(&Fit { unknowns: &unknowns, ..carried }, solution)?;
        unknowns.extend(fixed.into_iter().map(Unknown::Of));
        centre.resize(unknowns.len(), 0.0);
        let mut z = solution.z.clone();
        z.resize(unknowns.len(), 0.0);
        let covariance = Fit { unknowns: &unknowns, ..carried }.covariance(&centre, solution)?;
        let (rollout, carried) = (carried.rollout, carried.unknowns.len());
        Ok(Self { rollout, carried, unknowns, z, centre, covariance })
    }

    /// Of a reported parameter, in its unit.
    fn value(&self, parameter: Parameter, z: &[f64]) -> f64 {
        let side = self.rollout.side(&self.unknowns, z);
        let backwards = !self.rollout.directions[0];
        parameter.of(&if backwards { side.backwards() } else { side }).unwrap_or(f64::NAN)
    }

    /// Standard error of a reported parameter, in its unit.
    fn deviation(&self, parameter: Parameter) -> f64 {
        let here = self.value(parameter, &self.centre);
        let slope = DVector::from_fn(self.z.len(), |k, _| {
            let mut there = self.centre.clone();
            there[k] += DIFFERENCE;
            (self.value(parameter, &there) - here) / DIFFERENCE
        });
        slope.dot(&(&self.covariance * &slope)).sqrt()
    }

    fn learnt(&self, choice: &Choice, parameter: Parameter) -> LearntParameter {
        let (value, deviation) = (self.value(parameter, &self.z), self.deviation(parameter));
        let centre = self.value(parameter, &self.centre);
        let interval = if parameter.is_logarithmic() {
            [-MOST, MOST].map(|side| centre * (side * deviation / centre).exp())
        } else {
            [-MOST, MOST].map(|side| centre + side * deviation)
        };
        let interval = [interval[0].min(value), interval[1].max(value)];
        let base = parameter.of(&self.rollout.gear.friction.input).unwrap_or(f64::NAN);
        let verdict = self.verdict(choice, parameter);
        LearntParameter { parameter, base, value, deviation, interval, verdict }
    }

    fn verdict(&self, choice: &Choice, parameter: Parameter) -> Verdict {
        let Self { unknowns, z, covariance, .. } = self;
        let index = unknowns.iter().position(|unknown| *unknown == Unknown::Of(parameter));
        let Some(index) = index else { return Verdict::NotExcited };
        let carried = index < self.carried;
        let own = covariance[(index, index)].sqrt();
        let partner = (0..z.len())
            .filter(|k| *k != index)
            .find(|k| (covariance[(index, *k)] / (own * covariance[(*k, *k)].sqrt())).abs() > TRADED);
        match partner {
            _ if is_of_load(parameter) && !self.rollout.motion.has_load() => Verdict::NoLoad,
            _ if !carried && choice.at_limit.contains(&parameter) => Verdict::AtLimit,
            _ if carried && is_at_limit(unknowns[index], z[index]) => Verdict::AtLimit,
            Some(other) if own < NOT_NARROWED => Verdict::Traded(unknowns[other].name()),
            _ if own > NOT_NARROWED => Verdict::NotExcited,
            _ if carried => Verdict::Identified,
            _ => Verdict::BaseKept,
        }
    }
}

/// The least squares of all unknowns, those that stay as they are too; without these where one of them ends at its limit.
fn centre(all: &Fit<'_>, carried: &Solution) -> Result<Vec<f64>, Error> {
    let start = all.widened(carried, 0.0);
    if start.len() == carried.z.len() {
        return Ok(start);
    }
    let found = all.again(&start, carried)?.z;
    let mut kept = all.unknowns.iter().zip(&found).skip(carried.z.len());
    let ended = kept.any(|(unknown, z)| is_at_limit(*unknown, *z));
    Ok(if ended { start } else { found })
}

fn is_of_load(parameter: Parameter) -> bool {
    matches!(parameter, Parameter::Driving | Parameter::Driven)
}

#[cfg(test)]
mod tests {
    use super::super::strokes::Strokes;
    use super::*;

    /// The Stribeck speed of the strokes is e^0.5 times the gear's.
    #[test]
    fn the_interval_of_a_parameter_that_is_kept_against_the_log_has_the_true_value() {
        let strokes = Strokes::new();
        let carried = [Parameter::Coulomb, Parameter::Static, Parameter::Presliding].map(Unknown::Of);
        let fit = strokes.fit(&carried);
        let solution = fit.plain(&[0.0; 3], Strokes::NOISE).unwrap();
        let all = All::of(fit, &solution, &[Parameter::Stribeck], &[]).unwrap();
        let (kept, found) =
            (all.value(Parameter::Stribeck, &all.z), all.value(Parameter::Stribeck, &all.centre));
        let known = all.deviation(Parameter::Stribeck);
        assert!((found / kept - 0.5f64.exp()).abs() < 3.0 * known / kept, "{kept} {found} +- {known}");
        let limited = All::of(fit, &solution, &[Parameter::Stribeck], &[Parameter::Stribeck]).unwrap();
        assert_eq!(limited.centre, limited.z);
    }

    #[test]
    fn what_is_not_known_of_a_parameter_that_is_kept_is_not_known_of_the_others() {
        let strokes = Strokes::new();
        let carried = [Unknown::Offset, Unknown::Of(Parameter::Coulomb), Unknown::Of(Parameter::Static)];
        let fit = strokes.fit(&carried);
        let solution = fit.plain(&[0.0; 3], Strokes::NOISE).unwrap();
        let [alone, beside] =
            [&[][..], &[Parameter::Stribeck]].map(|kept| All::of(fit, &solution, kept, &[]).unwrap());
        for parameter in [Parameter::Coulomb, Parameter::Static] {
            let of = |all: &All<'_>| all.value(parameter, &all.z);
            assert_eq!(of(&alone), of(&beside));
            assert!(beside.deviation(parameter) > alone.deviation(parameter), "{parameter:?}");
        }
    }
}
