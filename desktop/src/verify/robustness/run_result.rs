//! Result of one run of one scenario on a judged plant.
//!
//! After the scenario the joint stops and rests ([`Rest`]). Oscillation at rest is what is left of torsion and of motor
//! torque when their running mean over the natural period is taken away, rms over the last
//! 0.3 s, or two natural periods. Before these a vibration has 0.3 s, or ten natural periods, to decay.

use strainwave::Error;
use strainwave::compensator::{Faults, Mode};
use strainwave::flexspline::Flexspline;
use strainwave::gear::GearParams;

use crate::bench::Bench;
use crate::bench::closed_loop::{Row, go_on};
use crate::bench::controller::Controller;
use crate::bench::motion::Motion;
use crate::bench::scenario::{Rest, Scenario};
use crate::bench::working_motion::WorkingMotion;
use crate::design::capability::Capability;
use crate::io::gear_file::GearFile;
use crate::plant::divergence::RunError;
use crate::verify::judge::{Judge, Metric, rms, without_slow_part};
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// The scenarios that a controller is judged in.
pub const JUDGED: [Scenario; 5] = [Scenario::S1, Scenario::S2, Scenario::S3, Scenario::S4, Scenario::S5];

/// Metrics of a motion that are angles of the output or of the torsion, and how they are judged: the smaller the better.
pub fn metrics<'a>(motion: impl Into<Motion<'a>>) -> &'static [Metric] {
    match motion.into() {
        Motion::Trajectory(_) => &[Metric::Error],
        Motion::Scenario(scenario) => metrics_of(scenario),
    }
}

fn metrics_of(scenario: Scenario) -> &'static [Metric] {
    match scenario {
        Scenario::S1 => &[Metric::Error, Metric::StepVibration],
        Scenario::S2 => &[Metric::Error],
        Scenario::S3 => &[Metric::Error, Metric::MoveVibration],
        Scenario::S4 => &[Metric::Error, Metric::Ripple],
        Scenario::S5 => &[Metric::Error, Metric::Peak, Metric::Steady],
        Scenario::S6 => &[],
    }
}

/// Longest time at the torque limit of a run's judged part (s).
const LONGEST_LIMITED: f64 = 0.01;
/// A run oscillates when it oscillates at rest by more than this many times B0.
const TIMES: f64 = 3.0;
/// Nor does it below this torsion (rad), and this fraction of the rated torque.
const QUIET: [f64; 2] = [10e-6, 0.02];
/// Oscillation of the torque that counts as none beside another, in rated torques: a drive that resolves its current in 12 bits rounds
/// it by some times as much, and a cascade may stand still exactly within static friction.
const STILL: f64 = 1e-4;
/// A count of an encoder of 19 bits (rad): what an angle must differ by to be worse.
pub const COUNT: f64 = 12e-6;
/// A metric is worse than B0's when it is both by more than a [`COUNT`] and by this factor.
const WORSE: f64 = 1.05;

/// Oscillation of the torque at rest over that of another controller, both in rated torques.
pub(super) fn torque_ratio(ours: f64, other: f64) -> f64 {
    ours / other.max(STILL)
}

/// Oscillation of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Oscillation {
    /// The torsion oscillates at rest.
    Torsion,
    /// The motor's torque alone does.
    Torque,
    /// The plant diverges.
    Diverged,
}

impl Oscillation {
    /// For people.
    pub fn name(self) -> &'static str {
        ["torsion", "torque", "diverged"][self as usize]
    }
}

/// One run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunResult {
    /// Metrics of the scenario (rad).
    pub metrics: Vec<f64>,
    /// Oscillation at rest, of the torsion (rad).
    pub torsion_at_rest: f64,
    /// The same of the motor's torque, in rated torques.
    pub torque_at_rest: f64,
    /// At the torque limit in the judged part (s).
    pub limited: f64,
    /// Every fault that was named in the run and the rest after it.
    pub faults: Faults,
    /// At the end of the rest; a baseline has none.
    pub mode: Mode,
}

impl RunResult {
    /// A metric of a run of this scenario; NaN where it has none.
    pub fn metric(&self, scenario: Scenario, metric: Metric) -> f64 {
        let place = metrics(scenario).iter().position(|other| *other == metric);
        place.and_then(|place| self.metrics.get(place).copied()).unwrap_or(f64::NAN)
    }

    /// It keeps oscillating at rest where B0 does not; in which way.
    pub fn oscillates(&self, b0: &Self) -> Option<Oscillation> {
        let [torsion, torque] = self.shaking(b0).map(|over| over > 1.0 || over.is_nan());
        if torsion { Some(Oscillation::Torsion) } else { torque.then_some(Oscillation::Torque) }
    }

    /// Oscillation at rest of the torsion and of the motor's torque, each over the largest that is none against B0's.
    pub fn shaking(&self, b0: &Self) -> [f64; 2] {
        [
            self.torsion_at_rest / (TIMES * b0.torsion_at_rest).max(QUIET[0]),
            self.torque_at_rest / (TIMES * b0.torque_at_rest).max(QUIET[1]),
        ]
    }

    /// It stays at its torque limit where B0 does not.
    pub fn is_limited(&self, b0: &Self) -> bool {
        self.limited > LONGEST_LIMITED.max(2.0 * b0.limited)
    }

    /// A metric of it is worse than B0's; one that neither has is not.
    pub fn is_worse(&self, b0: &Self) -> bool {
        self.worse_metrics(b0) > 0
    }

    /// Largest ratio to B0's of a metric that is more than a count above it; 0 when there is none.
    pub fn worst_ratio(&self, b0: &Self) -> f64 {
        let above = self.metrics.iter().zip(&b0.metrics).filter(|(ours, b0)| **ours > **b0 + COUNT);
        above.map(|(ours, b0)| ours / b0).fold(0.0, f64::max)
    }

    /// Number of its metrics that are worse than those of a baseline in the same scenario.
    pub fn worse_metrics(&self, baseline: &Self) -> usize {
        let worse = |(ours, other): &(&f64, &f64)| {
            let no_worse = **ours <= WORSE * **other || **ours <= **other + COUNT;
            let none = ours.is_nan() && other.is_nan();
            !no_worse && !none
        };
        self.metrics.iter().zip(&baseline.metrics).filter(worse).count()
    }
}

/// A controller's runs on one plant, in the order of [`JUDGED`]; none of a run under which the plant diverged.
pub type RunResults = [Option<RunResult>; JUDGED.len()];

/// The plant that a run is judged by.
pub struct Judged<'a> {
    /// Its parameters.
    pub plant: &'a GearParams<f64>,
    /// Torque limit of the controller (N m).
    pub torque_limit: f64,
    /// Rated torque at the motor (N m).
    pub rated: f64,
    /// Capability of the joint.
    pub capability: Capability,
}

impl<'a> Judged<'a> {
    /// Judge of a joint with the gear file `known` and the true parameters `plant`.
    pub fn of(known: &GearFile, plant: &'a GearParams<f64>) -> Self {
        Self {
            plant,
            torque_limit: known.motor.peak_torque,
            rated: known.gear.rated_torque / f64::from(known.gear.ratio),
            capability: Capability::of(known),
        }
    }

    /// Works, and goes into each of these scenarios from there.
    ///
    /// # Errors
    /// A parameter that no model can be built from.
    pub fn results<F: Flexspline<f64>, C: Controller<Error = RunError> + Clone>(
        &self,
        mut bench: Bench<F>,
        mut controller: C,
        scenarios: &[Scenario],
    ) -> Result<RunResults, Error>
    where
        Bench<F>: Clone,
    {
        let worked = unless_diverged(bench.go(&WorkingMotion, &mut controller, |_, _, _, _| ()))?;
        let mut results = RunResults::default();
        for (result, scenario) in results.iter_mut().zip(JUDGED) {
            if worked.is_some() && scenarios.contains(&scenario) {
                *result = unless_diverged(self.result(bench.clone(), controller.clone(), scenario))?;
            }
        }
        Ok(results)
    }

    /// One scenario from where bench and controller are, then the rest.
    ///
    /// # Errors
    /// As [`Bench::go`].
    pub(crate) fn result<F: Flexspline<f64>, C: Controller>(
        &self,
        mut bench: Bench<F>,
        mut controller: C,
        scenario: Scenario,
    ) -> Result<RunResult, C::Error>
    where
        C::Error: From<RunError>,
    {
        let rows = go_on(&mut bench, scenario, &mut controller, |_| ())?.trace;
        let mut faults = rows.iter().fold(Faults::NONE, |faults, row| faults.with(row.answer.faults));
        let mut mode = Mode::default();
        let mut at_rest = Vec::new();
        let natural_period =
            Judge::new(scenario, self.plant, &rows).natural_period().map_err(RunError::from)?;
        let rest = Rest { from: scenario.at(scenario.duration(), &self.capability), natural_period };
        bench.go(&rest, &mut controller, |k, _, plant, answer| {
            (faults, mode) = (faults.with(answer.faults), answer.mode);
            if k as f64 * CONTROL_PERIOD >= rest.judged_from() {
                at_rest.push((plant.last_torques().torsion, f64::from(answer.motor_torque)));
            }
        })?;
        let oscillation = |values: Vec<f64>| rms(without_slow_part(&values, natural_period));
        Ok(RunResult {
            torsion_at_rest: oscillation(at_rest.iter().map(|(torsion, _)| *torsion).collect()),
            torque_at_rest: oscillation(at_rest.iter().map(|(_, torque)| *torque / self.rated).collect()),
            faults,
            mode,
            ..self.without_rest(scenario, &rows).map_err(RunError::from)?
        })
    }

    /// Result of a motion's rows, one each control period; its oscillation at rest is left 0.
    ///
    /// # Errors
    /// A plant whose stiffness line is none.
    pub fn without_rest<'m>(
        &'m self,
        motion: impl Into<Motion<'m>>,
        rows: &'m [Row],
    ) -> Result<RunResult, Error> {
        let motion = motion.into();
        let judge = Judge::new(motion, self.plant, rows);
        let at_limit = |row: &&Row| f64::from(row.answer.motor_torque.abs()) >= 0.999 * self.torque_limit;
        Ok(RunResult {
            metrics: metrics(motion).iter().map(|metric| judge.metric(*metric)).collect::<Result<_, _>>()?,
            limited: judge.judged().iter().filter(at_limit).count() as f64 * CONTROL_PERIOD,
            ..RunResult::default()
        })
    }
}

/// None of a run under which the plant diverged.
fn unless_diverged<T>(run: Result<T, RunError>) -> Result<Option<T>, Error> {
    match run {
        Ok(run) => Ok(Some(run)),
        Err(RunError::Diverged(_)) => Ok(None),
        Err(RunError::Parameter(error)) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const B0: RunResult = RunResult {
        metrics: vec![],
        torsion_at_rest: 5e-6,
        torque_at_rest: 0.001,
        limited: 0.0,
        faults: Faults::NONE,
        mode: Mode::Active,
    };

    fn result(error: f64) -> RunResult {
        RunResult { metrics: vec![error], ..B0 }
    }

    #[test]
    fn beside_a_torque_that_stands_still_a_ratio_is_finite() {
        assert_eq!(torque_ratio(2.0 * STILL, 1e-14), 2.0);
        assert_eq!(torque_ratio(0.03, 0.01), 3.0);
    }

    #[test]
    fn what_keeps_oscillating_shakes() {
        let shakes = |torsion_at_rest, torque_at_rest| {
            RunResult { torsion_at_rest, torque_at_rest, ..B0 }.oscillates(&B0)
        };
        assert_eq!(shakes(14e-6, 0.019), None);
        assert_eq!([shakes(16e-6, 0.0), shakes(f64::NAN, 0.0)], [Some(Oscillation::Torsion); 2]);
        assert_eq!(shakes(0.0, 0.021), Some(Oscillation::Torque));
        let limited = |limited| RunResult { limited, ..B0 }.is_limited(&B0);
        assert!(!limited(0.009) && limited(0.011));
    }

    #[test]
    fn worse_is_more_than_a_twentieth_and_a_count() {
        let worse = |ours: f64, b0: f64| result(ours).is_worse(&result(b0));
        assert!(!worse(1.04e-3, 1e-3) && !worse(11e-6, 1e-6) && !worse(5e-6, 9e-6));
        assert!(worse(1.06e-3, 1e-3) && worse(14e-6, 1e-6) && worse(f64::NAN, 1.0));
        assert!(!worse(f64::NAN, f64::NAN));
    }

    #[test]
    fn a_mark_stands_where_its_scenario_has_it() {
        let result = RunResult { metrics: vec![1.0, 2.0], ..B0 };
        assert_eq!(
            [Metric::Error, Metric::MoveVibration].map(|metric| result.metric(Scenario::S3, metric)),
            [1.0, 2.0]
        );
        assert!(result.metric(Scenario::S3, Metric::Peak).is_nan());
    }
}
