//! All controllers over the scenarios on one sample of the plant.

use std::collections::BTreeMap;

use strainwave::Error;
use strainwave::compensator::JointParams;
use strainwave::flexspline::Flexspline;
use strainwave::gear::GearParams;
use strainwave::kinematic_error::KinematicErrorParams;

use crate::bench::baseline::Baseline;
use crate::bench::closed_loop::{Row, go_on};
use crate::bench::controller::{Controller, HostCompensator};
use crate::bench::scenario::Scenario;
use crate::bench::working_motion::WorkingMotion;
use crate::bench::{Bench, Conditions};
use crate::design::joint::joint_params;
use crate::io::gear_file::GearFile;
use crate::io::gear_file::SensorSet;
use crate::plant::CondensedMesh;
use crate::plant::divergence::RunError;
use crate::verify::judge::estimates::Outside;
use crate::verify::judge::{Judge, Metric, external_torque_error, rms, vibration};
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// The scenarios that a controller is judged in; in S6 a brake holds the joint.
pub const JUDGED: [Scenario; 5] = [Scenario::S1, Scenario::S2, Scenario::S3, Scenario::S4, Scenario::S5];
/// Longest time at the torque limit of a stable run's judged part (s).
const LONGEST_LIMITED: f64 = 0.01;
/// A stable run's vibration at its end is at most this many times B0's, or below [`QUIET`].
const MOST_VIBRATION: f64 = 3.0;
/// (rad)
const QUIET: f64 = 10e-6;
/// Fraction of a run that is its end.
const END: f64 = 0.2;
/// Largest ratio to B0's error, which is repeatable to less.
const WORSE: f64 = 1.01;

/// Result of one run of one scenario.
#[derive(Clone, Copy, Debug)]
struct RunResult {
    scenario: Scenario,
    /// Rms output error of the judged part (rad).
    error: f64,
    /// At the torque limit in the judged part (s).
    limited: f64,
    /// Rms vibration of the torsion at the end (rad).
    vibration: f64,
}

/// One controller over all scenarios on one plant.
#[derive(Clone, Debug, Default)]
pub struct Performance {
    metrics: BTreeMap<Metric, f64>,
    results: Vec<RunResult>,
    /// The plant diverged under it.
    diverged: bool,
}

impl Performance {
    /// From where `bench` and `controller` are, into each scenario.
    ///
    /// # Errors
    /// As [`Bench::go`].
    pub fn of<F: Flexspline<f64>, C: Controller<Error = RunError> + Clone>(
        bench: &Bench<F>,
        controller: &C,
        plant: &GearParams<f64>,
        torque_limit: f64,
    ) -> Result<Self, RunError>
    where
        Bench<F>: Clone,
    {
        let mut performance = Self::default();
        let (mut external, mut outside) = (Vec::new(), Outside::default());
        for scenario in JUDGED {
            let rows = go_on(&mut bench.clone(), scenario, &mut controller.clone(), |_| ())?.trace;
            let judge = Judge::new(scenario, plant, &rows);
            for metric in Metric::ALL.into_iter().filter(|metric| metric.is_of(scenario)) {
                performance.metrics.insert(metric, judge.metric(metric)?);
            }
            performance.results.push(RunResult::of(scenario, &judge, &rows, torque_limit)?);
            external.extend(judge.judged().iter().map(external_torque_error));
            outside.count(judge.judged());
        }
        performance.metrics.insert(Metric::Outside, outside.worst_fraction());
        performance.metrics.insert(Metric::ExternalTorque, rms(external));
        Ok(performance)
    }

    /// A metric; NaN of a run that diverged.
    pub fn metric(&self, metric: Metric) -> f64 {
        self.metrics.get(&metric).copied().unwrap_or(f64::NAN)
    }

    /// Scenarios in which it is unstable.
    pub fn unstable(&self, b0: &Self) -> usize {
        let shaking =
            |ours: &RunResult, b0: &RunResult| ours.vibration > (MOST_VIBRATION * b0.vibration).max(QUIET);
        self.count(b0, |ours, b0| ours.limited > LONGEST_LIMITED || shaking(ours, b0))
    }

    /// Scenarios in which it is worse than B0.
    pub fn worse(&self, b0: &Self) -> usize {
        self.count(b0, |ours, b0| ours.error > WORSE * b0.error)
    }

    fn count(&self, b0: &Self, bad: impl Fn(&RunResult, &RunResult) -> bool) -> usize {
        let pairs = self.results.iter().zip(&b0.results);
        let bad = pairs.filter(|(ours, b0)| ours.scenario == b0.scenario && bad(ours, b0)).count();
        if self.diverged { JUDGED.len() } else { bad }
    }
}

impl RunResult {
    fn of(scenario: Scenario, judge: &Judge<'_>, rows: &[Row], torque_limit: f64) -> Result<Self, Error> {
        let at_limit = |row: &&Row| f64::from(row.answer.motor_torque.abs()) >= 0.999 * torque_limit;
        let end = &rows[rows.len() - (END * rows.len() as f64) as usize..];
        Ok(Self {
            scenario,
            error: judge.metric(Metric::Error)?,
            limited: judge.judged().iter().filter(at_limit).count() as f64 * CONTROL_PERIOD,
            vibration: rms(vibration(end, judge.natural_period()?)),
        })
    }
}

/// Controllers compared on every sample.
pub struct Rivals {
    baselines: [Baseline; 2],
    joint: JointParams<f32>,
    /// The same, but it does not know the gear's kinematic error.
    unmapped: JointParams<f32>,
}

/// The controllers on one sample.
#[derive(Clone, Debug)]
pub struct Compared {
    /// The sample.
    pub seed: u64,
    /// Its noise: 0 is the seed's own.
    pub realisation: u32,
    /// B0 and B1.
    pub baselines: [Performance; 2],
    /// The compensator with each set of sensors.
    pub compensated: [Performance; 2],
}

impl Rivals {
    /// Baselines and compensator of a gear file's joint.
    ///
    /// # Errors
    /// As their builds.
    pub fn build(file: &GearFile) -> Result<Self, Error> {
        let joint: JointParams<f32> = joint_params(file)?;
        let mut unmapped = joint;
        unmapped.gear.kinematic_error = KinematicErrorParams::default();
        Ok(Self { baselines: [Baseline::b0(file)?, Baseline::b1(file)?], joint, unmapped })
    }

    /// All of them on one plant, with its noise.
    ///
    /// # Errors
    /// A gear that cannot be built, or a baseline that diverges.
    pub fn compare(&self, file: &GearFile, conditions: &Conditions) -> Result<Compared, RunError> {
        let (plant, limit) = (conditions.plant(file)?, file.motor.peak_torque);
        let bench = Bench::condensed(file, conditions)?;
        let [b0, b1] = &self.baselines;
        let baseline = |baseline| Performance::of(&bench, baseline, &plant, limit);
        let compensated = |sensors| {
            let conditions = Conditions { sensors, ..*conditions };
            let (bench, controller) = worked(&self.joint, file, &conditions)?;
            Performance::of(&bench, &controller, &plant, limit)
        };
        let [motor, both] = SensorSet::ALL.map(compensated).map(|run| match run {
            Err(RunError::Diverged(_)) => Ok(Performance { diverged: true, ..Performance::default() }),
            other => other,
        });
        Ok(Compared {
            seed: conditions.seed,
            realisation: conditions.realisation,
            baselines: [baseline(b0)?, baseline(b1)?],
            compensated: [motor?, both?],
        })
    }

    /// The ripple that a compensator leaves in S4 which has learnt the kinematic error while it worked, with both
    /// encoders (rad).
    ///
    /// # Errors
    /// A gear that cannot be built, or a plant that diverges.
    pub fn ripple_after_learning(&self, file: &GearFile, conditions: &Conditions) -> Result<f64, RunError> {
        let conditions = Conditions { sensors: SensorSet::Both, ..*conditions };
        let (mut bench, mut controller) = worked(&self.unmapped, file, &conditions)?;
        let rows = go_on(&mut bench, Scenario::S4, &mut controller, |_| ())?.trace;
        Ok(Judge::new(Scenario::S4, &conditions.plant(file)?, &rows).metric(Metric::Ripple)?)
    }

    /// [`Rivals::compare`], with both encoders the ripple of a kinematic error that was learnt.
    ///
    /// # Errors
    /// As [`Rivals::compare`].
    pub fn compare_learning(&self, file: &GearFile, conditions: &Conditions) -> Result<Compared, RunError> {
        let mut compared = self.compare(file, conditions)?;
        let ripple = self.ripple_after_learning(file, conditions)?;
        compared.compensated[SensorSet::Both as usize].metrics.insert(Metric::Ripple, ripple);
        Ok(compared)
    }
}

/// A joint and its compensator after the working motion.
pub(crate) fn worked(
    joint: &JointParams<f32>,
    file: &GearFile,
    conditions: &Conditions,
) -> Result<(Bench<CondensedMesh>, HostCompensator), RunError> {
    let mut bench = Bench::condensed(file, conditions)?;
    let mut controller = HostCompensator::build(joint)?;
    bench.go(&WorkingMotion, &mut controller, |_, _, _, _| ())?;
    Ok((bench, controller))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn result(error: f64, limited: f64, vibration: f64) -> Performance {
        let results = vec![RunResult { scenario: Scenario::S2, error, limited, vibration }];
        Performance { results, ..Performance::default() }
    }

    #[test]
    fn what_shakes_saturates_or_diverges_is_unstable() {
        let b0 = result(1e-4, 0.0, 5e-6);
        let unstable = |limited, vibration| result(1e-4, limited, vibration).unstable(&b0);
        assert_eq!([unstable(0.0, 5e-6), unstable(0.009, 14e-6), unstable(0.0, 1e-7)], [0, 0, 0]);
        assert_eq!([unstable(0.011, 5e-6), unstable(0.0, 16e-6)], [1, 1]);
        // Below 10 urad nothing shakes, however little B0 does.
        assert_eq!(result(1e-4, 0.0, 9e-6).unstable(&result(1e-4, 0.0, 1e-9)), 0);
        let diverged = Performance { diverged: true, ..Performance::default() };
        assert_eq!((diverged.unstable(&b0), diverged.worse(&b0)), (JUDGED.len(), JUDGED.len()));
        assert!(diverged.metric(Metric::Error).is_nan());
    }

    #[test]
    fn worse_is_more_than_a_hundredth() {
        let b0 = result(1e-4, 0.0, 0.0);
        assert_eq!([1.005e-4, 1.02e-4].map(|error| result(error, 0.0, 0.0).worse(&b0)), [0, 1]);
    }

    /// B0 against itself is neither.
    #[test]
    fn a_run_repeats() {
        let file = GearFile::default_gear();
        let conditions = Conditions::of(&file, 2);
        let (plant, b0) = (conditions.plant(&file).unwrap(), Baseline::b0(&file).unwrap());
        let bench = Bench::condensed(&file, &conditions).unwrap();
        let of = || Performance::of(&bench, &b0, &plant, file.motor.peak_torque).unwrap();
        let (one, other) = (of(), of());
        assert_eq!((one.worse(&other), one.unstable(&other)), (0, 0));
        assert_eq!(one.metrics, other.metrics);
        assert!(
            one.metrics.len() == Metric::ALL.len() && one.metrics.values().all(|metric| metric.is_finite())
        );
    }
}
