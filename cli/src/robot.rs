//! `robot`: an arm of several joints draws a circle or follows trajectories, each joint with its own controller.

use std::path::{Path, PathBuf};

use clap::{Args, value_parser};
use strainwave::flexspline::Flexspline;
use strainwave_desktop::bench::Trajectory;
use strainwave_desktop::bench::baseline::Kind;
use strainwave_desktop::io::gear_file::SensorSet;
use strainwave_desktop::io::log::{CommandedMotion, write_columns};
use strainwave_desktop::plant::divergence::RunError;
use strainwave_desktop::robot::bench::{RobotBench, baselines, compensators};
use strainwave_desktop::robot::circle::CircleParams;
use strainwave_desktop::robot::motions::{RobotTask, RobotTrajectory, RobotWork};
use strainwave_desktop::robot::run::RobotRow;
use strainwave_desktop::robot::{Circle, RobotFile, RobotPlant, RobotRun, RobotSample};
use strainwave_desktop::{BadInput, Figure};

use crate::figures::{Figures, FiguresArguments};
use crate::files;
use crate::progress::Progress;
use crate::robot_picture::picture;

/// Controllers, in the order of the runs.
pub const CONTROLLERS: [&str; 3] = ["b1", "motor", "both"];

/// Run an arm of several joints, each with its gear and a controller of its own: scenario S7, or trajectories of the user
///
/// Three runs on the same robot: the baseline B1 at every joint (`b1`), and the compensator at every joint with the motor encoder alone (`motor`)
/// and with both encoders (`both`). No controller is told of gravity or of the other joints. Before the motion the joints work for 10 s, from which the
/// compensators learn. The tip's error is its distance from where the demanded angles lead; in a circle the laps at full
/// speed count. ROBOT.toml names the joints' gear files and describes their links. Angles, lengths and torques in SI units.
#[derive(Args)]
pub struct Arguments {
    /// Robot file, such as examples/arm/arm.toml
    #[arg(value_name = "ROBOT.toml")]
    robot: PathBuf,
    /// Radius of the circle that a two-joint arm draws (m), from the tip of its start towards the base
    #[arg(long, value_name = "M", allow_hyphen_values = true, conflicts_with = "trajectories", default_value_t = CircleParams::default().radius)]
    circle: f64,
    /// Time of a lap (s), 0.1 to 60
    #[arg(long, value_name = "S", allow_hyphen_values = true, conflicts_with = "trajectories", default_value_t = CircleParams::default().period)]
    period: f64,
    /// Laps at full speed
    #[arg(long, value_name = "COUNT", conflicts_with = "trajectories", default_value_t = CircleParams::default().laps, value_parser = value_parser!(u32).range(1..=100))]
    laps: u32,
    /// Motion of a joint in the place of the circle, as `pil --trajectory` reads it; once for every joint, from the base on
    ///
    /// The joint starts at the angle of the first row. tau_load_nm is a torque on the joint besides the arm's own.
    #[arg(long = "trajectory", value_name = "JOINT.csv")]
    trajectories: Vec<PathBuf>,
    /// The robot: joint i has friction, stiffness and link from the box of seed SEED + i - 1; 0 is the robot of the file
    #[arg(long, value_name = "SEED", default_value_t = 0, value_parser = value_parser!(u64).range(0..=1_000_000_000))]
    seed: u64,
    /// Start the motion at once, without the 10 s of work
    #[arg(long)]
    without_work: bool,
    /// Gears with the reference mesh in the place of the condensed one: some hundred times slower
    #[arg(long)]
    reference: bool,
    /// Tip, angles, torsions and torques of all runs every 0.1 ms (CSV), complete or not at all; - for the standard output
    #[arg(long, value_name = "OUT.csv")]
    series: Option<PathBuf>,
    /// Draw the tip's way in the x-y plane, its error magnified (SVG)
    #[arg(long, value_name = "FILE.svg")]
    picture: Option<PathBuf>,
    #[command(flatten)]
    figures: FiguresArguments,
}

/// Least and most of `--period` (s).
const PERIOD: [f64; 2] = [0.1, 60.0];

/// Reads, runs and writes.
pub fn run(arguments: &Arguments) -> Result<Figures, BadInput> {
    let (json, series) = (arguments.figures.json.as_deref(), arguments.series.as_deref());
    let mut named = vec![
        ("ROBOT.toml", Some(arguments.robot.as_path())),
        ("--series", series),
        ("--picture", arguments.picture.as_deref()),
        ("--json", json),
    ];
    named.extend(arguments.trajectories.iter().map(|path| ("--trajectory", Some(path.as_path()))));
    files::require_distinct(&named)?;
    let mut robot = RobotFile::read(&arguments.robot)?;
    if arguments.trajectories.is_empty() {
        let circle = circle(arguments, &robot)?;
        let judged = circle.judged();
        return follow(arguments, &robot, &circle, judged);
    }
    let trajectory = trajectories(arguments, &mut robot)?;
    let judged = [0.0, trajectory.duration()];
    follow(arguments, &robot, &trajectory, judged)
}

fn circle(arguments: &Arguments, robot: &RobotFile) -> Result<Circle, BadInput> {
    let Arguments { circle: radius, period, laps, .. } = *arguments;
    if !(PERIOD[0]..=PERIOD[1]).contains(&period) {
        let why = format_args!("--period {period} is out of range; allowed: a number from 0.1 to 60 s");
        return Err(BadInput::message(why));
    }
    Circle::of(robot, CircleParams { radius, period, laps })
        .map_err(|why| BadInput::new(&arguments.robot, why))
}

/// A trajectory for each joint, which starts where its first row is.
fn trajectories(arguments: &Arguments, robot: &mut RobotFile) -> Result<RobotTrajectory, BadInput> {
    let (given, joints) = (arguments.trajectories.len(), robot.joints.len());
    if given != joints {
        return Err(BadInput::new(
            &arguments.robot,
            format_args!("{joints} joints; --trajectory is given {given} times"),
        ));
    }
    let read = |(path, joint): (&PathBuf, &mut strainwave_desktop::robot::file::Joint)| {
        let trajectory = Trajectory::of(&CommandedMotion::read(path)?);
        trajectory.require_within(&joint.gear).map_err(|why| BadInput::new(path, why))?;
        joint.start = trajectory.zero();
        Ok(trajectory)
    };
    Ok(RobotTrajectory(
        arguments.trajectories.iter().zip(&mut robot.joints).map(read).collect::<Result<_, _>>()?,
    ))
}

fn follow(
    arguments: &Arguments,
    robot: &RobotFile,
    task: &impl RobotTask,
    judged: [f64; 2],
) -> Result<Figures, BadInput> {
    for path in [&arguments.series, &arguments.picture, &arguments.figures.json] {
        files::require_writable(path.as_deref())?;
    }
    let sample =
        RobotSample::boxed(robot, arguments.seed).map_err(|why| BadInput::new(&arguments.robot, why))?;
    let runs = if arguments.reference {
        runs(arguments, robot, &sample, task, judged, RobotPlant::reference)
    } else {
        runs(arguments, robot, &sample, task, judged, RobotPlant::condensed)
    };
    let runs = runs.map_err(|why| BadInput::new(&arguments.robot, why))?;
    if let Some(path) = &arguments.series {
        write_series(path, &runs)?;
    }
    if let Some(path) = &arguments.picture {
        picture(&runs).write(path)?;
    }
    let figures = figures(&runs);
    Ok(match &arguments.series {
        Some(path) => Figures::beside(path, figures, &arguments.figures),
        None => Figures::new(figures, &arguments.figures),
    })
}

fn runs<F: Flexspline<f64>>(
    arguments: &Arguments,
    robot: &RobotFile,
    sample: &RobotSample,
    task: &impl RobotTask,
    judged: [f64; 2],
    build: fn(&RobotSample) -> Result<RobotPlant<F>, strainwave::Error>,
) -> Result<Vec<RobotRun>, RunError> {
    let mut progress = Progress::new(1000, "robot");
    let work = (!arguments.without_work).then(|| RobotWork::of(robot));
    let bench = |sensors| Ok::<_, RunError>(RobotBench::new(build(sample)?, robot, arguments.seed, sensors));
    let count = CONTROLLERS.len() as f64;
    let mut done = |run: f64| move |fraction: f64| (1e3 * (run + fraction) / count) as u64;
    let b1 = baselines(robot, Kind::B1)?;
    let (bench_b1, of_b1) = (bench(SensorSet::Motor)?, done(0.0));
    let mut runs = vec![RobotRun::of(bench_b1, b1, work.as_ref(), task, judged, |fraction| {
        progress.set(of_b1(fraction))
    })?];
    for (index, sensors) in SensorSet::ALL.into_iter().enumerate() {
        let of = done(1.0 + index as f64);
        let controllers = compensators(robot)?;
        let bench = bench(sensors)?;
        runs.push(RobotRun::of(bench, controllers, work.as_ref(), task, judged, |fraction| {
            progress.set(of(fraction));
        })?);
    }
    Ok(runs)
}

/// Errors of the tip, of those compensated over that of B1 too.
fn figures(runs: &[RobotRun]) -> Vec<Figure> {
    let mut figures = Vec::new();
    for (name, run) in CONTROLLERS.into_iter().zip(runs) {
        figures.push(Figure::reported(format!("robot.{name}.tip.rms"), run.rms(), "m"));
        figures.push(Figure::reported(format!("robot.{name}.tip.max"), run.largest(), "m"));
        if name != CONTROLLERS[0] {
            figures.push(Figure::reported(format!("robot.{name}.to_b1"), run.rms() / runs[0].rms(), "1"));
        }
    }
    figures
}

fn write_series(path: &Path, runs: &[RobotRun]) -> Result<(), BadInput> {
    let shared = &runs[0].rows;
    // Stamps on the grid, not with the last digits of their rounding.
    let mut columns = vec![column("t_s".into(), shared, |row| (row.time * 1e9).round() / 1e9)];
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        columns.push(column(format!("tip_{name}_set_m"), shared, |row| row.demanded_tip[axis]));
    }
    for (controller, run) in CONTROLLERS.into_iter().zip(runs) {
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            columns.push(column(format!("tip_{name}_{controller}_m"), &run.rows, |row| row.tip[axis]));
        }
    }
    for joint in 0..shared.first().map_or(0, |row| row.joints.len()) {
        let number = joint + 1;
        columns.push(column(format!("theta_{number}_set_rad"), shared, |row| row.joints[joint].demanded));
        for (name, run) in CONTROLLERS.into_iter().zip(runs) {
            let rows = &run.rows;
            columns.extend([
                column(format!("theta_{number}_{name}_rad"), rows, |row| row.joints[joint].output),
                column(format!("torsion_{number}_{name}_rad"), rows, |row| row.joints[joint].torsion),
                column(format!("tau_load_{number}_{name}_nm"), rows, |row| row.joints[joint].load),
                column(format!("tau_motor_{number}_{name}_nm"), rows, |row| row.joints[joint].motor_torque),
            ]);
        }
    }
    let columns: Vec<_> = columns.iter().map(|(name, values)| (name.clone(), values.as_slice())).collect();
    write_columns(path, &columns)
}

fn column(name: String, rows: &[RobotRow], of: impl Fn(&RobotRow) -> f64) -> (String, Vec<f64>) {
    (name, rows.iter().map(of).collect())
}
