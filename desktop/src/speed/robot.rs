//! A control period of the whole two-joint arm of scenario S7: gears with condensed meshes, links, sensors and a compensator with both
//! encoders at each joint. In real time it may take 0.1 ms.

use std::hint::black_box;

use super::{Error, Kernel, floor};
use crate::bench::task::Demand;
use crate::io::gear_file::SensorSet;
use crate::plant::divergence::RunError;
use crate::robot::bench::compensators;
use crate::robot::circle::CircleParams;
use crate::robot::motions::RobotTask;
use crate::robot::{Circle, RobotBench, RobotFile, RobotPlant, RobotSample};
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Control periods of a pass.
const PERIODS: usize = 1000;

/// The first periods of a circle.
struct Beginning(Circle);

impl RobotTask for Beginning {
    fn duration(&self) -> f64 {
        PERIODS as f64 * CONTROL_PERIOD
    }

    fn at(&self, time: f64) -> Vec<Demand> {
        self.0.at(time)
    }
}

pub(super) fn kernel() -> Result<Kernel, Error> {
    let robot = RobotFile::example();
    let circle =
        Circle::of(&robot, CircleParams::default()).expect("the example draws its circle, which is tested");
    let sample = RobotSample::boxed(&robot, 0).map_err(RunError::from)?;
    let plant = RobotPlant::condensed(&sample).map_err(RunError::from)?;
    let bench = RobotBench::new(plant, &robot, 0, SensorSet::Both);
    let controllers = compensators(&robot).map_err(RunError::from)?;
    let task = Beginning(circle);
    Ok(Kernel::new("robot.period", floor::NAME, PERIODS, move || {
        let went = bench.clone().go(&task, &mut controllers.clone(), |moment| {
            black_box(moment.answers);
        });
        black_box(went.is_ok());
    }))
}
