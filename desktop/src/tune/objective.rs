//! Objective that the baselines are tuned by: one for all, on training plants.
//!
//! ```text
//! ln J = mean over plants and scenarios of (1/n)*sum_k ln sqrt(x_k^2 + f^2)  +  bad*ln 2  +  lost
//! ```
//!
//! x_k are the n figures of a scenario, each in rad, J their geometric mean:
//!
//! | scenario | figures |
//! | --- | --- |
//! | S1 | residual vibration of the torsion |
//! | S2 | rms output error |
//! | S3 | residual vibration of the torsion, rms output error after the move |
//! | S4 | ripple of the output error, rms output error |
//! | S5 | peak and steady output error |
//!
//! Claims name one figure each, so no figure may be paid for by another: lost is the sum, over the figures that are on
//! average over the plants larger than the untuned baseline's, of the mean of ln(x/x_untuned).
//!
//! They are the metrics of [`crate::verify::judge`]. f = 1 urad: less than that gains next to nothing. Every bad run doubles J: one
//! under which the plant diverges (its figures then count as [`LOST`]) or which keeps oscillating at rest or stays at its
//! torque limit where the untuned B0 on the same plant does not ([`RunResult::oscillates`], [`RunResult::is_limited`]).
//!
//! Half of the training plants, the even seeds, have every unknown at once ([`crate::plant::unknowns`]); the others are the
//! box alone. On joints of the catalogue ([`crate::catalogue::joints`]), whose loads and encoders differ, the gains are
//! those that the rule of [`crate::catalogue::load`] makes of them for each load. On each the untuned B0 has worked ([`crate::bench::working_motion`]) before; the baseline takes over at rest and has
//! a [`Rest`] to settle.

use std::thread;

use strainwave::gear::GearParams;

use crate::bench::baseline::{Baseline, BaselineGains, Kind};
use crate::bench::scenario::{Rest, Scenario};
use crate::bench::task::Demand;
use crate::bench::working_motion::WorkingMotion;
use crate::bench::{Bench, Conditions};
use crate::io::gear_file::GearFile;
use crate::io::gear_file::SensorSet;
use crate::plant::CondensedMesh;
use crate::plant::divergence::RunError;
use crate::plant::sample::PlantSample;
use crate::plant::unknowns::Which;
use crate::verify::baselines::{FIGURES, FigureOf};
use crate::verify::robustness::{JUDGED, Judged, RunResult, RunResults};

/// f (rad).
const FLOOR: f64 = 1e-6;
/// Value of a figure where the plant diverged (rad).
pub const LOST: f64 = 1.0;

/// ln sqrt(x^2 + f^2) of a figure of a run; none where the plant diverged.
fn logarithm((scenario, metric, _): &FigureOf, result: Option<&RunResult>) -> f64 {
    let value = result.map_or(LOST, |result| result.metric(*scenario, *metric));
    if value.is_finite() { value.hypot(FLOOR).ln() } else { LOST.ln() }
}

/// Mean over the plants of the logarithm of each figure.
fn logarithms(runs: &[RunResults]) -> [f64; FIGURES.len()] {
    FIGURES.map(|figure| {
        let place = JUDGED.iter().position(|scenario| *scenario == figure.0);
        let of = |run: &RunResults| logarithm(&figure, place.and_then(|place| run[place].as_ref()));
        runs.iter().map(of).sum::<f64>() / runs.len() as f64
    })
}

/// Mean over the scenarios of the mean of each one's figures.
fn mean(logarithms: &[f64; FIGURES.len()]) -> f64 {
    let of = |scenario| {
        let own = FIGURES.iter().zip(logarithms).filter(|(figure, _)| figure.0 == scenario);
        let (sum, count) = own.fold((0.0, 0.0), |(sum, count), (_, value)| (sum + value, count + 1.0));
        sum / count
    };
    JUDGED.map(of).iter().sum::<f64>() / JUDGED.len() as f64
}

/// lost
fn lost(logarithms: &[f64; FIGURES.len()], untuned: &[f64; FIGURES.len()]) -> f64 {
    logarithms.iter().zip(untuned).map(|(ours, untuned)| (ours - untuned).max(0.0)).sum()
}

/// A run is bad against that of the untuned B0; one that the B0 loses cannot be judged.
fn is_bad(result: Option<&RunResult>, b0: Option<&RunResult>) -> bool {
    match (result, b0) {
        (Some(result), Some(b0)) => result.oscillates(b0).is_some() || result.is_limited(b0),
        (result, _) => result.is_none(),
    }
}

/// A joint on the bench that has worked.
struct Stand {
    /// Nominal gear of its controller, and the plant's true parameters.
    known: GearFile,
    plant: GearParams<f64>,
    bench: Bench<CondensedMesh>,
}

impl Stand {
    /// # Errors
    /// A gear that cannot be built.
    fn build(sample: PlantSample, sensors: SensorSet) -> Result<Self, RunError> {
        let conditions = Conditions { sensors, ..Conditions::of(&sample.known, sample.seed) };
        let mut bench = Bench::condensed_of(&sample, &conditions)?;
        let mut b0 = untuned(&sample.known, Kind::B0)?;
        bench.go(&WorkingMotion, &mut b0, |_, _, _, _| ())?;
        Ok(Self { plant: sample.params, known: sample.known, bench })
    }

    /// A baseline in one scenario; none where the plant diverges.
    fn run(&self, baseline: &Baseline, scenario: Scenario) -> Result<Option<RunResult>, RunError> {
        let (mut bench, mut baseline) = (self.bench.clone(), baseline.clone());
        let judged = Judged::of(&self.known, &self.plant);
        let rest = Rest { from: Demand::default(), natural_period: 0.0 };
        let settled = bench.go(&rest, &mut baseline, |_, _, _, _| ());
        match settled.and_then(|()| judged.result(bench, baseline, scenario)) {
            Ok(result) => Ok(Some(result)),
            Err(RunError::Diverged(_)) => Ok(None),
            Err(error) => Err(error),
        }
    }
}

/// The training plant of a seed.
///
/// # Errors
/// A gear that no plant can be built for.
pub fn training_plant(file: &GearFile, seed: u64) -> Result<PlantSample, strainwave::Error> {
    if seed.is_multiple_of(2) {
        PlantSample::of(file, Which::All, seed)
    } else {
        PlantSample::boxed(file, seed)
    }
}

fn untuned(file: &GearFile, kind: Kind) -> Result<Baseline, strainwave::Error> {
    Baseline::with_gains(file, kind, &BaselineGains::untuned(file, kind))
}

/// The objective of one baseline.
pub struct Objective {
    kind: Kind,
    /// The joint that the gains are of.
    file: GearFile,
    stands: Vec<Stand>,
    /// The untuned B0 on each stand in each scenario.
    b0: Vec<RunResults>,
    /// The logarithms of the untuned baseline.
    untuned: [f64; FIGURES.len()],
}

/// Score of some gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Score {
    /// Geometric mean of the figures (rad).
    pub mean: f64,
    /// Bad runs.
    pub bad: usize,
    /// Loss relative to the untuned baseline's figures.
    pub lost: f64,
}

impl Score {
    /// ln J, J in rad.
    pub fn logarithm(&self) -> f64 {
        self.mean.ln() + self.bad as f64 * 2f64.ln() + self.lost
    }
}

impl Objective {
    /// Of a baseline of this joint on these plants.
    ///
    /// # Errors
    /// A gear that no plant or baseline can be built for, or one that the untuned B0 loses.
    pub fn build(
        file: &GearFile,
        kind: Kind,
        plants: impl IntoIterator<Item = PlantSample>,
    ) -> Result<Self, RunError> {
        let stands = plants.into_iter().map(|plant| Stand::build(plant, kind.sensors()));
        let stands = stands.collect::<Result<_, _>>()?;
        let file = file.clone();
        let mut objective = Self { kind, file, stands, b0: Vec::new(), untuned: [0.0; FIGURES.len()] };
        objective.b0 = objective.results(&|file| Ok(untuned(file, Kind::B0)?))?;
        objective.untuned = logarithms(&objective.results(&|file| Ok(untuned(file, kind)?))?);
        Ok(objective)
    }

    /// Score of these gains.
    ///
    /// # Errors
    /// Gains that no baseline can be built with.
    pub fn score(&self, gains: &BaselineGains) -> Result<Score, RunError> {
        let build = |known: &GearFile| -> Result<Baseline, RunError> {
            let gains = gains.carried_over(self.kind, &self.file, known);
            Ok(Baseline::with_gains(known, self.kind, &gains)?)
        };
        let results = self.results(&build)?;
        let pairs = results.iter().flatten().zip(self.b0.iter().flatten());
        let bad = pairs.filter(|(run, b0)| is_bad(run.as_ref(), b0.as_ref())).count();
        let found = logarithms(&results);
        Ok(Score { mean: mean(&found).exp(), bad, lost: lost(&found, &self.untuned) })
    }

    /// Stand by stand, on two threads.
    fn results(
        &self,
        build: &(dyn Fn(&GearFile) -> Result<Baseline, RunError> + Sync),
    ) -> Result<Vec<RunResults>, RunError> {
        let on = |stand: &Stand| -> Result<RunResults, RunError> {
            let baseline = build(&stand.known)?;
            let mut results = RunResults::default();
            for (result, scenario) in results.iter_mut().zip(JUDGED) {
                *result = stand.run(&baseline, scenario)?;
            }
            Ok(results)
        };
        let (first, second) = self.stands.split_at(self.stands.len() / 2);
        thread::scope(|scope| {
            let first = scope.spawn(|| first.iter().map(on).collect::<Vec<_>>());
            let second: Vec<_> = second.iter().map(on).collect();
            let first = first.join().expect("a run does not panic");
            first.into_iter().chain(second).collect()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A run of S2 with this error.
    fn result(error: f64) -> RunResult {
        RunResult { metrics: vec![error], ..RunResult::default() }
    }

    #[test]
    fn a_figure_has_a_floor() {
        let of = |result: Option<&RunResult>| logarithm(&FIGURES[1], result).exp();
        assert!((of(Some(&result(1e-3))) / 1e-3 - 1.0).abs() < 1e-6);
        assert!((of(Some(&result(0.0))) / 1e-6 - 1.0).abs() < 1e-6);
        // What is no number is as bad as a plant that is lost.
        assert!((of(Some(&result(f64::NAN))) - LOST).abs() < 1e-9 && (of(None) - LOST).abs() < 1e-9);
    }

    /// Every scenario counts alike, and half of S5 is the peak.
    #[test]
    fn the_mean_is_of_scenarios() {
        let at = |place: usize| mean(&std::array::from_fn(|k| f64::from(u8::from(k == place))));
        assert!((at(1) - 0.2).abs() < 1e-12 && (at(6) - 0.1).abs() < 1e-12);
    }

    #[test]
    fn what_is_lost_is_not_made_up_for() {
        let untuned = [0.0; FIGURES.len()];
        let mut tuned = untuned;
        (tuned[0], tuned[1]) = (-5.0, 0.3);
        assert!((lost(&tuned, &untuned) - 0.3).abs() < 1e-12 && lost(&untuned, &untuned) == 0.0);
    }

    #[test]
    fn what_shakes_or_diverges_is_bad_and_doubles() {
        let (good, shaking) = (result(1e-4), RunResult { torsion_at_rest: 1e-4, ..result(1e-4) });
        let bad = |ours: Option<&RunResult>| is_bad(ours, Some(&good));
        assert_eq!([bad(Some(&good)), bad(Some(&shaking)), bad(None)], [false, true, true]);
        assert_eq!(Score { mean: 1.0, bad: 2, lost: 0.0 }.logarithm(), 4f64.ln());
    }

    #[test]
    fn every_scenario_has_a_figure() {
        for scenario in JUDGED {
            assert!(FIGURES.iter().any(|figure| figure.0 == scenario));
        }
    }
}
