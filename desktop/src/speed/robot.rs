//! A control period of the whole two-joint arm of scenario S7: gears with condensed meshes, links, sensors and a compensator with both
//! encoders at each joint. In real time it may take 0.1 ms. Beside it the same with the reference mesh, literal eq. (6), in both gears.

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
use strainwave::flexspline::Flexspline;

/// Control periods of a pass, with condensed gears and with the reference mesh.
const PERIODS: usize = 1000;
const REFERENCE_PERIODS: usize = 2;

/// The kernel with condensed gears.
const CONDENSED: &str = "robot.period";

/// The first periods of a circle.
struct Beginning {
    circle: Circle,
    periods: usize,
}

impl RobotTask for Beginning {
    fn duration(&self) -> f64 {
        self.periods as f64 * CONTROL_PERIOD
    }

    fn at(&self, time: f64) -> Vec<Demand> {
        self.circle.at(time)
    }
}

pub(super) fn kernels() -> Result<Vec<Kernel>, Error> {
    Ok(vec![
        kernel([CONDENSED, floor::NAME], PERIODS, RobotPlant::condensed)?,
        kernel(["robot.period_36x4", CONDENSED], REFERENCE_PERIODS, RobotPlant::reference)?,
    ])
}

/// A kernel of this name, beside its rival.
fn kernel<F: Flexspline<f64> + Clone + 'static>(
    [name, rival]: [&'static str; 2],
    periods: usize,
    plant: fn(&RobotSample) -> Result<RobotPlant<F>, strainwave::Error>,
) -> Result<Kernel, Error>
where
    F::State: 'static,
{
    let robot = RobotFile::example();
    let circle =
        Circle::of(&robot, CircleParams::default()).expect("the example draws its circle, which is tested");
    let sample = RobotSample::boxed(&robot, 0).map_err(RunError::from)?;
    let plant = plant(&sample).map_err(RunError::from)?;
    let bench = RobotBench::new(plant, &robot, 0, SensorSet::Both);
    let controllers = compensators(&robot).map_err(RunError::from)?;
    let task = Beginning { circle, periods };
    Ok(Kernel::new(name, rival, periods, move || {
        let went = bench.clone().go(&task, &mut controllers.clone(), |moment| {
            black_box(moment.answers);
        });
        black_box(went.is_ok());
    }))
}
