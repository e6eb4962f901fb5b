//! Summary of a row's runs.

use strainwave::compensator::Mode;

use super::run_result::{JUDGED, Oscillation, RunResult, RunResults, torque_ratio};
use super::{Outcome, RIVALS, Rival};
use crate::bench::scenario::Scenario;
use crate::io::figure::{Figure, number};
use crate::io::gear_file::SensorSet;
use crate::plant::unknowns::Which;
use crate::verify::Measured;
use crate::verify::bounds;
use crate::verify::judge::{Metric, rms};

/// Ratios with a bound: its row, scenario, metric.
pub(super) const RATIOS: [(&str, Scenario, Metric); 4] = [
    ("robustness.s1.vibration", Scenario::S1, Metric::StepVibration),
    ("robustness.s2.error", Scenario::S2, Metric::Error),
    ("robustness.s3.vibration", Scenario::S3, Metric::MoveVibration),
    ("robustness.s4.error", Scenario::S4, Metric::Error),
];
/// Those of which the worst over B0 is reported.
const WORST: [(&str, Scenario, Metric); 2] = [
    ("s2.error.to_b0", Scenario::S2, Metric::Error),
    ("s3.vibration.to_b0", Scenario::S3, Metric::MoveVibration),
];
/// Worst plants that are named.
const NAMED: usize = 3;

/// What of a run is counted, by the compensator's result and B0's.
type Count = fn(Option<&RunResult>, Option<&RunResult>) -> bool;

/// Every row.
#[derive(Clone)]
pub struct Robustness {
    /// In the requested order.
    pub rows: Vec<Summary>,
    /// Summarised outcomes, in the same order.
    pub outcomes: Vec<(Which, Vec<Outcome>)>,
}

/// A row.
#[derive(Clone, Debug)]
pub struct Summary {
    /// Its name and uncertainty.
    pub name: &'static str,
    what: &'static str,
    /// Runs that were judged, with a set of sensors.
    pub runs: usize,
    /// Runs of each rival that shake against B0.
    rivals_shake: Vec<usize>,
    /// With the motor's sensors, with both encoders.
    pub sets: [OfSensors; 2],
}

/// A row with a set of sensors.
#[derive(Clone, Debug)]
pub struct OfSensors {
    /// Runs that shake or diverge, by scenario.
    pub shakes: [usize; JUDGED.len()],
    /// Runs that stay at the torque limit, alike.
    pub limited: [usize; JUDGED.len()],
    /// Runs that are worse than B0, alike.
    pub worse: [usize; JUDGED.len()],
    /// Runs that end with the drive switched off, alike.
    pub stopped: [usize; JUDGED.len()],
    /// In the order of [`RATIOS`], the median of the plants.
    ratios: [f64; RATIOS.len()],
    /// In the order of [`WORST`], with the plant's seed.
    worst: [(f64, u64); WORST.len()],
    torque_at_rest: f64,
    /// S4 with the map learnt and without it.
    untold: Option<[f64; 2]>,
    /// Plants with runs that shake, are limited, worse or stopped, the worst first.
    bad: Vec<Bad>,
}

/// A plant on which something went wrong.
#[derive(Clone, Debug, PartialEq)]
struct Bad {
    seed: u64,
    shakes: Vec<String>,
    limited: Vec<String>,
    worse: Vec<String>,
    stopped: Vec<String>,
    ratio: f64,
}

impl Summary {
    /// Of all its outcomes.
    pub fn of(which: Which, outcomes: &[Outcome]) -> Self {
        let shaking = |rival: usize| {
            let runs =
                outcomes.iter().flat_map(|outcome| outcome.rivals[rival].iter().zip(&outcome.rivals[0]));
            runs.filter(|(ours, b0)| shake(ours.as_ref(), b0.as_ref()).is_some()).count()
        };
        Self {
            name: which.name(),
            what: which.what(),
            runs: JUDGED.len() * outcomes.len(),
            rivals_shake: (0..RIVALS.len()).map(shaking).collect(),
            sets: SensorSet::ALL.map(|sensors| OfSensors::of(sensors, outcomes)),
        }
    }

    /// Its figures, each with its bound.
    fn figures(&self) -> Vec<Figure> {
        SensorSet::ALL
            .into_iter()
            .zip(&self.sets)
            .flat_map(|(sensors, set)| set.figures(&format!("robustness.{}.{}", self.name, sensors.name())))
            .collect()
    }

    fn cells(&self) -> Vec<String> {
        let rivals = self.rivals_shake.iter().skip(1).map(ToString::to_string);
        let sets = self.sets.iter().flat_map(OfSensors::cells);
        [self.name.to_owned()].into_iter().chain(sets).chain(rivals).collect()
    }
}

impl OfSensors {
    fn of(sensors: SensorSet, outcomes: &[Outcome]) -> Self {
        let ours = |outcome: &Outcome| outcome.compensated[sensors as usize].clone();
        let count = |bad: Count| {
            std::array::from_fn(|k| {
                let runs = outcomes.iter().map(|outcome| (ours(outcome)[k].clone(), &outcome.rivals[0][k]));
                runs.filter(|(ours, b0)| bad(ours.as_ref(), b0.as_ref())).count()
            })
        };
        let median_of = |result: &dyn Fn(&Outcome) -> Option<RunResult>, scenario, metric| {
            median(outcomes.iter().map(|outcome| {
                let ours = result(outcome).map_or(f64::INFINITY, |ours| ours.metric(scenario, metric));
                ours / best(&outcome.rivals, sensors, scenario, metric)
            }))
        };
        let place = |scenario| JUDGED.iter().position(|other| *other == scenario).unwrap_or_default();
        let ratio =
            |scenario, metric| median_of(&|outcome| ours(outcome)[place(scenario)].clone(), scenario, metric);
        let untold = |variant: usize| {
            let result = |outcome: &Outcome| {
                outcome.untold.as_ref()?[variant][sensors as usize][place(Scenario::S4)].clone()
            };
            median_of(&result, Scenario::S4, Metric::Error)
        };
        let has_untold = outcomes.iter().all(|outcome| outcome.untold.is_some());
        Self {
            shakes: count(|ours, b0| shake(ours, b0).is_some()),
            limited: count(limited),
            worse: count(worse),
            stopped: count(stopped),
            ratios: RATIOS.map(|(_, scenario, metric)| ratio(scenario, metric)),
            worst: WORST.map(|(_, scenario, metric)| {
                let ratios = outcomes.iter().map(|outcome| {
                    let ours =
                        ours(outcome)[place(scenario)].as_ref().map(|result| result.metric(scenario, metric));
                    let b0 = outcome.rivals[0][place(scenario)]
                        .as_ref()
                        .map(|result| result.metric(scenario, metric));
                    (ours.unwrap_or(f64::INFINITY) / b0.unwrap_or(f64::INFINITY), outcome.seed)
                });
                ratios.max_by(|a, b| a.0.abs().total_cmp(&b.0.abs())).unwrap_or((f64::NAN, 0))
            }),
            torque_at_rest: median(outcomes.iter().map(|outcome| {
                let at_rest = |results: &[Option<RunResult>]| {
                    rms(results
                        .iter()
                        .map(|result| result.as_ref().map_or(f64::INFINITY, |c| c.torque_at_rest)))
                };
                torque_ratio(at_rest(&ours(outcome)), at_rest(&outcome.rivals[0]))
            })),
            untold: has_untold.then(|| [untold(0), untold(1)]),
            bad: bad(sensors, outcomes),
        }
    }

    fn figures(&self, name: &str) -> Vec<Figure> {
        let bounded = |row: &str, value| {
            let what = row.trim_start_matches("robustness.");
            bounds::figure_as(format!("{name}.{what}"), row, value)
        };
        let count = |what, runs: &[usize]| {
            let figure = bounded(what, runs.iter().sum::<usize>() as f64);
            self.bad
                .first()
                .filter(|_| figure.value > 0.0)
                .map_or(figure.clone(), |bad| figure.of_seed(bad.seed))
        };
        let mut figures = vec![
            count("robustness.shakes", &self.shakes),
            count("robustness.limited", &self.limited),
            count("robustness.worse", &self.worse),
            count("robustness.stopped", &self.stopped),
        ];
        figures.extend(RATIOS.iter().zip(self.ratios).map(|((what, ..), ratio)| bounded(what, ratio)));
        figures.push(bounded("robustness.rest.torque", self.torque_at_rest));
        let reported = |what: &str, value| Figure::reported(format!("{name}.{what}"), value, "1");
        figures.extend(
            WORST
                .iter()
                .zip(self.worst)
                .map(|((what, ..), (ratio, seed))| reported(what, ratio).of_seed(seed)),
        );
        if let Some([learnt, absent]) = self.untold {
            figures.extend([reported("s4.error.learnt", learnt), reported("s4.error.absent", absent)]);
        }
        figures
    }

    fn cells(&self) -> [String; 9] {
        let short = |value: f64| if value >= 100.0 { format!("{value:.0}") } else { format!("{value:.2}") };
        let [_, s2, s3, s4] = self.ratios;
        let [(worst_s2, _), (worst_s3, _)] = self.worst;
        [
            self.shakes.iter().sum::<usize>().to_string(),
            self.limited.iter().sum::<usize>().to_string(),
            self.worse.iter().sum::<usize>().to_string(),
            self.stopped.iter().sum::<usize>().to_string(),
            short(s2),
            short(s4),
            short(s3),
            format!("{} {}", short(worst_s2), short(worst_s3)),
            short(self.torque_at_rest),
        ]
    }
}

impl Robustness {
    /// The figures, with notes on the worst plants.
    pub fn measured(&self) -> Measured {
        Measured {
            figures: self.rows.iter().flat_map(Summary::figures).collect(),
            notes: self.worst_plants(),
        }
    }

    /// One line a row, the header first.
    pub fn table(&self) -> Vec<Vec<String>> {
        let set = |name: &str| {
            ["shake", "limit", "worse", "off", "S2", "S4", "S3", "worst S2 S3", "rest"]
                .map(|column| format!("{name} {column}"))
        };
        let rivals = RIVALS.iter().skip(1).map(|rival| format!("{} shake", rival.name));
        let header = ["row".to_owned()].into_iter().chain(set("motor")).chain(set("both")).chain(rivals);
        [header.collect()].into_iter().chain(self.rows.iter().map(Summary::cells)).collect()
    }

    /// The worst plants of each row, and how to run one of them again.
    fn worst_plants(&self) -> Vec<String> {
        let lines = self.rows.iter().flat_map(|row| {
            SensorSet::ALL.into_iter().zip(&row.sets).filter(|(_, set)| !set.bad.is_empty()).map(
                move |(sensors, set)| {
                    let plants: Vec<_> = set.bad.iter().take(NAMED).map(Bad::line).collect();
                    format!("{} ({}), {}: {}", row.name, row.what, sensors.name(), plants.join("; "))
                },
            )
        });
        let mut lines: Vec<_> = lines.collect();
        let rerun = self.rows.iter().find_map(|row| {
            let bad = row.sets.iter().find_map(|set| set.bad.first())?;
            Some(format!(
                "one of them: strainwave verify robustness --row {} --first {} --seeds 1",
                row.name, bad.seed
            ))
        });
        lines.extend(rerun);
        lines
    }
}

impl Bad {
    fn line(&self) -> String {
        let list = |what: &str, scenarios: &[String]| match scenarios {
            [] => String::new(),
            _ => format!(" {what} {}", scenarios.join(" ")),
        };
        format!(
            "{}{}{}{}{} ({})",
            self.seed,
            list("shakes", &self.shakes),
            list("limited", &self.limited),
            list("worse", &self.worse),
            list("stopped", &self.stopped),
            number(self.ratio)
        )
    }
}

/// Plants with runs that shake, are limited, worse or stopped; more that shake, then worse, limited, stopped, then by the largest ratio to B0.
fn bad(sensors: SensorSet, outcomes: &[Outcome]) -> Vec<Bad> {
    let mut found: Vec<_> = outcomes.iter().filter_map(|outcome| Bad::of(sensors, outcome)).collect();
    found.sort_by(|a, b| {
        let counts = |bad: &Bad| (bad.shakes.len(), bad.worse.len(), bad.limited.len(), bad.stopped.len());
        counts(b).cmp(&counts(a)).then(b.ratio.total_cmp(&a.ratio))
    });
    found
}

impl Bad {
    fn of(sensors: SensorSet, outcome: &Outcome) -> Option<Self> {
        let ours = &outcome.compensated[sensors as usize];
        let runs = || JUDGED.iter().zip(ours.iter().zip(&outcome.rivals[0]));
        let shakes = runs().filter_map(|(scenario, (ours, b0))| {
            let shake = shake(ours.as_ref(), b0.as_ref())?;
            Some(format!("{}/{}", scenario.name(), shake.name()))
        });
        let list = |bad: Count| -> Vec<_> {
            let runs = runs().filter(|(_, (ours, b0))| bad(ours.as_ref(), b0.as_ref()));
            runs.map(|(scenario, _)| scenario.name().to_owned()).collect()
        };
        let ratios = runs().flat_map(|(_, (ours, b0))| match (ours, b0) {
            (Some(ours), Some(b0)) => ours.metrics.iter().zip(&b0.metrics).map(|(a, b)| a / b).collect(),
            _ => vec![f64::INFINITY],
        });
        let ratio = ratios.fold(0.0, f64::max);
        let counted: [Count; 3] = [limited, worse, stopped];
        let [limited, worse, stopped] = counted.map(list);
        let bad = Self { seed: outcome.seed, shakes: shakes.collect(), limited, worse, stopped, ratio };
        let kinds = [&bad.shakes, &bad.limited, &bad.worse, &bad.stopped];
        kinds.iter().any(|kind| !kind.is_empty()).then_some(bad)
    }
}

/// One that diverged does, also where B0 does.
fn shake(ours: Option<&RunResult>, b0: Option<&RunResult>) -> Option<Oscillation> {
    match (ours, b0) {
        (Some(ours), Some(b0)) => ours.oscillates(b0),
        (None, _) => Some(Oscillation::Diverged),
        (Some(_), None) => None,
    }
}

/// One that diverged is not.
fn limited(ours: Option<&RunResult>, b0: Option<&RunResult>) -> bool {
    matches!((ours, b0), (Some(ours), Some(b0)) if ours.is_limited(b0))
}

/// No run is worse than a diverged B0.
fn worse(ours: Option<&RunResult>, b0: Option<&RunResult>) -> bool {
    match (ours, b0) {
        (Some(ours), Some(b0)) => ours.is_worse(b0),
        (None, b0) => b0.is_some(),
        (Some(_), None) => false,
    }
}

/// Nothing is broken in any of the plants: a drive that a fault has switched off was switched off for nothing.
fn stopped(ours: Option<&RunResult>, _: Option<&RunResult>) -> bool {
    ours.is_some_and(|result| result.mode == Mode::Safe)
}

/// A rival that reads no more than these sensors.
pub(super) fn reads_no_more(rival: &Rival, sensors: SensorSet) -> bool {
    sensors == SensorSet::Both || rival.sensors == SensorSet::Motor
}

/// The smallest metric of those of [`RIVALS`] that read no more than these sensors; their results in that order.
pub fn best(results: &[RunResults], sensors: SensorSet, scenario: Scenario, metric: Metric) -> f64 {
    let rivals = RIVALS.iter().zip(results).filter(|(rival, _)| reads_no_more(rival, sensors));
    let place = JUDGED.iter().position(|other| *other == scenario).unwrap_or_default();
    let metrics = rivals.filter_map(|(_, results)| Some(results[place].as_ref()?.metric(scenario, metric)));
    metrics.fold(f64::INFINITY, f64::min)
}

/// The middle, the mean of the two middle ones of an even count; NaN counts as larger than any, and none as NaN.
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values: Vec<_> = values.into_iter().map(f64::abs).collect();
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => f64::NAN,
        odd if odd % 2 == 1 => values[odd / 2],
        even => 0.5 * (values[even / 2 - 1] + values[even / 2]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_in_the_middle() {
        assert_eq!([median([3.0, 1.0, 2.0]), median([4.0, 1.0, 2.0, 3.0])], [2.0, 2.5]);
        assert!(median([]).is_nan() && median([f64::NAN, 1.0, f64::NAN]).is_nan());
        assert_eq!(median([f64::NAN, 1.0, 2.0]), 2.0);
    }

    #[test]
    fn what_diverges_shakes_and_is_worse_where_b0_does_not() {
        let some = RunResult::default();
        assert_eq!([shake(None, Some(&some)), shake(None, None)], [Some(Oscillation::Diverged); 2]);
        assert_eq!([shake(Some(&some), None), shake(Some(&some), Some(&some))], [None; 2]);
        assert!(worse(None, Some(&some)) && !worse(None, None) && !worse(Some(&some), None));
    }

    #[test]
    fn a_run_that_ends_with_the_drive_off_is_counted() {
        let [works, off] =
            [Mode::Active, Mode::Safe].map(|mode| Some(RunResult { mode, ..RunResult::default() }));
        let outcome = Outcome {
            seed: 7,
            realisation: 0,
            rivals: vec![JUDGED.map(|_| works.clone()); RIVALS.len()],
            compensated: [off, works].map(|result| JUDGED.map(|_| result.clone())),
            untold: None,
        };
        let summary = Summary::of(Which::All, &[outcome]);
        assert_eq!(summary.sets.each_ref().map(|set| set.stopped), [[1; JUDGED.len()], [0; JUDGED.len()]]);
        assert_eq!(summary.sets.map(|set| set.bad.len()), [1, 0]);
    }
}
