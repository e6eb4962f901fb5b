//! The loop of a scenario: plant and sensors on the desktop, any controller in between.
//!
//! Each control period: the sensors are read, the controller answers, its torque acts on the plant for one
//! period. The motor's torque is what was commanded, and what is measured of it carries noise.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use strainwave::Error;
use strainwave::compensator::{Compensator, Estimate, Input, JointParams, Output, Sensors, Shares, State};

use crate::baseline::Baseline;
use crate::divergence::RunError;
use crate::draw::Draw;
use crate::gear_file::GearFile;
use crate::joint::{CONTROL_PERIOD, firmware_gear_params};
use crate::log::{Drive, OpenLoop, Time};
use crate::plant::{Plant, encoder_count};
use crate::scenario::{Demand, Scenario};

/// Every how many control periods a trace keeps a row.
const TRACE_EVERY: usize = 5;

/// A controller of the joint.
pub trait Controller {
    /// Why a step failed, e.g. because the firmware no longer answers.
    type Error;

    /// One control period.
    ///
    /// # Errors
    /// Ends the run.
    fn step(&mut self, input: &Input<f32>) -> Result<Output<f32>, Self::Error>;
}

/// The compensator in the firmware's precision, on the desktop.
pub struct HostCompensator {
    model: Compensator<f32>,
    state: State<f32>,
}

impl HostCompensator {
    /// Builds from what the firmware is built from.
    ///
    /// # Errors
    /// As [`JointParams::build`].
    pub fn build(joint: &JointParams<f32>) -> Result<Self, Error> {
        let model = joint.build()?;
        let state = model.rest();
        Ok(Self { model, state })
    }

    /// One control step.
    pub fn step(&mut self, input: &Input<f32>) -> Output<f32> {
        self.model.step(&mut self.state, input)
    }
}

impl Controller for HostCompensator {
    type Error = RunError;

    fn step(&mut self, input: &Input<f32>) -> Result<Output<f32>, RunError> {
        Ok(self.step(input))
    }
}

impl Controller for Baseline {
    type Error = RunError;

    fn step(&mut self, input: &Input<f32>) -> Result<Output<f32>, RunError> {
        let motor_torque = Baseline::step(self, input) as f32;
        Ok(Output { motor_torque, ..Output::default() })
    }
}

/// One row of a trace.
#[derive(Clone, Copy, Debug, Default)]
pub struct Row {
    /// (s)
    pub time: f64,
    /// What was asked.
    pub demand: Demand,
    /// True output angle (rad).
    pub output: f64,
    /// True motor angle (rad).
    pub motor: f64,
    /// True torsion (rad).
    pub torsion: f64,
    /// True torque through the flexspline (N m).
    pub transmitted: f64,
    /// What the controller answered.
    pub answer: Output<f32>,
}

/// What came of one run.
#[derive(Clone, Debug)]
pub struct Run {
    /// Decimated rows.
    pub trace: Vec<Row>,
    /// Output error over the judged part, rms (rad).
    pub rms: f64,
    /// Largest output error over the judged part (rad).
    pub max: f64,
    /// Output error at the end of the run (rad).
    pub last: f64,
    /// What the controller's estimates miss; of no meaning for one that estimates nothing.
    pub estimate: EstimateErrors,
    /// Power balance of the plant: what is missing, as a share of the energy moved.
    pub imbalance: f64,
}

/// What the estimates of a controller miss over the judged part of a run, rms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimateErrors {
    /// Of the output angle (rad).
    pub output: f64,
    /// Of the external torque on the output (N m).
    pub external_torque: f64,
}

/// The joint's sensors, with noise that repeats for the same seed.
struct SensorModel {
    motor_encoder_bits: u32,
    output_encoder_bits: Option<u32>,
    motor_torque_noise: Normal<f64>,
    output_torque_noise: Option<Normal<f64>>,
    random: ChaCha8Rng,
}

impl SensorModel {
    fn new(file: &GearFile, seed: u64) -> Self {
        let noise = |deviation| Normal::new(0.0, deviation).expect("the gear file's noise is not negative");
        let sensors = &file.sensors;
        Self {
            motor_encoder_bits: sensors.motor_encoder_bits,
            output_encoder_bits: sensors.output_encoder_bits,
            motor_torque_noise: noise(sensors.motor_torque_noise),
            output_torque_noise: sensors.output_torque.then(|| noise(sensors.output_torque_noise)),
            random: ChaCha8Rng::seed_from_u64(seed),
        }
    }

    fn read(&mut self, plant: &Plant, motor_torque: f64) -> Sensors<f32> {
        let random = &mut self.random;
        Sensors {
            motor_encoder: encoder_count(plant.motor().angle, self.motor_encoder_bits),
            output_encoder: self.output_encoder_bits.map(|bits| encoder_count(plant.output().angle, bits)),
            motor_torque: (motor_torque + self.motor_torque_noise.sample(random)) as f32,
            output_torque: self
                .output_torque_noise
                .map(|noise| (plant.last_torques().transmitted + noise.sample(random)) as f32),
        }
    }
}

/// All corrections on, friction by the gear file's share.
fn all_shares(file: &GearFile) -> Shares<f32> {
    Shares {
        feedback: 1.0,
        inertia: 1.0,
        friction: file.compensation.friction_share as f32,
        wind_up: 1.0,
        kinematic_error: 1.0,
    }
}

/// Runs a scenario on the plant of `seed` (see [`Draw::from_seed`]); `progress` is called with the share done.
///
/// # Errors
/// The controller's, a gear that cannot be built, or a plant that diverges.
pub fn run<C: Controller>(
    file: &GearFile,
    scenario: Scenario,
    seed: u64,
    controller: &mut C,
    mut progress: impl FnMut(f64),
) -> Result<Run, C::Error>
where
    C::Error: From<RunError>,
{
    let steps = periods(scenario);
    let mut judge = Judge::default();
    let mut trace = Vec::with_capacity(steps / TRACE_EVERY + 1);
    let plant = each_period(file, scenario, seed, controller, |k, demand, plant, answer| {
        let time = k as f64 * CONTROL_PERIOD;
        if time >= scenario.judged_from() {
            judge.add(plant.output().angle.to_radians(), &demand, &answer.estimate);
        }
        if k % TRACE_EVERY == 0 {
            trace.push(row(time, demand, plant, answer));
            progress(k as f64 / steps as f64);
        }
    })?;
    Ok(judge.run(trace, plant.imbalance()))
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
    each_period(file, scenario, seed, controller, |_, demand, plant, _| {
        speed.push(plant.motor().velocity);
        load_torque.push(demand.load);
    })?;
    Ok(OpenLoop {
        time: Time::every(CONTROL_PERIOD, speed.len()),
        drive: Drive::Velocity(speed),
        load_torque,
    })
}

/// Control periods of a scenario.
fn periods(scenario: Scenario) -> usize {
    (scenario.duration() / CONTROL_PERIOD).round() as usize
}

/// Closes the loop; `visit` sees the plant at the start of each period with the controller's answer to it.
fn each_period<C: Controller>(
    file: &GearFile,
    scenario: Scenario,
    seed: u64,
    controller: &mut C,
    mut visit: impl FnMut(usize, Demand, &Plant, Output<f32>),
) -> Result<Plant, C::Error>
where
    C::Error: From<RunError>,
{
    let nominal = firmware_gear_params(file).map_err(RunError::from)?;
    let plant = Plant::build(&Draw::from_seed(seed).apply(&nominal));
    let mut plant = plant.map_err(RunError::from)?;
    let mut sensors = SensorModel::new(file, seed);
    let mut torque = 0.0;
    for k in 0..periods(scenario) {
        let demand = scenario.at(k as f64 * CONTROL_PERIOD, file.gear.rated_torque);
        let sensors = sensors.read(&plant, torque);
        let input = Input { sensors, command: demand.setpoint().into(), shares: all_shares(file).into() };
        let answer = controller.step(&input)?;
        visit(k, demand, &plant, answer);
        torque = f64::from(answer.motor_torque);
        let moved = if scenario.blocked() {
            torque = 0.0;
            plant.step_blocked(demand.load)
        } else {
            plant.step(torque, demand.load)
        };
        moved.map_err(RunError::from)?;
    }
    Ok(plant)
}

/// The scores of a run.
#[derive(Default)]
struct Judge {
    output: Score,
    estimated_output: Score,
    estimated_external_torque: Score,
}

impl Judge {
    /// Counts one control period: the true output angle (rad), what was asked and what was estimated.
    fn add(&mut self, output: f64, demand: &Demand, estimate: &Estimate<f32>) {
        self.output.add(output - demand.position);
        self.estimated_output.add(estimate.output_position.to_radians() - output);
        self.estimated_external_torque.add(f64::from(estimate.external_torque) - demand.load);
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

fn row(time: f64, demand: Demand, plant: &Plant, answer: Output<f32>) -> Row {
    let torques = plant.last_torques();
    Row {
        time,
        demand,
        output: plant.output().angle.to_radians(),
        motor: plant.motor().angle.to_radians(),
        torsion: torques.torsion,
        transmitted: torques.transmitted,
        answer,
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
