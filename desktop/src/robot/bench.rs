//! A robot on the bench: every joint with its sensors and a controller of its own, every 0.1 ms.
//!
//! A controller is what it would be for the joint alone: built from its gear file, which tells it one constant inertia of the load and
//! nothing of gravity, of the other joints or of their motion.

use strainwave::Error;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::compensator::{CompensationGains, Input, Output, Status};
use strainwave::flexspline::Flexspline;

use super::file::{Joint, RobotFile};
use super::motions::RobotTask;
use super::plant::RobotPlant;
use super::sample::seed_of_joint;
use crate::bench::Conditions;
use crate::bench::baseline::{Baseline, Kind};
use crate::bench::controller::{Controller, HostCompensator};
use crate::bench::joint_bench::{SensorModel, all_gains};
use crate::bench::task::Demand;
use crate::design::joint::joint_params;
use crate::io::gear_file::SensorSet;
use crate::plant::divergence::RunError;

/// Plant, sensors, and the controllers' last answers.
#[derive(Clone)]
pub struct RobotBench<F: Flexspline<f64>> {
    plant: RobotPlant<F>,
    sensors: Vec<SensorModel>,
    gains: Vec<CompensationGains<f32>>,
    /// The bench has run.
    started: bool,
}

/// One control period of a robot.
pub struct Moment<'a, F: Flexspline<f64>> {
    /// Since the start of the task (s).
    pub time: f64,
    /// Demand of each joint.
    pub demands: &'a [Demand],
    /// The robot at the start of the period.
    pub plant: &'a RobotPlant<F>,
    /// Answer of each controller.
    pub answers: &'a [Output<f32>],
}

impl<F: Flexspline<f64>> RobotBench<F> {
    /// A robot at rest, its noise from the seeds of its joints.
    pub fn new(plant: RobotPlant<F>, file: &RobotFile, seed: u64, sensors: SensorSet) -> Self {
        let model = |(index, joint): (usize, &Joint)| {
            let seed = seed_of_joint(seed, index);
            let conditions = Conditions { sensors, ..Conditions::of(&joint.gear, seed) };
            SensorModel::new(&joint.gear, &conditions, &Default::default())
        };
        Self {
            plant,
            sensors: file.joints.iter().enumerate().map(model).collect(),
            gains: file.joints.iter().map(|joint| all_gains(&joint.gear)).collect(),
            started: false,
        }
    }

    /// The plant as it is now.
    pub fn plant(&self) -> &RobotPlant<F> {
        &self.plant
    }

    /// Goes through a task from where the robot is; `visit` sees every control period.
    ///
    /// # Errors
    /// A controller's, or a plant that diverges.
    pub fn go<C: Controller<Error = RunError>>(
        &mut self,
        task: &impl RobotTask,
        controllers: &mut [C],
        mut visit: impl FnMut(&Moment<'_, F>),
    ) -> Result<(), RunError> {
        for period in 0..(task.duration() / CONTROL_PERIOD).round() as usize {
            let time = period as f64 * CONTROL_PERIOD;
            let demands = task.at(time);
            let answers = self.answers(&demands, controllers)?;
            visit(&Moment { time, demands: &demands, plant: &self.plant, answers: &answers });
            self.plant.command(answers.iter().map(|answer| answer.motor_torque.into()));
            self.plant.go_on(&demands.iter().map(|demand| demand.load).collect::<Vec<_>>())?;
        }
        Ok(())
    }

    fn answers<C: Controller<Error = RunError>>(
        &mut self,
        demands: &[Demand],
        controllers: &mut [C],
    ) -> Result<Vec<Output<f32>>, RunError> {
        let elapsed = if std::mem::replace(&mut self.started, true) { CONTROL_PERIOD as f32 } else { 0.0 };
        let joints = self.sensors.iter_mut().zip(self.plant.joints()).zip(&self.gains);
        let input = |((sensors, plant), gains): ((&mut SensorModel, _), &CompensationGains<f32>),
                     demand: &Demand| Input {
            sensors: sensors.read(plant, 0.0),
            command: demand.setpoint().into(),
            gains: (*gains).into(),
            elapsed,
            setpoint_age: 0.0,
            status: Status::FINE,
        };
        joints
            .zip(demands)
            .zip(controllers)
            .map(|((joint, demand), c)| c.step(&input(joint, demand)))
            .collect()
    }
}

/// The compensator of each joint.
///
/// # Errors
/// As [`HostCompensator::build`].
pub fn compensators(file: &RobotFile) -> Result<Vec<HostCompensator>, Error> {
    file.joints.iter().map(|joint| HostCompensator::build(&joint_params(&joint.gear)?)).collect()
}

/// A baseline of each joint, with the gains that its gear file has.
///
/// # Errors
/// As [`Baseline::build`].
pub fn baselines(file: &RobotFile, kind: Kind) -> Result<Vec<Baseline>, Error> {
    file.joints.iter().map(|joint| Baseline::build(&joint.gear, kind)).collect()
}
