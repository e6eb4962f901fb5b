//! Rows of the claims, and what a map brings.

use super::{Outcome, SCENARIOS, place};
use crate::bench::scenario::Scenario;
use crate::io::figure::Figure;
use crate::io::gear_file::{Kind, SensorSet};
use crate::verify::bounds;
use crate::verify::compensator::SAMPLES;
use crate::verify::judge::Metric;
use crate::verify::robustness::{Map, RIVALS, RunResults, best, median};

/// What a metric is compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Reference {
    /// The cascade alone, on the worst sample.
    B0,
    /// The best rival with the same map, in the median.
    Best,
}

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Claim {
    /// With the motor's sensors, with both encoders; each with the map told, learnt, absent.
    pub names: [[&'static str; 3]; 2],
    scenario: Scenario,
    metric: Metric,
    reference: Reference,
}

const fn claim(
    scenario: Scenario,
    metric: Metric,
    reference: Reference,
    names: [[&'static str; 3]; 2],
) -> Claim {
    Claim { names, scenario, metric, reference }
}

/// Every row.
pub const CLAIMS: &[Claim] = &[
    claim(
        Scenario::S2,
        Metric::Error,
        Reference::B0,
        [
            [
                "compensator.motor.map_told.s2.rms_to_b0",
                "compensator.motor.map_learnt.s2.rms_to_b0",
                "compensator.motor.map_absent.s2.rms_to_b0",
            ],
            [
                "compensator.both.map_told.s2.rms_to_b0",
                "compensator.both.map_learnt.s2.rms_to_b0",
                "compensator.both.map_absent.s2.rms_to_b0",
            ],
        ],
    ),
    claim(
        Scenario::S2,
        Metric::Error,
        Reference::Best,
        [
            [
                "compensator.motor.map_told.s2.rms_to_best",
                "compensator.motor.map_learnt.s2.rms_to_best",
                "compensator.motor.map_absent.s2.rms_to_best",
            ],
            [
                "compensator.both.map_told.s2.rms_to_best",
                "compensator.both.map_learnt.s2.rms_to_best",
                "compensator.both.map_absent.s2.rms_to_best",
            ],
        ],
    ),
    claim(
        Scenario::S3,
        Metric::MoveVibration,
        Reference::B0,
        [
            [
                "compensator.motor.map_told.s3.vibration_to_b0",
                "compensator.motor.map_learnt.s3.vibration_to_b0",
                "compensator.motor.map_absent.s3.vibration_to_b0",
            ],
            [
                "compensator.both.map_told.s3.vibration_to_b0",
                "compensator.both.map_learnt.s3.vibration_to_b0",
                "compensator.both.map_absent.s3.vibration_to_b0",
            ],
        ],
    ),
    claim(
        Scenario::S3,
        Metric::MoveVibration,
        Reference::Best,
        [
            [
                "compensator.motor.map_told.s3.vibration_to_best",
                "compensator.motor.map_learnt.s3.vibration_to_best",
                "compensator.motor.map_absent.s3.vibration_to_best",
            ],
            [
                "compensator.both.map_told.s3.vibration_to_best",
                "compensator.both.map_learnt.s3.vibration_to_best",
                "compensator.both.map_absent.s3.vibration_to_best",
            ],
        ],
    ),
    claim(
        Scenario::S4,
        Metric::Ripple,
        Reference::B0,
        [
            [
                "compensator.motor.map_told.s4.ripple_to_b0",
                "compensator.motor.map_learnt.s4.ripple_to_b0",
                "compensator.motor.map_absent.s4.ripple_to_b0",
            ],
            [
                "compensator.both.map_told.s4.ripple_to_b0",
                "compensator.both.map_learnt.s4.ripple_to_b0",
                "compensator.both.map_absent.s4.ripple_to_b0",
            ],
        ],
    ),
    claim(
        Scenario::S4,
        Metric::Ripple,
        Reference::Best,
        [
            [
                "compensator.motor.map_told.s4.ripple_to_best",
                "compensator.motor.map_learnt.s4.ripple_to_best",
                "compensator.motor.map_absent.s4.ripple_to_best",
            ],
            [
                "compensator.both.map_told.s4.ripple_to_best",
                "compensator.both.map_learnt.s4.ripple_to_best",
                "compensator.both.map_absent.s4.ripple_to_best",
            ],
        ],
    ),
];

/// Metric of each scenario, and its name in figures.
const METRICS: [(Scenario, Metric, &str); SCENARIOS.len()] = [
    (Scenario::S2, Metric::Error, "s2.rms_to_b0"),
    (Scenario::S3, Metric::MoveVibration, "s3.vibration_to_b0"),
    (Scenario::S4, Metric::Ripple, "s4.ripple_to_b0"),
];

/// The metric of a run; infinite of one under which the plant diverged.
fn of(results: &RunResults, scenario: Scenario, metric: Metric) -> f64 {
    results[place(scenario)].as_ref().map_or(f64::INFINITY, |result| result.metric(scenario, metric).abs())
}

impl Claim {
    fn value(&self, outcome: &Outcome, map: Map, sensors: SensorSet) -> f64 {
        let rivals = outcome.rivals(map);
        let reference = match self.reference {
            Reference::B0 => of(&rivals[0], self.scenario, self.metric),
            Reference::Best => best(rivals, sensors, self.scenario, self.metric),
        };
        of(outcome.ours(map, sensors), self.scenario, self.metric) / reference
    }

    fn figure(&self, outcomes: &[Outcome], map: Map, sensors: SensorSet) -> Figure {
        let name = self.names[sensors as usize][map as usize];
        let values = outcomes.iter().map(|outcome| (outcome, self.value(outcome, map, sensors)));
        match self.reference {
            Reference::B0 => worst(values).map_or_else(
                || bounds::figure(name, f64::NAN),
                |(sample, value)| of_sample(bounds::figure(name, value), sample),
            ),
            Reference::Best => {
                let figure = bounds::figure(name, median(values.map(|(_, value)| value)));
                // The median of a few plants is no claim.
                if outcomes.len() < SAMPLES as usize { figure.without_bound() } else { figure }
            }
        }
    }
}

/// The largest value with its sample; NaN is larger than any.
fn worst<'a>(values: impl Iterator<Item = (&'a Outcome, f64)>) -> Option<(&'a Outcome, f64)> {
    values.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
}

fn of_sample(figure: Figure, sample: &Outcome) -> Figure {
    figure.of_seed(sample.seed).of_noise(sample.realisation)
}

/// Every figure: the claims, the rivals with a map over B0, and what the map brings to each controller.
pub(super) fn figures(outcomes: &[Outcome]) -> Vec<Figure> {
    let mut figures = Vec::new();
    for sensors in SensorSet::ALL {
        for map in Map::ALL {
            figures.extend(CLAIMS.iter().map(|claim| claim.figure(outcomes, map, sensors)));
        }
    }
    for (place, rival) in mapped_rivals() {
        for map in [Map::Told, Map::Absent] {
            let over_b0 = |(scenario, metric, name): (Scenario, Metric, &str)| {
                let ratio = |outcome: &Outcome| {
                    let rivals = outcome.rivals(map);
                    of(&rivals[place], scenario, metric) / of(&rivals[0], scenario, metric)
                };
                let name = format!("compensator.{rival}.{}.{name}", map.name());
                let (sample, value) = worst(outcomes.iter().map(|outcome| (outcome, ratio(outcome))))?;
                Some(of_sample(Figure::reported(name, value, "1"), sample))
            };
            figures.extend(METRICS.into_iter().filter_map(over_b0));
        }
    }
    for sensors in SensorSet::ALL {
        figures.extend(brought(outcomes, sensors.name(), |outcome, map| outcome.ours(map, sensors)));
    }
    for (place, rival) in mapped_rivals() {
        figures.extend(brought(outcomes, rival, |outcome, map| &outcome.rivals(map)[place]));
    }
    figures
}

/// What the map brings to a controller: each metric with it over that without, in the median.
fn brought<'a>(
    outcomes: &'a [Outcome],
    who: &str,
    results: impl Fn(&'a Outcome, Map) -> &'a RunResults,
) -> Vec<Figure> {
    let ratio = |(scenario, metric, _): (Scenario, Metric, &str)| {
        let ratios = outcomes.iter().map(|outcome| {
            let [told, absent] =
                [Map::Told, Map::Absent].map(|map| of(results(outcome, map), scenario, metric));
            told / absent
        });
        let name = format!("compensator.{who}.map_brings.{}", scenario.name());
        Figure::reported(name, median(ratios), "1")
    };
    METRICS.into_iter().map(ratio).collect()
}

/// Those of the rivals that put the map in advance, by their place.
fn mapped_rivals() -> impl Iterator<Item = (usize, &'static str)> {
    let mapped = [Kind::B2, Kind::B3].map(Kind::name);
    RIVALS.iter().map(|rival| rival.name).enumerate().filter(move |(_, name)| mapped.contains(name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::robustness::{JUDGED, RunResult};

    #[test]
    fn every_row_has_its_bound_and_is_named_after_its_state() {
        for claim in CLAIMS {
            for (sensors, names) in SensorSet::ALL.into_iter().zip(claim.names) {
                for (map, name) in Map::ALL.into_iter().zip(names) {
                    assert!(bounds::find(name).is_some(), "{name}");
                    assert!(name.contains(sensors.name()) && name.contains(map.name()), "{name}");
                }
            }
        }
    }

    /// Every run of a controller has the same metrics.
    fn results(metric: f64) -> RunResults {
        let mut results = RunResults::default();
        for (result, scenario) in results.iter_mut().zip(JUDGED) {
            let metrics = vec![metric; crate::verify::robustness::metrics(scenario).len()];
            *result = Some(RunResult { metrics, ..RunResult::default() });
        }
        results
    }

    fn outcome(seed: u64, ours: [f64; 3]) -> Outcome {
        let rivals = |b3| [8.0, 6.0, 4.0, b3].map(results).to_vec();
        Outcome {
            seed,
            realisation: 1,
            rivals: [rivals(1.0), rivals(2.0)],
            compensated: ours.map(|metric| [results(metric), results(metric)]),
        }
    }

    /// The best rival has the same map, and reads no more.
    #[test]
    fn a_claim_is_judged_beside_rivals_with_the_same_map() {
        let outcomes = [outcome(10_000, [1.0, 2.0, 3.0]), outcome(10_001, [2.0, 4.0, 6.0])];
        let figures = figures(&outcomes);
        let value = |name: &str| {
            let figure = figures.iter().find(|figure| figure.name == format!("compensator.{name}"));
            figure.unwrap_or_else(|| panic!("{name}")).value
        };
        assert_eq!(value("motor.map_told.s2.rms_to_b0"), 0.25);
        assert_eq!(value("motor.map_absent.s4.ripple_to_b0"), 0.75);
        assert_eq!(value("motor.map_learnt.s3.vibration_to_best"), 0.75);
        assert_eq!(value("both.map_told.s2.rms_to_best"), 1.5);
        assert_eq!(value("both.map_learnt.s2.rms_to_best"), 1.5);
        assert_eq!(value("b3.map_absent.s2.rms_to_b0"), 0.25);
        assert_eq!(value("both.map_brings.s2"), 1.0 / 3.0);
        assert_eq!(value("b3.map_brings.s4"), 0.5);
        let worst = figures.iter().find(|figure| figure.name == "compensator.motor.map_told.s2.rms_to_b0");
        assert!(worst.is_some_and(|figure| (figure.seed, figure.noise) == (Some(10_001), Some(1))));
    }
}
