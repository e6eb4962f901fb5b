//! Metrics of each baseline, with its gains in the gear file, on plants of the box and after the working motion.
//!
//! For each baseline the median of every figure of [`FIGURES`] over the plants, the worst ratio to B0's,
//! and how much it shakes: the worst oscillation of torsion and torque at rest ([`RunResult`]).

use strainwave::Error;

use crate::bench::baseline::{Baseline, Kind};
use crate::bench::scenario::Scenario;
use crate::bench::{Bench, Conditions};
use crate::io::figure::Figure;
use crate::io::gear_file::GearFile;
use crate::plant::sample::PlantSample;
use crate::verify::Measured;
use crate::verify::compensator::each;
use crate::verify::judge::Metric;
use crate::verify::robustness::{JUDGED, Judged, RunResult, RunResults};

/// A figure: the scenario, the metric and its name.
pub type FigureOf = (Scenario, Metric, &'static str);

/// Figures of the objective.
pub const FIGURES: [FigureOf; 8] = [
    (Scenario::S1, Metric::StepVibration, "s1.vibration"),
    (Scenario::S2, Metric::Error, "s2.error"),
    (Scenario::S3, Metric::MoveVibration, "s3.vibration"),
    (Scenario::S3, Metric::Error, "s3.error"),
    (Scenario::S4, Metric::Ripple, "s4.ripple"),
    (Scenario::S4, Metric::Error, "s4.error"),
    (Scenario::S5, Metric::Peak, "s5.peak"),
    (Scenario::S5, Metric::Steady, "s5.steady"),
];

/// Runs each baseline on the plants of seeds 1 to `plants`; `progress` is called with the fraction done.
///
/// # Errors
/// A gear that no plant or baseline can be built for.
pub fn measure(file: &GearFile, plants: u64, mut progress: impl FnMut(f64)) -> Result<Measured, Error> {
    let all: Vec<_> = Kind::ALL.iter().flat_map(|kind| (1..=plants).map(move |seed| (*kind, seed))).collect();
    let run = |(kind, seed): &(Kind, u64)| -> Result<RunResults, Error> {
        let sample = PlantSample::boxed(file, *seed)?;
        let conditions = Conditions { sensors: kind.sensors(), ..Conditions::of(file, *seed) };
        let bench = Bench::condensed_of(&sample, &conditions)?;
        Judged::of(file, &sample.params).results(bench, Baseline::build(file, *kind)?, &JUDGED)
    };
    let results = each(&all, run, &mut progress).into_iter().collect::<Result<Vec<_>, _>>()?;
    let b0 = &results[..plants as usize];
    let by_kind = Kind::ALL.into_iter().zip(results.chunks(plants as usize));
    Ok(by_kind.flat_map(|(kind, runs)| figures(kind, runs, b0)).collect::<Vec<_>>().into())
}

/// The figures of one baseline, plant by plant.
fn figures(kind: Kind, runs: &[RunResults], b0: &[RunResults]) -> Vec<Figure> {
    let name = |what: &str| format!("baselines.{}.{what}", kind.name());
    let mut figures = Vec::new();
    for (scenario, metric, what) in FIGURES {
        let of = |run: &RunResults| of(run, scenario.name(), |result| result.metric(scenario, metric));
        let values: Vec<_> = runs.iter().map(of).collect();
        figures.push(Figure::reported(name(what), median(&values), "rad"));
        if kind != Kind::B0 {
            let ratios = values.iter().zip(b0).map(|(value, b0)| value / of(b0));
            figures.push(worst(name(&format!("{what}.to_b0")), "1", ratios));
        }
    }
    for (what, unit, at_rest) in AT_REST {
        let most = |run: &RunResults| {
            run.iter().map(|run| run.as_ref().map_or(f64::NAN, at_rest)).fold(0.0, f64::max)
        };
        figures.push(worst(name(what), unit, runs.iter().map(most)));
    }
    figures
}

type OfResult = (&'static str, &'static str, fn(&RunResult) -> f64);

/// Oscillation at rest; of the torque in rated torques.
const AT_REST: [OfResult; 2] =
    [("rest.torsion", "rad", |run| run.torsion_at_rest), ("rest.torque", "1", |run| run.torque_at_rest)];

/// Of a run's scenario; NaN where the plant diverged.
fn of(run: &RunResults, scenario: &str, of: impl Fn(&RunResult) -> f64) -> f64 {
    let place = JUDGED.iter().position(|judged| judged.name() == scenario);
    place.and_then(|place| run[place].as_ref()).map_or(f64::NAN, of)
}

/// The largest of the plants', with its seed.
fn worst(name: String, unit: &str, values: impl Iterator<Item = f64>) -> Figure {
    let worst = values.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
    let (plant, value) = worst.unwrap_or((0, f64::NAN));
    Figure::reported(name, value, unit).of_seed(plant as u64 + 1)
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let half = sorted.len() / 2;
    match sorted.len() {
        0 => f64::NAN,
        count if count.is_multiple_of(2) => 0.5 * (sorted[half - 1] + sorted[half]),
        _ => sorted[half],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_in_the_middle_and_the_worst_has_its_seed() {
        assert_eq!([median(&[3.0, 1.0, 2.0]), median(&[4.0, 1.0, 3.0, 2.0])], [2.0, 2.5]);
        assert!(median(&[]).is_nan());
        let worst = worst("a".into(), "1", [1.0, 3.0, 2.0].into_iter());
        assert_eq!((worst.value, worst.seed), (3.0, Some(2)));
    }

    #[test]
    fn a_figure_is_of_its_scenario() {
        let mut run = RunResults::default();
        run[1] = Some(RunResult { metrics: vec![5.0], ..RunResult::default() });
        let error = |scenario: Scenario| of(&run, scenario.name(), |result| result.metrics[0]);
        assert!(error(Scenario::S2) == 5.0 && error(Scenario::S1).is_nan());
    }
}
