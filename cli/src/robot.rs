//! `robot`: an arm of several joints draws a circle or follows trajectories, each joint with its own controller.

use std::path::{Path, PathBuf};

use clap::{Args, value_parser};
use strainwave::flexspline::Flexspline;
use strainwave_desktop::bench::Trajectory;
use strainwave_desktop::bench::baseline::Kind;
use strainwave_desktop::bench::controller::Controller;
use strainwave_desktop::io::gear_file::SensorSet;
use strainwave_desktop::io::log::{CommandedMotion, write_columns};
use strainwave_desktop::plant::divergence::RunError;
use strainwave_desktop::robot::bench::{RobotBench, baselines, compensators};
use strainwave_desktop::robot::circle::CircleParams;
use strainwave_desktop::robot::file::Joint;
use strainwave_desktop::robot::motions::{RobotTask, RobotTrajectory, RobotWork, require_within, warnings};
use strainwave_desktop::robot::plant::require_modes;
use strainwave_desktop::robot::run::{JointRow, RobotRow};
use strainwave_desktop::robot::{Circle, RobotFile, RobotPlant, RobotRun, RobotSample};
use strainwave_desktop::{BadInput, Figure};

use crate::figures::{Figures, FiguresArguments, complain};
use crate::files;
use crate::progress::Progress;
use crate::robot_picture::picture;

/// Controllers, in the order of the runs.
const CONTROLLERS: [&str; 3] = ["b1", "motor", "both"];

/// Run an arm of several joints, each with its gear and a controller of its own: scenario S7, or trajectories of the user
///
/// Three runs on the same robot: the baseline B1 at every joint (`b1`), and the compensator at every joint with the motor encoder alone (`motor`)
/// and with both encoders (`both`). No controller is told of gravity or of the other joints. Before the motion the joints work for 10 s, from which the
/// compensators learn. The tip's error is its distance from where the demanded angles lead; in a circle the laps at full
/// speed count. ROBOT.toml names the joints' gear files and describes their links, or names a URDF file that does; a link may be a beam that
/// bends. Angles, lengths and torques in SI units.
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
        return follow(arguments, &robot, &circle(arguments, &robot)?);
    }
    let trajectory = trajectories(arguments, &mut robot)?;
    follow(arguments, &robot, &trajectory)
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
    let read = |(path, joint): (&PathBuf, &mut Joint)| {
        let trajectory = Trajectory::of(&CommandedMotion::read(path)?);
        trajectory.require_within(&joint.gear).map_err(|why| BadInput::new(path, why))?;
        joint.start = trajectory.zero();
        Ok(trajectory)
    };
    Ok(RobotTrajectory(
        arguments.trajectories.iter().zip(&mut robot.joints).map(read).collect::<Result<_, _>>()?,
    ))
}

/// A robot and what it is asked for.
struct Trial<'a, T> {
    robot: &'a RobotFile,
    sample: RobotSample,
    work: Option<RobotWork>,
    task: &'a T,
}

impl<T: RobotTask> Trial<'_, T> {
    /// A run of each controller; `progress` is called with the fraction of all that is done.
    fn runs<F: Flexspline<f64>>(
        &self,
        build: fn(&RobotSample) -> Result<RobotPlant<F>, strainwave::Error>,
        mut progress: impl FnMut(f64),
    ) -> Result<Vec<RobotRun>, RunError> {
        let share = |done: f64, fraction: f64| (done + fraction) / CONTROLLERS.len() as f64;
        let bench = |sensors| {
            Ok::<_, RunError>(RobotBench::new(build(&self.sample)?, self.robot, self.sample.seed, sensors))
        };
        let b1 = self
            .run(bench(SensorSet::Motor)?, baselines(self.robot, Kind::B1)?, |f| progress(share(0.0, f)))?;
        let motor =
            self.run(bench(SensorSet::Motor)?, compensators(self.robot)?, |f| progress(share(1.0, f)))?;
        let both =
            self.run(bench(SensorSet::Both)?, compensators(self.robot)?, |f| progress(share(2.0, f)))?;
        Ok(vec![b1, motor, both])
    }

    fn run<F: Flexspline<f64>, C: Controller<Error = RunError>>(
        &self,
        bench: RobotBench<F>,
        controllers: Vec<C>,
        progress: impl FnMut(f64),
    ) -> Result<RobotRun, RunError> {
        RobotRun::of(bench, controllers, self.work.as_ref(), self.task, progress)
    }
}

fn follow(arguments: &Arguments, robot: &RobotFile, task: &impl RobotTask) -> Result<Figures, BadInput> {
    for path in [&arguments.series, &arguments.picture, &arguments.figures.json] {
        files::require_writable(path.as_deref())?;
    }
    require_within(task, robot).map_err(|why| BadInput::new(&arguments.robot, why))?;
    let refuse = |why: RunError| BadInput::new(&arguments.robot, why);
    let sample = RobotSample::boxed(robot, arguments.seed).map_err(|why| refuse(why.into()))?;
    if !arguments.reference {
        require_modes(&sample).map_err(|why| BadInput::new(&arguments.robot, why))?;
    }
    let odd = warnings(task, robot).map_err(|why| refuse(why.into()))?;
    odd.iter().for_each(|line| complain(format_args!("warning: {}: {line}", arguments.robot.display())));
    let work = (!arguments.without_work).then(|| RobotWork::of(robot));
    let trial = Trial { robot, sample, work, task };
    let mut progress = Progress::new(1000, "robot");
    let fraction = |fraction: f64| progress.set((fraction * 1e3) as u64);
    let runs = if arguments.reference {
        trial.runs(RobotPlant::reference, fraction)
    } else {
        trial.runs(RobotPlant::condensed, fraction)
    };
    drop(progress);
    publish(arguments, &runs.map_err(refuse)?)
}

fn publish(arguments: &Arguments, runs: &[RobotRun]) -> Result<Figures, BadInput> {
    if let Some(path) = &arguments.series {
        write_series(path, runs)?;
    }
    if let Some(path) = &arguments.picture {
        picture(runs).write(path)?;
    }
    let figures = figures(runs);
    Ok(match &arguments.series {
        Some(path) => Figures::beside(path, figures, &arguments.figures),
        None => Figures::new(figures, &arguments.figures),
    })
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

/// A column's name and values.
type Column = (String, Vec<f64>);

fn write_series(path: &Path, runs: &[RobotRun]) -> Result<(), BadInput> {
    let joints = runs[0].rows.first().map_or(0, |row| row.joints.len());
    let columns: Vec<_> = tip_columns(runs)
        .into_iter()
        .chain((0..joints).flat_map(|joint| joint_columns(runs, joint)))
        .collect();
    let columns: Vec<_> = columns.iter().map(|(name, values)| (name.clone(), values.as_slice())).collect();
    write_columns(path, &columns)
}

/// Time, and place of the tip (m).
fn tip_columns(runs: &[RobotRun]) -> Vec<Column> {
    let shared = &runs[0].rows;
    let axes = || ["x", "y", "z"].into_iter().enumerate();
    // Stamps on the grid, not with the last digits of their rounding.
    let mut columns = vec![column("t_s".into(), shared, |row| (row.time * 1e9).round() / 1e9)];
    columns.extend(
        axes().map(|(axis, name)| column(format!("tip_{name}_set_m"), shared, |row| row.demanded_tip[axis])),
    );
    for (controller, run) in CONTROLLERS.into_iter().zip(runs) {
        columns.extend(axes().map(|(axis, name)| {
            column(format!("tip_{name}_{controller}_m"), &run.rows, |row| row.tip[axis])
        }));
    }
    columns
}

/// What a joint was asked and did; joints count from 1.
fn joint_columns(runs: &[RobotRun], joint: usize) -> Vec<Column> {
    type Of = fn(&JointRow) -> f64;
    const COLUMNS: [(&str, &str, Of); 4] = [
        ("theta", "rad", |joint| joint.output),
        ("torsion", "rad", |joint| joint.torsion),
        ("tau_load", "nm", |joint| joint.load),
        ("tau_motor", "nm", |joint| joint.motor_torque),
    ];
    let number = joint + 1;
    let asked = column(format!("theta_{number}_set_rad"), &runs[0].rows, |row| row.joints[joint].demanded);
    let of_runs = CONTROLLERS.into_iter().zip(runs).flat_map(|(controller, run)| {
        COLUMNS.map(|(name, unit, of)| {
            column(format!("{name}_{number}_{controller}_{unit}"), &run.rows, |row| of(&row.joints[joint]))
        })
    });
    std::iter::once(asked).chain(of_runs).collect()
}

fn column(name: String, rows: &[RobotRow], of: impl Fn(&RobotRow) -> f64) -> Column {
    (name, rows.iter().map(of).collect())
}
