//! The loop of a scenario: a joint on the bench, any controller, and what came of it.

use strainwave::compensator::Output;
use strainwave::flexspline::Flexspline;

use crate::bench::controller::Controller;
use crate::bench::joint_bench::{Bench, Conditions};
use crate::bench::motion::Motion;
use crate::bench::scenario::Scenario;
use crate::bench::task::{Demand, periods};
use crate::io::gear_file::GearFile;
use crate::io::log::{Drive, OpenLoop, Time};
use crate::plant::Plant;
use crate::plant::divergence::RunError;
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Every how many control periods a run says how far it is.
const PROGRESS_EVERY: usize = 100;

/// One row of a trace.
#[derive(Clone, Copy, Debug, Default)]
pub struct Row {
    /// (s)
    pub time: f64,
    /// Demand of the motion.
    pub demand: Demand,
    /// True output angle (rad).
    pub output: f64,
    /// True motor angle (rad).
    pub motor: f64,
    /// True torsion (rad).
    pub torsion: f64,
    /// True torque through the flexspline (N m).
    pub transmitted: f64,
    /// True output speed (rad/s).
    pub output_velocity: f64,
    /// True friction of the wave generator and of the flexspline (N m).
    pub friction: [f64; 2],
    /// Output of the controller.
    pub answer: Output<f32>,
}

impl Row {
    fn of<F: Flexspline<f64>>(time: f64, demand: Demand, plant: &Plant<F>, answer: Output<f32>) -> Self {
        let torques = plant.last_torques();
        Self {
            time,
            demand,
            output: plant.output().angle.to_radians(),
            motor: plant.motor().angle.to_radians(),
            torsion: torques.torsion,
            transmitted: torques.transmitted,
            output_velocity: plant.output().velocity,
            friction: [torques.input_friction, torques.output_friction],
            answer,
        }
    }
}

/// Result of one run.
#[derive(Clone, Debug)]
pub struct Run {
    /// A row each control period.
    pub trace: Vec<Row>,
    /// Output error over the judged part, rms (rad).
    pub rms: f64,
    /// Largest output error over the judged part (rad).
    pub max: f64,
    /// Output error at the end of the run (rad).
    pub last: f64,
    /// Errors of the controller's estimates; without a meaning for a controller without estimates.
    pub estimate: EstimateErrors,
    /// Power balance of the plant: what is missing, as a fraction of the energy moved.
    pub imbalance: f64,
}

/// Rms errors of a controller's estimates over the judged part of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimateErrors {
    /// Of the output angle (rad).
    pub output: f64,
    /// Of the external torque on the output (N m).
    pub external_torque: f64,
}

/// Runs a scenario from rest on the reference plant of `seed` (see [`crate::plant::box_sample::BoxSample::from_seed`]); `progress` is
/// called with the fraction done.
///
/// # Errors
/// The controller's, a gear that cannot be built, or a plant that diverges.
pub fn run<C: Controller>(
    file: &GearFile,
    scenario: Scenario,
    seed: u64,
    controller: &mut C,
    progress: impl FnMut(f64),
) -> Result<Run, C::Error>
where
    C::Error: From<RunError>,
{
    let mut bench = Bench::build(file, &Conditions::of(file, seed)).map_err(RunError::from)?;
    go_on(&mut bench, scenario, controller, progress)
}

/// Runs a motion from where a joint and its controller are; `progress` is called with the fraction done.
///
/// # Errors
/// As [`Bench::go`].
pub fn go_on<'a, F: Flexspline<f64>, C: Controller>(
    bench: &mut Bench<F>,
    motion: impl Into<Motion<'a>>,
    controller: &mut C,
    mut progress: impl FnMut(f64),
) -> Result<Run, C::Error>
where
    C::Error: From<RunError>,
{
    let motion = motion.into();
    let steps = periods(&motion);
    let mut judge = Judge::default();
    let mut trace = Vec::with_capacity(steps);
    bench.go(&motion, controller, |k, demand, plant, answer| {
        let row = Row::of(k as f64 * CONTROL_PERIOD, demand, plant, answer);
        if row.time >= motion.judged_from() {
            judge.add(&row);
        }
        trace.push(row);
        if k % PROGRESS_EVERY == 0 {
            progress(k as f64 / steps as f64);
        }
    })?;
    Ok(judge.run(trace, bench.plant().imbalance()))
}

/// Runs a scenario as [`run`], and records what drives the plant's gear, a row each control period: the motor's speed
/// and the load.
///
/// # Errors
/// As [`run`].
pub fn record<C: Controller>(
    file: &GearFile,
    scenario: Scenario,
    seed: u64,
    controller: &mut C,
) -> Result<OpenLoop, C::Error>
where
    C::Error: From<RunError>,
{
    let (mut speed, mut load_torque) = (Vec::new(), Vec::new());
    let mut bench = Bench::build(file, &Conditions::of(file, seed)).map_err(RunError::from)?;
    bench.go(&scenario, controller, |_, demand, plant, _| {
        speed.push(plant.wave_generator().velocity);
        load_torque.push(demand.load);
    })?;
    Ok(OpenLoop {
        time: Time::every(CONTROL_PERIOD, speed.len()),
        drive: Drive::Velocity(speed),
        load_torque,
    })
}

/// The scores of a run.
#[derive(Default)]
struct Judge {
    output: Score,
    estimated_output: Score,
    estimated_external_torque: Score,
}

impl Judge {
    /// Counts one control period.
    fn add(&mut self, row: &Row) {
        let estimate = &row.answer.estimate;
        self.output.add(row.output - row.demand.position);
        if row.answer.observed {
            self.estimated_output.add(estimate.output_position.to_radians() - row.output);
            self.estimated_external_torque.add(f64::from(estimate.external_torque) - row.demand.load);
        }
    }

    fn run(&self, trace: Vec<Row>, imbalance: f64) -> Run {
        let Score { max, last, .. } = self.output;
        let estimate = EstimateErrors {
            output: self.estimated_output.rms(),
            external_torque: self.estimated_external_torque.rms(),
        };
        Run { trace, rms: self.output.rms(), max, last, estimate, imbalance }
    }
}

/// Root mean square, largest and last of a sequence of errors.
#[derive(Clone, Copy, Debug, Default)]
struct Score {
    squares: f64,
    count: f64,
    max: f64,
    last: f64,
}

impl Score {
    /// Counts one error.
    fn add(&mut self, error: f64) {
        self.squares += error * error;
        self.count += 1.0;
        self.max = self.max.max(error.abs());
        self.last = error;
    }

    /// Root mean square.
    fn rms(&self) -> f64 {
        (self.squares / self.count).sqrt()
    }
}
