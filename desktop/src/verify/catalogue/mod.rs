//! The compensator and the baselines on joints all over the catalogue ([`crate::catalogue`]).
//!
//! Every joint has the sensors that it was drawn with; its controllers work for 10 s, go into S1 to S5 from there, and stop
//! and rest after each, on the condensed plant. Its baselines are those that read no more: B0 to B2, and B3 where there is
//! an output encoder. Their gains are those of the joint's gear file: tuned on training joints of the same gear and carried
//! over to its load ([`crate::catalogue::load`]).
//!
//! Their plants differ from the gear files by the box, or by a row of [`crate::plant::unknowns`], or by all of them. The figures of a row are
//! named after it, as in `catalogue.drive.delay.shakes`, and have the bounds `catalogue.unknown`; errors have none there.
//!
//! | figure | definition |
//! | --- | --- |
//! | `refused` | joints that no compensator can be built for; their runs count as diverged |
//! | `shakes` | runs that diverge or keep oscillating at rest against B0 ([`RunResult::oscillates`]) |
//! | `worse` | runs of which a metric is worse than the smallest of the baselines', by more than 5 % and more than 12 urad |
//! | `error.median`, `error.p95` | rms output error of a run over the smallest of the baselines', of all runs |
//! | `limited` | runs that stay at the torque limit ([`RunResult::is_limited`]); only reported |
//! | `stopped` | runs at whose end the drive is off by a fault, of which no plant has any |
//! | `excluded` | runs of baselines that oscillate or stay at the torque limit; only reported |
//! | `above_count.median`, `above_count.p95` | as `error`, of the runs in which ours or the smallest is above 12 urad; only reported |
//!
//! A run of a baseline that keeps oscillating at rest, or stays at its torque limit, by the measure that the compensator's runs are
//! held to, is not among the baselines of that scenario: a cascade whose torque goes from limit to limit averages friction away, and no
//! drive would be left to it. `excluded` reports the number of these runs.
//!
//! A metric that neither has counts for nothing: where the load swings so slowly that a rest between two steps is shorter than
//! a period, there is no vibration to be measured.

pub(super) mod summary;

use strainwave::Error;

use crate::bench::baseline::{Baseline, Kind};
use crate::bench::controller::HostCompensator;
use crate::bench::{Bench, Conditions};
use crate::catalogue::{Joint, Set};
use crate::design::joint::joint_params;
use crate::io::figure::Figure;
use crate::io::gear_file::SensorSet;
use crate::plant::unknowns::Which;
use crate::verify::bounds;
use crate::verify::compensator::each;
use crate::verify::robustness::{JUDGED, Judged, RunResult, RunResults};
pub use summary::Report;

/// Requested joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Request {
    /// Of which joints.
    pub set: Set,
    /// Seed of the first.
    pub first: u64,
    /// Number of joints; at most those that the set has from there on.
    pub count: u64,
    /// By what their plants differ from their gear files.
    pub unknown: Which,
}

impl Request {
    /// The joints, in the order of their seeds.
    pub(super) fn joints(&self) -> Vec<Joint> {
        let seeds = self.first..self.first + self.count;
        let joints = self.set.joints().into_iter().filter(|joint| seeds.contains(&joint.seed));
        joints.map(|joint| Joint { unknown: self.unknown, ..joint }).collect()
    }
}

/// Everything that ran on one joint.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The joint.
    pub joint: Joint,
    /// Its baselines, B0 first.
    pub baselines: Vec<RunResults>,
    /// The compensator; nothing of one that was refused.
    pub compensated: RunResults,
    /// Why no compensator can be built for the joint.
    pub refused: Option<Error>,
}

/// Runs every requested joint; `progress` is called with the fraction done.
///
/// # Errors
/// A joint that no plant or baseline can be built for.
pub fn measure(request: &Request, mut progress: impl FnMut(f64)) -> Result<Report, Error> {
    let outcomes = each(&request.joints(), Outcome::of, &mut progress);
    Ok(Report { unknown: request.unknown, outcomes: outcomes.into_iter().collect::<Result<_, _>>()? })
}

/// Name of a figure such as `catalogue.limited` for joints with such plants: with all unknowns `catalogue.all.limited`.
pub(super) fn name(figure: &str, unknown: Which) -> String {
    match figure.split_once('.') {
        Some((part, what)) if unknown != Which::BOX => format!("{part}.{}.{what}", unknown.name()),
        _ => figure.to_owned(),
    }
}

/// A figure with the bound of the first row for plants of the box, of the second for all others.
pub(super) fn bounded([of_box, of_unknown]: [&str; 2], unknown: Which, value: f64) -> Figure {
    let row = if unknown == Which::BOX { of_box } else { of_unknown };
    bounds::figure_as(name(of_box, unknown), row, value)
}

impl Outcome {
    /// Of one joint.
    ///
    /// # Errors
    /// A joint that no plant or baseline can be built for.
    pub(super) fn of(joint: &Joint) -> Result<Self, Error> {
        let sample = joint.plant()?;
        let (known, sensors) = (&joint.known, SensorSet::of(&joint.known));
        let judged = Judged::of(known, &sample.params);
        let bench = |sensors| {
            let conditions = Conditions { sensors, ..Conditions::of(known, joint.seed) };
            Bench::condensed_of(&sample, &conditions)
        };
        let baselines = Kind::ALL
            .into_iter()
            .filter(|kind| sensors == SensorSet::Both || kind.sensors() == SensorSet::Motor)
            .map(|kind| judged.results(bench(kind.sensors())?, Baseline::build(known, kind)?, &JUDGED))
            .collect::<Result<_, _>>()?;
        Self { joint: joint.clone(), baselines, compensated: RunResults::default(), refused: None }.again()
    }

    /// The same joint with the same baselines, and its compensator built and run again.
    ///
    /// # Errors
    /// A joint that no plant can be built for.
    pub(super) fn again(&self) -> Result<Self, Error> {
        let (sample, known) = (self.joint.plant()?, &self.joint.known);
        let built = joint_params(known).and_then(|joint| HostCompensator::build(&joint));
        let refused = built.as_ref().err().copied();
        let compensated = match built {
            Ok(compensator) => {
                let bench = Bench::condensed_of(&sample, &Conditions::of(known, self.joint.seed))?;
                Judged::of(known, &sample.params).results(bench, compensator, &JUDGED)?
            }
            Err(_) => RunResults::default(),
        };
        Ok(Self { compensated, refused, ..self.clone() })
    }

    pub(super) fn sensors(&self) -> SensorSet {
        SensorSet::of(&self.joint.known)
    }

    /// The runs of one scenario.
    pub(super) fn run(&self, place: usize) -> Run<'_> {
        Run { ours: self.compensated[place].as_ref(), b0: self.b0(place), best: self.best(place) }
    }

    fn b0(&self, place: usize) -> Option<&RunResult> {
        self.baselines.first().and_then(|results| results[place].as_ref())
    }

    /// The baselines' runs of one scenario, each with whether it is usable: it neither oscillates nor stays at its torque limit.
    fn rivals(&self, place: usize) -> impl Iterator<Item = (&RunResult, bool)> {
        let b0 = self.b0(place);
        let usable =
            move |run: &RunResult| b0.is_none_or(|b0| run.oscillates(b0).is_none() && !run.is_limited(b0));
        self.baselines
            .iter()
            .filter_map(move |results| results[place].as_ref())
            .map(move |run| (run, usable(run)))
    }

    /// Runs of baselines that are not usable.
    fn excluded(&self) -> usize {
        (0..JUDGED.len()).flat_map(|place| self.rivals(place)).filter(|(_, usable)| !usable).count()
    }

    /// A run whose every metric is the smallest of the usable baselines'; none where all diverged.
    fn best(&self, place: usize) -> Option<RunResult> {
        let runs = self.rivals(place).filter_map(|(run, usable)| usable.then_some(run));
        runs.cloned().reduce(|best, other| RunResult {
            metrics: best.metrics.iter().zip(&other.metrics).map(|(a, b)| a.min(*b)).collect(),
            ..best
        })
    }
}

/// The compensator in one scenario, against the baselines; none of what diverged.
pub(super) struct Run<'a> {
    pub(super) ours: Option<&'a RunResult>,
    b0: Option<&'a RunResult>,
    best: Option<RunResult>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use strainwave::compensator::{Faults, Mode};

    fn result(metrics: &[f64]) -> Option<RunResult> {
        Some(RunResult { metrics: metrics.to_vec(), ..RunResult::default() })
    }

    fn outcome(baselines: [Option<RunResult>; 2], ours: Option<RunResult>) -> Outcome {
        let joint = Set::Judged.joints().swap_remove(0);
        let of = |result| [result, None, None, None, None];
        Outcome { joint, baselines: baselines.map(of).to_vec(), compensated: of(ours), refused: None }
    }

    #[test]
    fn the_best_has_every_mark_at_its_smallest() {
        let best = |baselines| outcome(baselines, None).best(0).map(|best| best.metrics);
        assert_eq!(best([result(&[1.0, 4.0]), result(&[2.0, 3.0])]), Some(vec![1.0, 3.0]));
        assert_eq!(best([None, result(&[2.0, 3.0])]), Some(vec![2.0, 3.0]));
        assert_eq!(best([None, None]), None);
    }

    #[test]
    fn a_baseline_that_oscillates_or_stays_at_its_limit_is_not_among_the_best() {
        let steady = result(&[2.0]);
        let other = |change: fn(&mut RunResult)| {
            let mut run = result(&[1.0]).unwrap();
            change(&mut run);
            outcome([steady.clone(), Some(run)], None)
        };
        let best = |outcome: &Outcome| outcome.best(0).map(|best| best.metrics[0]);
        for unusable in [other(|run| run.torque_at_rest = 0.1), other(|run| run.limited = 0.1)] {
            assert_eq!((best(&unusable), unusable.excluded()), (Some(2.0), 1));
        }
        let usable = other(|run| run.limited = 0.005);
        assert_eq!((best(&usable), usable.excluded()), (Some(1.0), 0));
    }

    /// Any joint, built and run; the figures are there for each of its runs.
    #[test]
    fn a_joint_runs() {
        let request = Request { set: Set::Training, first: 3, count: 1, unknown: Which::BOX };
        let report = measure(&request, |_| ()).unwrap();
        assert_eq!(report.outcomes.len(), 1);
        let outcome = &report.outcomes[0];
        assert_eq!(outcome.joint.seed, 3);
        assert!(outcome.baselines.iter().all(|results| results.iter().all(Option::is_some)));
        assert_eq!(outcome.baselines.len(), if outcome.sensors() == SensorSet::Both { 4 } else { 3 });
    }

    /// A plant that differs by more than the box is another one, of the same joint with the same encoders.
    #[test]
    fn a_joint_keeps_its_encoders_on_every_plant() {
        let joint =
            |unknown| Request { set: Set::Training, first: 3, count: 1, unknown }.joints().swap_remove(0);
        let [known, unknown] = [Which::BOX, Which::All].map(joint);
        let [boxed, sample] = [&known, &unknown].map(|joint| joint.plant().unwrap());
        assert_eq!((&known.known, &unknown.known), (&boxed.known, &sample.known));
        assert!(boxed.sides != sample.sides && boxed.known == sample.known);
    }

    #[test]
    fn a_figure_is_named_after_what_is_unknown() {
        let of = |unknown| {
            let figure = bounded(["catalogue.shakes", "catalogue.unknown.shakes"], unknown, 0.0);
            (figure.name, figure.row.unwrap())
        };
        assert_eq!(of(Which::BOX), ("catalogue.shakes".into(), "catalogue.shakes"));
        assert_eq!(of(Which::All), ("catalogue.all.shakes".into(), "catalogue.unknown.shakes"));
    }

    /// With 14 bits at the motor a count is a pulse of torque; after a load step the joint rests without any.
    #[test]
    fn a_coarse_encoder_does_not_shake_a_resting_joint() {
        let request = Request { set: Set::Training, first: 94, count: 1, unknown: Which::BOX };
        let report = measure(&request, |_| ()).unwrap();
        let outcome = &report.outcomes[0];
        assert_eq!(outcome.joint.known.sensors.motor_encoder_bits, 14);
        let at_rest = |place| outcome.run(place).ours.unwrap().torque_at_rest;
        let rests = [at_rest(0), at_rest(2), at_rest(4)];
        assert!(rests.iter().all(|torque| *torque < 0.01), "{rests:?}");
    }

    /// A joint with a tenth of the rotor's reflected inertia, whose torsion mode is too fast for the protection's rate: it
    /// follows a load step with the drive on, nearer to its setpoint than the cascade.
    #[test]
    fn a_light_joint_bears_a_load_step() {
        let request = Request { set: Set::Training, first: 181, count: 1, unknown: Which::BOX };
        let report = measure(&request, |_| ()).unwrap();
        let run = report.outcomes[0].run(4);
        let (ours, b0) = (run.ours.unwrap(), run.b0.unwrap());
        assert_eq!(ours.mode, Mode::Active);
        assert!(!ours.faults.contains(Faults::GEAR_OVERLOAD));
        assert!(ours.metrics[0] < b0.metrics[0], "{:?} {:?}", ours.metrics, b0.metrics);
    }
}
