//! Summary of the joints' runs.

use strainwave::compensator::Mode;

use super::{Outcome, Run, bounded, name};
use crate::bench::scenario::Scenario;
use crate::io::figure::{Figure, number};
use crate::io::gear_file::SensorSet;
use crate::plant::unknowns::Which;
use crate::verify::Measured;
use crate::verify::bounds;
use crate::verify::judge::Metric;
use crate::verify::robustness::{COUNT, JUDGED, Oscillation};

/// Everything that ran.
#[derive(Clone, Debug)]
pub struct Report {
    /// By what the plants differ from their joints' gear files.
    pub unknown: Which,
    /// A joint each.
    pub outcomes: Vec<Outcome>,
}

/// Counts of some runs, and ratios of their output error to the best baseline's.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::verify) struct Tally {
    pub(in crate::verify) runs: usize,
    pub(in crate::verify) shakes: usize,
    pub(in crate::verify) worse: usize,
    limited: usize,
    stopped: usize,
    /// Of all runs, and of those in which ours or the best baseline's error is above a count.
    ratios: Ratios,
    above_count: Ratios,
}

/// Ratios of errors, from the smallest on.
#[derive(Clone, Debug, Default, PartialEq)]
struct Ratios(Vec<f64>);

impl FromIterator<f64> for Ratios {
    fn from_iter<I: IntoIterator<Item = f64>>(ratios: I) -> Self {
        let mut ratios: Vec<_> = ratios.into_iter().collect();
        ratios.sort_by(f64::total_cmp);
        Self(ratios)
    }
}

impl Ratios {
    /// The ratio that this fraction of the runs does not exceed; NaN of none.
    fn quantile(&self, fraction: f64) -> f64 {
        let place = (fraction * self.0.len() as f64).ceil() as usize;
        self.0.get(place.saturating_sub(1)).copied().unwrap_or(f64::NAN)
    }
}

impl Run<'_> {
    /// In which way it oscillates at rest; one that diverged does, also where B0 does.
    fn shake(&self) -> Option<Oscillation> {
        match (self.ours, self.b0) {
            (Some(ours), Some(b0)) => ours.oscillates(b0),
            (None, _) => Some(Oscillation::Diverged),
            (Some(_), None) => None,
        }
    }

    fn is_worse(&self) -> bool {
        match (self.ours, &self.best) {
            (Some(ours), Some(best)) => ours.is_worse(best),
            (None, best) => best.is_some(),
            (Some(_), None) => false,
        }
    }

    fn is_limited(&self) -> bool {
        matches!((self.ours, self.b0), (Some(ours), Some(b0)) if ours.is_limited(b0))
    }

    pub(in crate::verify) fn is_stopped(&self) -> bool {
        self.ours.is_some_and(|ours| ours.mode == Mode::Safe)
    }

    /// Output error, and that of the best baseline (rad): infinite where it diverged.
    fn errors(&self, scenario: Scenario) -> [f64; 2] {
        [self.ours, self.best.as_ref()]
            .map(|result| result.map_or(f64::INFINITY, |result| result.metric(scenario, Metric::Error)))
    }
}

impl Tally {
    pub(in crate::verify) fn of<'a>(runs: impl Iterator<Item = (Scenario, Run<'a>)>) -> Self {
        let (mut tally, mut errors) = (Self::default(), Vec::new());
        for (scenario, run) in runs {
            tally.runs += 1;
            tally.shakes += usize::from(run.shake().is_some());
            tally.worse += usize::from(run.is_worse());
            tally.limited += usize::from(run.is_limited());
            tally.stopped += usize::from(run.is_stopped());
            errors.push(run.errors(scenario));
        }
        let ratio = |[ours, best]: &[f64; 2]| if ours.is_finite() { ours / best } else { f64::INFINITY };
        tally.ratios = errors.iter().map(ratio).collect();
        tally.above_count = errors.iter().filter(|[ours, best]| ours.max(*best) > COUNT).map(ratio).collect();
        tally
    }

    fn cells(&self, name: String) -> Vec<String> {
        let counts = [self.runs, self.shakes, self.worse, self.limited, self.stopped].map(|n| n.to_string());
        let ratios = [0.5, 0.95, 1.0].map(|fraction| number(self.ratios.quantile(fraction)));
        [name].into_iter().chain(counts).chain(ratios).collect()
    }
}

impl Report {
    fn runs(
        &self,
        sensors: Option<SensorSet>,
        of: Option<Scenario>,
    ) -> impl Iterator<Item = (Scenario, Run<'_>)> {
        let outcomes =
            self.outcomes.iter().filter(move |outcome| sensors.is_none_or(|set| set == outcome.sensors()));
        outcomes.flat_map(move |outcome| {
            let places =
                JUDGED.iter().enumerate().filter(move |(_, scenario)| of.is_none_or(|of| of == **scenario));
            places.map(move |(place, scenario)| (*scenario, outcome.run(place)))
        })
    }

    /// The figures with their bounds.
    pub fn figures(&self) -> Vec<Figure> {
        let all = Tally::of(self.runs(None, None));
        let refused = self.outcomes.iter().filter(|outcome| outcome.refused.is_some()).count();
        let excluded: usize = self.outcomes.iter().map(Outcome::excluded).sum();
        let reported = |figure: &str, value, unit| Figure::reported(name(figure, self.unknown), value, unit);
        let bounded = |rows, value| bounded(rows, self.unknown, value);
        let error = |row: &str, value| {
            if self.unknown == Which::BOX { bounds::figure(row, value) } else { reported(row, value, "1") }
        };
        let mut figures = vec![
            bounded(["catalogue.refused", "catalogue.unknown.refused"], refused as f64),
            bounded(["catalogue.shakes", "catalogue.unknown.shakes"], all.shakes as f64),
            bounded(["catalogue.worse", "catalogue.unknown.worse"], all.worse as f64),
            bounded(["catalogue.stopped", "catalogue.unknown.stopped"], all.stopped as f64),
            error("catalogue.error.median", all.ratios.quantile(0.5)),
            error("catalogue.error.p95", all.ratios.quantile(0.95)),
            reported("catalogue.limited", all.limited as f64, "run"),
            reported("catalogue.excluded", excluded as f64, "run"),
            reported("catalogue.above_count.runs", all.above_count.0.len() as f64, "run"),
            reported("catalogue.above_count.median", all.above_count.quantile(0.5), "1"),
            reported("catalogue.above_count.p95", all.above_count.quantile(0.95), "1"),
        ];
        for sensors in SensorSet::ALL {
            let set = Tally::of(self.runs(Some(sensors), None));
            let error = |what: &str, value| {
                reported(&format!("catalogue.{}.error.{what}", sensors.name()), value, "1")
            };
            figures
                .extend([error("median", set.ratios.quantile(0.5)), error("p95", set.ratios.quantile(0.95))]);
        }
        figures
    }

    /// One line for each set of sensors and scenario, the header first.
    pub fn table(&self) -> Vec<Vec<String>> {
        let header = ["runs", "", "shake", "worse", "limited", "stopped", "median", "p95", "max"];
        let mut rows = vec![header.map(String::from).to_vec()];
        for sensors in SensorSet::ALL {
            for scenario in JUDGED.map(Some).into_iter().chain([None]) {
                let name = format!("{} {}", sensors.name(), scenario.map_or("all", Scenario::name));
                rows.push(Tally::of(self.runs(Some(sensors), scenario)).cells(name));
            }
        }
        rows
    }

    /// The worst joints, a line each: those with most runs that shake, then that are worse, then by the largest error.
    pub fn worst(&self, count: usize) -> Vec<String> {
        let mut ranked: Vec<_> = self.outcomes.iter().map(|outcome| (outcome.rank(), outcome)).collect();
        ranked.sort_by(|a, b| (b.0.0, b.0.1).cmp(&(a.0.0, a.0.1)).then(b.0.2.total_cmp(&a.0.2)));
        ranked.into_iter().take(count).map(|(_, outcome)| outcome.line()).collect()
    }

    /// The figures, with notes on the worst joints.
    pub fn measured(&self, named: usize) -> Measured {
        Measured { figures: self.figures(), notes: self.worst(named) }
    }
}

impl Outcome {
    /// Runs that shake, runs that are worse, the largest ratio of errors.
    fn rank(&self) -> (usize, usize, f64) {
        let all = Tally::of(self.runs());
        (all.shakes, all.worse, all.ratios.quantile(1.0))
    }

    pub(in crate::verify) fn runs(&self) -> impl Iterator<Item = (Scenario, Run<'_>)> {
        JUDGED.into_iter().enumerate().map(|(place, scenario)| (scenario, self.run(place)))
    }

    /// The joint, and of each scenario the metrics against the best baseline's (urad), what is wrong and which faults were named.
    fn line(&self) -> String {
        if let Some(error) = self.refused {
            return format!("{}: refused, {error}", self.joint.describe());
        }
        let runs: Vec<_> = self.runs().map(|(scenario, run)| run.line(scenario)).collect();
        format!("{}: {}", self.joint.describe(), runs.join("; "))
    }
}

impl Run<'_> {
    fn line(&self, scenario: Scenario) -> String {
        let Some(ours) = self.ours else { return format!("{} diverged", scenario.name()) };
        let best = self.best.iter().flat_map(|best| &best.metrics);
        let both = |(ours, best): (&f64, &f64)| format!("{:.1}/{:.1}", 1e6 * ours, 1e6 * best);
        let mut words = vec![scenario.name().to_owned()];
        words.extend(ours.metrics.iter().zip(best).map(both));
        words.extend(self.shake().map(|shake| format!("shakes/{}", shake.name())));
        words.extend(self.is_worse().then(|| "worse".to_owned()));
        words.extend(self.is_limited().then(|| "limited".to_owned()));
        words.extend(self.is_stopped().then(|| "stopped".to_owned()));
        let faults: Vec<_> = ours.faults.names().collect();
        if !faults.is_empty() {
            words.push(format!("({})", faults.join(", ")));
        }
        words.join(" ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::robustness::RunResult;

    fn result(metrics: &[f64]) -> RunResult {
        RunResult { metrics: metrics.to_vec(), ..RunResult::default() }
    }

    fn run<'a>(ours: Option<&'a RunResult>, best: &'a RunResult) -> Run<'a> {
        Run { ours, b0: Some(best), best: Some(best.clone()) }
    }

    #[test]
    fn a_run_is_judged_by_the_best_of_the_baselines() {
        let (good, bad, best) = (result(&[1e-3]), result(&[2e-3]), result(&[1e-3]));
        assert!(!run(Some(&good), &best).is_worse() && run(Some(&bad), &best).is_worse());
        assert!(run(None, &best).is_worse() && run(None, &best).shake() == Some(Oscillation::Diverged));
        assert_eq!(run(Some(&bad), &best).errors(Scenario::S2), [2e-3, 1e-3]);
    }

    /// A metric that neither has counts for nothing; one that ours alone lacks counts.
    #[test]
    fn what_cannot_be_told_counts_for_nothing() {
        let (none, some) = (result(&[1e-3, f64::NAN]), result(&[1e-3, 1e-3]));
        assert!(!run(Some(&none), &none).is_worse());
        assert!(run(Some(&none), &some).is_worse());
    }

    #[test]
    fn a_share_of_the_runs_does_not_exceed_its_quantile() {
        let ratios: Ratios = (1..=100).rev().map(f64::from).collect();
        assert_eq!([0.5, 0.95, 1.0].map(|fraction| ratios.quantile(fraction)), [50.0, 95.0, 100.0]);
        assert!(Ratios::default().quantile(0.5).is_nan());
    }

    /// A ratio of two errors that an encoder does not show stands apart; one that diverged does not.
    #[test]
    fn errors_below_a_count_stand_apart() {
        let [fine, finer, coarse] = [2e-6, 1e-6, 2e-5].map(|error| result(&[error]));
        let runs = [(Some(&fine), &finer), (Some(&coarse), &fine), (Some(&fine), &coarse), (None, &fine)];
        let tally = Tally::of(runs.into_iter().map(|(ours, best)| (Scenario::S2, run(ours, best))));
        assert_eq!(tally.ratios.0.len(), 4);
        let above: Vec<_> = tally.above_count.0.iter().map(|ratio| (1e3 * ratio).round()).collect();
        assert_eq!(above, [100.0, 10_000.0, f64::INFINITY]);
    }
}
