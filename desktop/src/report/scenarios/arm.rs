//! S7: the tip of the example's two-joint arm on its circle.

use maud::{Markup, html};

use crate::bench::baseline::Kind;
use crate::bench::controller::Controller as Controls;
use crate::io::figure::{Figure, number};
use crate::io::file::BadInput;
use crate::io::gear_file::SensorSet;
use crate::plant::divergence::RunError;
use crate::report::controller::Controller;
use crate::report::plot::{Page, Panel};
use crate::report::{figure, plot, table};
use crate::robot::bench::{RobotBench, baselines, compensators};
use crate::robot::circle::CircleParams;
use crate::robot::motions::RobotWork;
use crate::robot::{Circle, RobotFile, RobotPlant, RobotRun, RobotSample};
use crate::verify::compensator::each;

/// The robot: the first that its claims are judged on.
const SEED: u64 = crate::verify::robot::FIRST;
/// Points of a curve.
const POINTS: usize = 1500;

const CONTROLLERS: [Controller; 4] = [
    Controller::Baseline(1),
    Controller::Compensator(SensorSet::Motor),
    Controller::Baseline(3),
    Controller::Compensator(SensorSet::Both),
];

pub(super) fn section(progress: &mut dyn FnMut(f64)) -> Result<(Markup, Vec<Figure>), BadInput> {
    let robot = RobotFile::example();
    let circle = Circle::of(&robot, CircleParams::default()).map_err(BadInput::message)?;
    let mut on = |fraction: f64| progress(fraction);
    let runs = each(&CONTROLLERS, |controller| run(&robot, &circle, *controller), &mut on);
    let runs = runs.into_iter().collect::<Result<Vec<_>, _>>().map_err(BadInput::message)?;
    let found: Vec<_> = CONTROLLERS.into_iter().zip(&runs).collect();
    let rows: Vec<_> = found.iter().map(|(controller, run)| row(*controller, run, &runs[0])).collect();
    let CircleParams { radius, period, laps } = CircleParams::default();
    let body = html! {
        h3 #s7 { "S7: the tip of a two-joint arm on a circle" }
        p {
            "The arm of " code { "examples/arm" } " under gravity, whatever gear this page is of: " (laps) " laps of a circle of radius "
            (radius) " m, a lap in " (period) " s, on the robot of seed " (SEED) ". Every joint has a controller of its own, all have worked 10 s."
        }
        (figure(&plot(&drawn(&found)), &html! { "Distance of the tip from where it should be." }))
        (table(["controller", "tip error, rms (um)", "largest (um)", "of B1"], &rows))
    };
    let figures = found.iter().flat_map(|(controller, run)| {
        let name = |what: &str| format!("report.s7.{}.{what}", controller.name());
        [Figure::reported(name("tip"), run.rms(), "m"), Figure::reported(name("tip_max"), run.largest(), "m")]
    });
    Ok((body, figures.collect()))
}

fn run(robot: &RobotFile, circle: &Circle, controller: Controller) -> Result<RobotRun, RunError> {
    match controller {
        Controller::Baseline(place) => lap(robot, circle, controller, baselines(robot, Kind::ALL[place])?),
        Controller::Compensator(_) => lap(robot, circle, controller, compensators(robot)?),
    }
}

fn lap<C: Controls<Error = RunError>>(
    robot: &RobotFile,
    circle: &Circle,
    controller: Controller,
    controllers: Vec<C>,
) -> Result<RobotRun, RunError> {
    let plant = RobotPlant::condensed(&RobotSample::boxed(robot, SEED)?)?;
    let bench = RobotBench::new(plant, robot, SEED, controller.sensors());
    RobotRun::of(bench, controllers, Some(&RobotWork::of(robot)), circle, |_| ())
}

fn row(controller: Controller, run: &RobotRun, b1: &RobotRun) -> [String; 4] {
    [
        controller.title().into(),
        number(run.rms() * 1e6),
        number(run.largest() * 1e6),
        number(run.rms() / b1.rms()),
    ]
}

/// A panel for each set of sensors; B1 in both.
fn drawn(found: &[(Controller, &RobotRun)]) -> Page {
    let reference = found[0].0;
    let panel = |title: &str, shown: &dyn Fn(Controller) -> bool| {
        let panel = Panel::new("time", "s", "tip error", "um").titled(title);
        found.iter().filter(|(controller, _)| shown(*controller)).fold(panel, |panel, (controller, run)| {
            let rows: Vec<_> = run.rows.iter().step_by(run.rows.len().div_ceil(POINTS).max(1)).collect();
            let time: Vec<_> = rows.iter().map(|row| row.time).collect();
            let error: Vec<_> = rows.iter().map(|row| row.tip_error() * 1e6).collect();
            panel.with(controller.series(&time, &error))
        })
    };
    Page::slide("")
        .with(panel("motor encoders", &|controller| !controller.reads_output()))
        .with(panel("both encoders", &|controller| controller.reads_output() || controller == reference))
}
