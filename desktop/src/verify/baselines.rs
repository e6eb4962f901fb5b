//! What each baseline reaches, with the gains that the gear file has for it, after the working motion.
//!
//! For each baseline the median of every figure of [`crate::baseline::objective`] over the plants, the worst ratio to B0's,
//! and how much it shakes: the worst vibration of torsion and torque at the end of a run.

use crate::baseline::objective::{FIGURES, Outcome, SCENARIOS, after_work};
use crate::baseline::{Baseline, Kind};
use crate::bench::Conditions;
use crate::divergence::RunError;
use crate::figure::Figure;
use crate::gear_file::GearFile;
use crate::verify::Measured;
use crate::verify::compensator::each;

/// Runs each baseline on the plants of seeds 1 to `plants`; `progress` is called with the share done.
///
/// # Errors
/// A gear that no plant or baseline can be built for.
pub fn measure(file: &GearFile, plants: u64, mut progress: impl FnMut(f64)) -> Result<Measured, RunError> {
    let all: Vec<_> = Kind::ALL.iter().flat_map(|kind| (1..=plants).map(move |seed| (*kind, seed))).collect();
    let run = |(kind, seed): &(Kind, u64)| {
        let conditions = Conditions { sensors: kind.sensors(), ..Conditions::of(file, *seed) };
        after_work(file, &conditions, &Baseline::build(file, *kind)?)
    };
    let outcomes = each(&all, run, &mut progress).into_iter().collect::<Result<Vec<_>, _>>()?;
    let mut by_kind = outcomes.chunks(plants as usize);
    let b0 = by_kind.clone().next().unwrap_or_default();
    let figures = Kind::ALL.into_iter().flat_map(|kind| of(kind, by_kind.next().unwrap_or_default(), b0));
    Ok(figures.collect::<Vec<_>>().into())
}

/// The figures of one baseline; plant by plant, scenario by scenario.
fn of(kind: Kind, runs: &[Vec<Outcome>], b0: &[Vec<Outcome>]) -> Vec<Figure> {
    let name = |what: &str| format!("baselines.{}.{what}", kind.name());
    let mut figures = Vec::new();
    for (place, (_, _, what)) in FIGURES.iter().enumerate() {
        let values: Vec<_> = runs.iter().map(|run| figure(run, place)).collect();
        let ratios = values.iter().zip(b0).map(|(value, b0)| value / figure(b0, place));
        let worst = ratios.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, f64::NAN));
        figures.push(Figure::reported(name(what), median(&values), "rad"));
        if kind != Kind::B0 {
            let ratio = Figure::reported(name(&format!("{what}_to_b0")), worst.1, "1");
            figures.push(ratio.of_draw(worst.0 as u64 + 1));
        }
    }
    for (what, unit, of) in ENDS {
        let worst = runs.iter().map(|run| run.iter().map(of).fold(0.0, f64::max)).enumerate();
        let (plant, worst) = worst.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, f64::NAN));
        figures.push(Figure::reported(name(what), worst, unit).of_draw(plant as u64 + 1));
    }
    figures
}

type OfEnd = (&'static str, &'static str, fn(&Outcome) -> f64);

/// What is looked at at the end of a run.
const ENDS: [OfEnd; 3] = [
    ("end.vibration", "rad", |run| run.vibration),
    ("end.torque_ripple", "N m", |run| run.torque_ripple),
    ("limited", "s", |run| run.limited),
];

/// A figure by its place in [`FIGURES`].
fn figure(run: &[Outcome], place: usize) -> f64 {
    let scenario = FIGURES[place].0;
    let before = FIGURES[..place].iter().filter(|figure| figure.0 == scenario).count();
    let at = SCENARIOS.iter().position(|other| *other == scenario);
    at.and_then(|at| run.get(at)?.figures.get(before).copied()).unwrap_or(f64::NAN)
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
    fn the_median_is_in_the_middle() {
        assert_eq!([median(&[3.0, 1.0, 2.0]), median(&[4.0, 1.0, 3.0, 2.0])], [2.0, 2.5]);
        assert!(median(&[]).is_nan());
    }

    #[test]
    fn every_figure_is_found_in_its_run() {
        let mut numbers = (0..).map(f64::from);
        let run = SCENARIOS.map(|scenario| {
            let count = FIGURES.iter().filter(|figure| figure.0 == scenario).count();
            let figures = numbers.by_ref().take(count).collect();
            Outcome { figures, vibration: 0.0, torque_ripple: 0.0, limited: 0.0 }
        });
        let found: Vec<_> = (0..FIGURES.len()).map(|place| figure(&run, place)).collect();
        assert_eq!(found, (0..FIGURES.len()).map(|place| place as f64).collect::<Vec<_>>());
    }
}
