//! Summary of the runs with scaled constants.

use super::{Effect, FACTORS};
use crate::io::figure::{Figure, number};
use crate::verify::Measured;
use crate::verify::bounds;
use crate::verify::catalogue::summary::Tally;
use crate::verify::catalogue::{Outcome, Run};
use crate::verify::judge::Metric;
use crate::verify::robustness::JUDGED;

/// Names of the factors.
const NAMES: [&str; FACTORS.len()] = ["half", "double"];

/// Everything that ran.
#[derive(Clone, Debug)]
pub struct Report {
    /// With every constant as it is.
    pub unscaled: Vec<Outcome>,
    /// With each of the constants scaled.
    pub effects: Vec<Effect>,
}

/// What one factor on one constant does.
#[derive(Clone, Debug, Default, PartialEq)]
struct Change {
    shakes: usize,
    worse: usize,
    stops: usize,
    refused: usize,
    error: f64,
    farthest: f64,
}

/// The drive is off at the end, or the plant has diverged.
fn is_lost(run: &Run<'_>) -> bool {
    run.ours.is_none() || run.is_stopped()
}

/// The middle of some numbers; 1 of none: then nothing has changed.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let [upper, lower] = [values.len() / 2, values.len().saturating_sub(1) / 2];
    match (values.get(lower), values.get(upper)) {
        (Some(a), Some(b)) => 0.5 * (a + b),
        _ => 1.0,
    }
}

/// The one that is farthest from 1, by its logarithm.
fn farthest(values: &[f64]) -> f64 {
    let distance = |value: &f64| value.ln().abs();
    values.iter().copied().max_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(1.0)
}

impl Change {
    fn of(unscaled: &[Outcome], scaled: &[Outcome]) -> Self {
        let built = || unscaled.iter().zip(scaled).filter(|(_, scaled)| scaled.refused.is_none());
        let tally = Tally::of(built().flat_map(|(_, scaled)| scaled.runs()));
        let pairs = || {
            built().flat_map(|(before, after)| (0..JUDGED.len()).map(|k| (k, before.run(k), after.run(k))))
        };
        let ratios: Vec<_> = pairs()
            .filter_map(|(k, before, after)| {
                let error = |run: &Run<'_>| run.ours.map(|ours| ours.metric(JUDGED[k], Metric::Error));
                Some(error(&after)? / error(&before)?)
            })
            .collect();
        Self {
            shakes: tally.shakes,
            worse: tally.worse,
            stops: pairs().filter(|(_, before, after)| !is_lost(before) && is_lost(after)).count(),
            refused: scaled.iter().filter(|outcome| outcome.refused.is_some()).count(),
            farthest: farthest(&ratios),
            error: median(ratios),
        }
    }

    fn cells(&self) -> [String; 5] {
        let built =
            |text: String| if self.refused > 0 { format!("{text} ({} refused)", self.refused) } else { text };
        [
            self.shakes.to_string(),
            self.worse.to_string(),
            built(self.stops.to_string()),
            format!("{:.3}", self.error),
            format!("{:.3}", self.farthest),
        ]
    }
}

impl Effect {
    fn changes(&self, unscaled: &[Outcome]) -> [Change; FACTORS.len()] {
        [0, 1].map(|k: usize| Change::of(unscaled, &self.scaled[k]))
    }
}

impl Report {
    /// One line for each constant, the header first.
    pub fn table(&self) -> Vec<Vec<String>> {
        let columns = NAMES.iter().flat_map(|name| {
            ["shake", "worse", "stop", "error", "farthest"].map(|what| format!("{name} {what}"))
        });
        let header = ["constant", "value", "unit"].map(String::from).into_iter().chain(columns).collect();
        let row = |effect: &Effect| {
            let constant = effect.constant;
            let names = [constant.name.to_owned(), number(constant.value), constant.unit.name().to_owned()];
            names.into_iter().chain(effect.changes(&self.unscaled).iter().flat_map(Change::cells)).collect()
        };
        [header].into_iter().chain(self.effects.iter().map(row)).collect()
    }

    /// What runs as it is, and which constants stop a joint, and on which.
    fn notes(&self) -> Vec<String> {
        let tally = Tally::of(self.unscaled.iter().flat_map(Outcome::runs));
        let lost = self.unscaled.iter().flat_map(Outcome::runs).filter(|(_, run)| is_lost(run)).count();
        let (joints, runs, shakes, worse) = (self.unscaled.len(), tally.runs, tally.shakes, tally.worse);
        let all = format!(
            "as they are: {joints} joints, {runs} runs, of which {shakes} shake, {worse} are worse than the best baseline and {lost} \
             diverge or are stopped"
        );
        [all].into_iter().chain(self.effects.iter().flat_map(|effect| self.stopped(effect))).collect()
    }

    fn stopped(&self, effect: &Effect) -> Vec<String> {
        let lines = effect.scaled.iter().zip(NAMES).flat_map(|(scaled, factor)| {
            let built = self.unscaled.iter().zip(scaled).filter(|(_, scaled)| scaled.refused.is_none());
            built.flat_map(move |(before, after)| {
                let lost = move |k: &usize| !is_lost(&before.run(*k)) && is_lost(&after.run(*k));
                (0..JUDGED.len()).filter(lost).map(move |k| {
                    let faults: Vec<_> =
                        after.run(k).ours.iter().flat_map(|ours| ours.faults.names()).collect();
                    let why = if faults.is_empty() { "diverged".to_owned() } else { faults.join(", ") };
                    let (joint, scenario) = (after.joint.describe(), JUDGED[k].name());
                    format!("{factor} {}: {joint}, {scenario}: {why}", effect.constant.name)
                })
            })
        });
        lines.collect()
    }

    /// The figures with their bounds, then those of each constant; `all` of the constants ran.
    pub fn figures(&self, all: bool) -> Vec<Figure> {
        let changes: Vec<_> =
            self.effects.iter().map(|effect| (effect, effect.changes(&self.unscaled))).collect();
        let stops = changes.iter().flat_map(|(_, changes)| changes).map(|change| change.stops).sum::<usize>();
        let stops = bounds::figure("constants.stops", stops as f64);
        let mut figures = if all {
            vec![bounds::figure("constants.count", self.effects.len() as f64), stops]
        } else {
            // The row is of all constants.
            vec![Figure { row: None, ..stops }]
        };
        for (effect, changes) in &changes {
            for (name, change) in NAMES.iter().zip(changes) {
                let name =
                    |what: &str| format!("constants.{}.{name}.{what}", effect.constant.name.to_lowercase());
                figures.extend([
                    Figure::reported(name("shakes"), change.shakes as f64, "run"),
                    Figure::reported(name("worse"), change.worse as f64, "run"),
                    Figure::reported(name("stops"), change.stops as f64, "run"),
                    Figure::reported(name("refused"), change.refused as f64, "joint"),
                    Figure::reported(name("error"), change.error, "1"),
                    Figure::reported(name("farthest"), change.farthest, "1"),
                ]);
            }
        }
        figures
    }

    /// The figures, with notes on the joints that stop.
    pub fn measured(&self, all: bool) -> Measured {
        Measured { figures: self.figures(all), notes: self.notes() }
    }
}

#[cfg(test)]
mod tests {
    use strainwave::compensator::Mode;

    use super::*;
    use crate::catalogue::Set;
    use crate::verify::robustness::RunResult;

    fn outcome(error: f64, mode: Mode) -> Outcome {
        let run = RunResult { metrics: vec![error, error], mode, ..RunResult::default() };
        let results = [0; JUDGED.len()].map(|_| Some(run.clone()));
        let joint = Set::Training.joints().swap_remove(0);
        Outcome { joint, baselines: vec![results.clone()], compensated: results, refused: None }
    }

    #[test]
    fn a_drive_that_a_factor_switches_off_is_counted_once_a_run() {
        let (sound, safe) = (outcome(1e-5, Mode::Active), outcome(2e-5, Mode::Safe));
        let change = |before: &Outcome, after: &Outcome| {
            Change::of(std::slice::from_ref(before), std::slice::from_ref(after))
        };
        assert_eq!(change(&sound, &safe).stops, JUDGED.len());
        assert_eq!((change(&safe, &safe).stops, change(&sound, &sound).stops), (0, 0));
        let diverged = Outcome { compensated: Default::default(), ..sound.clone() };
        assert_eq!(change(&sound, &diverged).stops, JUDGED.len());
        assert!((change(&sound, &safe).error - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_joint_that_cannot_be_built_counts_for_nothing_else() {
        let sound = outcome(1e-5, Mode::Active);
        let refused = Outcome {
            compensated: Default::default(),
            refused: Some(strainwave::Error::OutOfRange("gains")),
            ..sound.clone()
        };
        let expected = Change { refused: 1, error: 1.0, farthest: 1.0, ..Change::default() };
        assert_eq!(Change::of(&[sound], &[refused]), expected);
    }

    #[test]
    fn the_farthest_is_as_far_below_as_above() {
        assert_eq!(farthest(&[1.5, 0.5, 1.0]), 0.5);
        assert_eq!((median(vec![4.0, 1.0, 2.0]), median(vec![1.0, 3.0]), median(vec![])), (2.0, 2.0, 1.0));
    }
}
