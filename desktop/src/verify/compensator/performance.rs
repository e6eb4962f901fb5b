//! All controllers over the scenarios on one draw of the plant.

use std::collections::BTreeMap;

use strainwave::Error;
use strainwave::compensator::JointParams;
use strainwave::flexspline::Flexspline;
use strainwave::gear::GearParams;

use crate::baseline::Baseline;
use crate::bench::{Bench, Conditions, SensorSet};
use crate::closed_loop::{Controller, HostCompensator, Row, go_on};
use crate::divergence::RunError;
use crate::gear_file::GearFile;
use crate::joint::{CONTROL_PERIOD, joint_params};
use crate::judge::{Judge, Mark, external_torque_error, rms, vibration};
use crate::scenario::Scenario;
use crate::working_motion::WorkingMotion;

/// The scenarios that a controller is judged in; in S6 a brake holds the joint.
pub const JUDGED: [Scenario; 5] = [Scenario::S1, Scenario::S2, Scenario::S3, Scenario::S4, Scenario::S5];
/// Longest time at the torque limit of a stable run's judged part (s).
const LONGEST_LIMITED: f64 = 0.01;
/// A stable run's vibration at its end is at most this many times B0's, or below [`QUIET`].
const MOST_VIBRATION: f64 = 3.0;
/// (rad)
const QUIET: f64 = 10e-6;
/// Share of a run that is its end.
const END: f64 = 0.2;
/// What a run may be worse than B0's, which is repeatable to less.
const WORSE: f64 = 1.01;

/// What one run of one scenario was like.
#[derive(Clone, Copy, Debug)]
struct Course {
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
    marks: BTreeMap<Mark, f64>,
    courses: Vec<Course>,
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
        let mut external = Vec::new();
        for scenario in JUDGED {
            let rows = go_on(&mut bench.clone(), scenario, &mut controller.clone(), |_| ())?.trace;
            let judge = Judge::new(scenario, plant, &rows);
            for mark in Mark::ALL.into_iter().filter(|mark| mark.is_of(scenario)) {
                performance.marks.insert(mark, judge.mark(mark)?);
            }
            performance.courses.push(Course::of(scenario, &judge, &rows, torque_limit)?);
            external.extend(judge.judged().iter().map(external_torque_error));
        }
        performance.marks.insert(Mark::ExternalTorque, rms(external));
        Ok(performance)
    }

    /// A mark; NaN of a run that diverged.
    pub fn mark(&self, mark: Mark) -> f64 {
        self.marks.get(&mark).copied().unwrap_or(f64::NAN)
    }

    /// Scenarios in which it is unstable.
    pub fn unstable(&self, b0: &Self) -> usize {
        let shaking =
            |ours: &Course, b0: &Course| ours.vibration > (MOST_VIBRATION * b0.vibration).max(QUIET);
        self.count(b0, |ours, b0| ours.limited > LONGEST_LIMITED || shaking(ours, b0))
    }

    /// Scenarios in which it is worse than B0.
    pub fn worse(&self, b0: &Self) -> usize {
        self.count(b0, |ours, b0| ours.error > WORSE * b0.error)
    }

    fn count(&self, b0: &Self, bad: impl Fn(&Course, &Course) -> bool) -> usize {
        let pairs = self.courses.iter().zip(&b0.courses);
        let bad = pairs.filter(|(ours, b0)| ours.scenario == b0.scenario && bad(ours, b0)).count();
        if self.diverged { JUDGED.len() } else { bad }
    }
}

impl Course {
    fn of(scenario: Scenario, judge: &Judge<'_>, rows: &[Row], torque_limit: f64) -> Result<Self, Error> {
        let at_limit = |row: &&Row| f64::from(row.answer.motor_torque.abs()) >= 0.999 * torque_limit;
        let end = &rows[rows.len() - (END * rows.len() as f64) as usize..];
        Ok(Self {
            scenario,
            error: judge.mark(Mark::Error)?,
            limited: judge.judged().iter().filter(at_limit).count() as f64 * CONTROL_PERIOD,
            vibration: rms(vibration(end, judge.natural_period()?)),
        })
    }
}

/// What is compared on every draw.
pub struct Rivals {
    baselines: [Baseline; 2],
    joint: JointParams<f32>,
}

/// The controllers on one draw.
#[derive(Clone, Debug)]
pub struct Compared {
    /// The draw.
    pub seed: u64,
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
        Ok(Self { baselines: [Baseline::b0(file)?, Baseline::b1(file)?], joint: joint_params(file)? })
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
            match self.worked(file, &conditions) {
                Ok((bench, controller)) => Performance::of(&bench, &controller, &plant, limit),
                Err(error) => Err(error),
            }
        };
        let [motor, both] = SensorSet::ALL.map(compensated).map(|run| match run {
            Err(RunError::Diverged(_)) => Ok(Performance { diverged: true, ..Performance::default() }),
            other => other,
        });
        Ok(Compared {
            seed: conditions.seed,
            baselines: [baseline(b0)?, baseline(b1)?],
            compensated: [motor?, both?],
        })
    }

    /// The joint and its compensator after the working motion.
    fn worked(
        &self,
        file: &GearFile,
        conditions: &Conditions,
    ) -> Result<(Bench<crate::plant::CondensedMesh>, HostCompensator), RunError> {
        let mut bench = Bench::condensed(file, conditions)?;
        let mut controller = HostCompensator::build(&self.joint)?;
        bench.go(&WorkingMotion, &mut controller, |_, _, _, _| ())?;
        Ok((bench, controller))
    }
}
