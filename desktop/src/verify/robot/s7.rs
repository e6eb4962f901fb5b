//! Scenario S7 on robots that no controller knows.

use crate::bench::baseline::Kind;
use crate::bench::controller::Controller;
use crate::io::figure::Figure;
use crate::io::gear_file::SensorSet;
use crate::plant::divergence::RunError;
use crate::robot::bench::{RobotBench, baselines, compensators};
use crate::robot::circle::CircleParams;
use crate::robot::motions::RobotWork;
use crate::robot::{Circle, RobotFile, RobotPlant, RobotRun, RobotSample};
use crate::verify::Measured;
use crate::verify::bounds;
use crate::verify::compensator::each;

/// A controller of S7.
#[derive(Clone, Copy)]
enum Rival {
    Baseline(Kind),
    Compensated(SensorSet),
}

/// Controllers by name, and the row of those whose ratio to the first is a claim.
const CONTROLLERS: [(&str, Rival, Option<&str>); 4] = [
    ("b1", Rival::Baseline(Kind::B1), None),
    ("motor", Rival::Compensated(SensorSet::Motor), Some("robot.s7.motor.to_b1")),
    ("both", Rival::Compensated(SensorSet::Both), Some("robot.s7.both.to_b1")),
    ("b3", Rival::Baseline(Kind::B3), None),
];

/// One run of S7.
#[derive(Clone, Copy)]
struct Job {
    seed: u64,
    controller: Rival,
}

impl Job {
    fn of_seed(seed: u64) -> impl Iterator<Item = Self> {
        CONTROLLERS.into_iter().map(move |(_, controller, _)| Self { seed, controller })
    }

    /// Error of the tip, rms (m).
    fn run(&self, robot: &RobotFile, circle: &Circle) -> Result<f64, RunError> {
        match self.controller {
            Rival::Baseline(kind) => self.tip_error(robot, circle, kind.sensors(), baselines(robot, kind)?),
            Rival::Compensated(sensors) => self.tip_error(robot, circle, sensors, compensators(robot)?),
        }
    }

    fn tip_error<C: Controller<Error = RunError>>(
        &self,
        robot: &RobotFile,
        circle: &Circle,
        sensors: SensorSet,
        controllers: Vec<C>,
    ) -> Result<f64, RunError> {
        let plant = RobotPlant::condensed(&RobotSample::boxed(robot, self.seed)?)?;
        let bench = RobotBench::new(plant, robot, self.seed, sensors);
        let work = RobotWork::of(robot);
        Ok(RobotRun::of(bench, controllers, Some(&work), circle, |_| ())?.rms())
    }
}

/// The robot and circle of S7.
fn scenario() -> (RobotFile, Circle) {
    let robot = RobotFile::example();
    let circle =
        Circle::of(&robot, CircleParams::default()).expect("the example draws its circle, which is tested");
    (robot, circle)
}

pub(super) fn errors(seed: u64) -> Result<[f64; 3], RunError> {
    let (robot, circle) = scenario();
    let run = |(_, controller, _): (&str, Rival, Option<&str>)| Job { seed, controller }.run(&robot, &circle);
    let [b1, motor, both, _] = CONTROLLERS;
    Ok([run(b1)?, run(motor)?, run(both)?])
}

pub(super) fn measure(first: u64, robots: u64, mut progress: impl FnMut(f64)) -> Result<Measured, RunError> {
    let (robot, circle) = scenario();
    let seeds: Vec<_> = (0..robots).map(|index| first + index * robot.joints.len() as u64).collect();
    let jobs: Vec<_> = seeds.iter().flat_map(|seed| Job::of_seed(*seed)).collect();
    let found = each(&jobs, |job| job.run(&robot, &circle), &mut progress);
    let found = found.into_iter().collect::<Result<Vec<_>, _>>()?;
    let of = |controller: usize| found.iter().skip(controller).step_by(CONTROLLERS.len()).copied();
    let mut figures = Vec::new();
    for (controller, (name, _, row)) in CONTROLLERS.into_iter().enumerate() {
        let ratios = of(controller).zip(of(0)).map(|(ours, b1)| ours / b1);
        let worst = seeds.iter().zip(ratios).max_by(|a, b| a.1.total_cmp(&b.1));
        figures.extend(row.zip(worst).map(|(row, (seed, ratio))| bounds::figure(row, ratio).of_seed(*seed)));
        figures.push(Figure::reported(format!("robot.s7.{name}"), median(of(controller).collect()), "m"));
    }
    Ok(figures.into())
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
