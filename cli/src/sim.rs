//! `sim`: a gear or a belt gear as a two-port, open loop; or an arm link.

mod belt;
mod link;
mod sensors;

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use clap::{ArgGroup, Args, ValueEnum};
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave_desktop::io::file;
use strainwave_desktop::io::log::{
    OpenLoop, OpenLoopRow, Time, write_open_loop, write_open_loop_with_forces,
};
use strainwave_desktop::plant::measured::{MotorMotion, Truth, motion};
use strainwave_desktop::plant::mesh_size::MeshSize;
use strainwave_desktop::plant::two_port::{self, Build, Gauge, Measured};
use strainwave_desktop::{BadInput, Figure, GearFile};

use crate::figures::{Figures, FiguresArguments};
use crate::files;
use crate::progress::Progress;
use sensors::Sensors;

/// Run a gear, a belt gear or an arm link, open loop: motion of the motor side and load in, output and torques out
///
/// With --gear, IN.csv has the columns t_s, theta_wg_rad or omega_wg_rad_s, and tau_load_nm, the external torque ON
/// the flexspline. OUT.csv gets a row every 0.1 ms: t_s, theta_fs_rad, omega_fs_rad_s, tau_wg_nm,
/// torsion_rad, tau_t_nm, and a strain for each --gauge. FORCES.csv of --forces has a row for each node of the flexspline's ends: t_s, end
/// (rim or flange), node, radial_n, tangential_n, axial_n. SI units. Prints the intervals of the input's time stamps
/// and the largest magnitudes of the output. Either build runs with any friction model that the gear file names. A reference run whose mesh diverges (a link strained by more than 10 %)
/// ends with the time and the node, exit code 2, and writes nothing.
///
/// With --belt, IN.csv has the columns t_s, theta_motor_rad or omega_motor_rad_s, and tau_load_nm, the external torque ON the output.
/// OUT.csv gets a row every 0.1 ms: t_s, theta_out_rad, omega_out_rad_s, tau_motor_nm, torsion_rad, tau_t_nm, f_forward_n and
/// f_backward_n, the tensions of the span that the motor pulls when it turns forwards and of the other.
///
/// With --link, IN.csv has the columns t_s, theta_joint_rad, and where it has them tip_force_n and voltage_v; OUT.csv gets t_s,
/// tip_deflection_m, tip_x_m, tip_y_m, tau_joint_nm, strain_at_PLACE_m of each gauge of the file, and with a patch voltage_v, couple_nm,
/// charge_c.
///
/// With --sensors, each sensor of the file that the model has a place for adds the column of its readings: motor_encoder_rad, output_encoder_rad,
/// torque_sensor_nm, motor_current_a of a gear or a belt gear; output_encoder_rad and torque_sensor_nm at the joint, accelerometer_m_per_s2 at the tip
/// and gauge_bridge_v of a link. Their errors against ideal sensors are printed, rms.
#[derive(Args)]
#[command(group(ArgGroup::new("model").required(true).args(["gear", "belt", "link"])))]
pub struct Arguments {
    /// Gear file
    #[arg(long, value_name = "G.toml")]
    gear: Option<PathBuf>,
    /// Belt file, in the place of a gear file
    #[arg(long, value_name = "BELT.toml", conflicts_with_all = ["mesh", "step", "gauges", "forces"])]
    belt: Option<PathBuf>,
    /// File of an arm link, in the place of a gear file
    #[arg(long, value_name = "LINK.toml", conflicts_with_all = ["build", "mesh", "step", "gauges", "forces"])]
    link: Option<PathBuf>,
    /// Input over time; - for the standard input
    #[arg(long, value_name = "IN.csv")]
    input: PathBuf,
    /// Output over time, complete or not at all; - for the standard output
    #[arg(long, value_name = "OUT.csv")]
    output: PathBuf,
    /// Which build of the models
    #[arg(long, value_enum, default_value_t = Models::Reference)]
    build: Models,
    /// Nodes of the reference build's mesh, around x along the axis; 36x4 when left out
    ///
    /// One of 8x3, 12x3, 16x4, 24x4, 36x4, 36x6, 48x6, 72x8. With 5 slices or more a node in the middle has all 16 links.
    #[arg(long, value_name = "NxM", allow_hyphen_values = true)]
    mesh: Option<MeshSize>,
    /// Longest micro-step of the reference build (s); 0.95 of the mesh's stable step when left out
    ///
    /// Below the stable step, from 1e-9 s; it is rounded down to divide 0.1 ms.
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    step: Option<f64>,
    /// Add the strain of a link as the column strain_I_J_AROUND_ALONG; may be given several times
    ///
    /// From node I of n around, J of m along the axis (0 is the rim), to the one that is AROUND and ALONG further:
    /// 1,0 0,1 1,1 -1,1 2,0 0,2 2,2 -2,2, either way. The mesh is that of --mesh, 8x3 in the real-time build.
    /// Strain L/L0 - 1, without unit, positive when longer than in the round, unloaded cup.
    #[arg(long = "gauge", value_name = "I,J,AROUND,ALONG", allow_hyphen_values = true)]
    gauges: Vec<Gauge>,
    /// File of sensors, whose readings are added as columns
    #[arg(long, value_name = "SENSORS.toml")]
    sensors: Option<PathBuf>,
    /// Write the forces that hold the nodes of rim and flange, of the reference build
    ///
    /// Forces ON the flexspline in each node's own frame (N): outward, counter-clockwise, towards the flange. Node 0 is at the
    /// flexspline's zero angle.
    #[arg(long, value_name = "FORCES.csv")]
    forces: Option<PathBuf>,
    /// Time from one instant with forces to the next (s), a multiple of 1e-4; 1e-3 when left out
    #[arg(long, value_name = "SECONDS", requires = "forces", allow_hyphen_values = true)]
    forces_every: Option<f64>,
    #[command(flatten)]
    figures: FiguresArguments,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Models {
    /// f64, mesh of eq. (6) or spans of 16 masses, micro-steps
    Reference,
    /// f32, condensed 8x3 mesh or massless spans, one step per 0.1 ms: of a gear the code of the joint controller, where the observer
    /// steps it by 0.2 ms
    Realtime,
}

/// Shortest allowed micro-step (s).
const SHORTEST_STEP: f64 = 1e-9;

/// Reads, runs and writes.
pub fn run(arguments: &Arguments) -> Result<Figures, BadInput> {
    files::require_distinct(&[
        ("--gear", arguments.gear.as_deref()),
        ("--belt", arguments.belt.as_deref()),
        ("--link", arguments.link.as_deref()),
        ("--sensors", arguments.sensors.as_deref()),
        ("--input", Some(&arguments.input)),
        ("--output", Some(&arguments.output)),
        ("--forces", arguments.forces.as_deref()),
        ("--json", arguments.figures.json.as_deref()),
    ])?;
    match (&arguments.gear, &arguments.belt, &arguments.link) {
        (Some(path), ..) => run_gear(arguments, path),
        (None, Some(path), _) => belt::run(arguments, path),
        (None, None, Some(path)) => link::run(arguments, path),
        (None, None, None) => unreachable!("the arguments have one of the three"),
    }
}

/// Refuses results that could not be written at the end.
fn require_writable(arguments: &Arguments) -> Result<(), BadInput> {
    files::require_writable(Some(&arguments.output))?;
    files::require_writable(arguments.forces.as_deref())?;
    files::require_writable(arguments.figures.json.as_deref())
}

fn run_gear(arguments: &Arguments, path: &Path) -> Result<Figures, BadInput> {
    let gear = GearFile::read(path)?;
    let build = build(arguments, &gear, path)?;
    require_gauges(&arguments.gauges, build)?;
    let file = sensors::file(arguments)?;
    let measured = Measured { gauges: &arguments.gauges, forces_every: forces_every(arguments, build)? };
    let input = OpenLoop::read(&arguments.input)?;
    let motor = MotorMotion::of(&input);
    let truth = |row: &OpenLoopRow| Truth {
        motor: Some(motor.at(row.time)),
        output: Some(motion(row.output_position, row.output_velocity)),
        torque: Some(row.transmitted_torque),
        motor_torque: Some(row.input_torque),
        ..Truth::default()
    };
    let mut sensors = Sensors::build(arguments, file.as_ref(), &truth(&OpenLoopRow::default()))?;
    require_writable(arguments)?;
    let rows =
        two_port::run_measured(&gear, &input, build, measured).map_err(|error| BadInput::new(path, error))?;
    let mut progress = Progress::new(rows.len() as u64, "simulating");
    let (mut largest, names) = (Largest::default(), sensors.columns());
    let watched = rows.enumerate().map(|(done, row)| {
        progress.set(done as u64);
        row.map(|row| {
            largest.add(&row);
            let readings = sensors.step(&truth(&row));
            (row, readings)
        })
    });
    let columns: Vec<_> = arguments.gauges.iter().map(Gauge::column).chain(names).collect();
    match &arguments.forces {
        Some(forces) => write_open_loop_with_forces(&arguments.output, forces, &columns, watched)?,
        None => write_open_loop(&arguments.output, &columns, watched)?,
    }
    Ok(answer(arguments, &input.time, largest.figures().into_iter().chain(sensors.figures())))
}

/// The intervals of the input, then what the run measured.
fn answer(arguments: &Arguments, time: &Time, measured: impl IntoIterator<Item = Figure>) -> Figures {
    let intervals = time.jitter().into_iter().flat_map(|jitter| jitter.figures());
    let figures = intervals.chain(measured).collect();
    Figures::beside(&arguments.output, figures, &arguments.figures)
}

/// The build that the arguments name.
fn build(arguments: &Arguments, gear: &GearFile, path: &Path) -> Result<Build, BadInput> {
    if arguments.build == Models::Reference {
        let mesh = arguments.mesh.unwrap_or(MeshSize::DEFAULT);
        arguments.step.map_or(Ok(()), |step| require_step(step, mesh, gear, path))?;
        return Ok(Build::Reference { mesh, longest_step: arguments.step });
    }
    let mesh = arguments.mesh.map(|mesh| format!("--mesh {mesh}"));
    let step = arguments.step.map(|step| format!("--step {step:e}"));
    match mesh.or(step) {
        None => Ok(Build::RealTime),
        Some(given) => Err(BadInput::message(format_args!(
            "{given} is for --build reference; the real-time build has one condensed mesh and one step per 0.1 ms"
        ))),
    }
}

fn require_step(step: f64, mesh: MeshSize, gear: &GearFile, path: &Path) -> Result<(), BadInput> {
    let bound = two_port::stable_step(gear, mesh);
    if (SHORTEST_STEP..bound).contains(&step) {
        return Ok(());
    }
    let gear = path.display();
    Err(BadInput::message(format_args!(
        "--step {step:e} is out of range; allowed: from {SHORTEST_STEP:e} s to below {bound:.3e} s, the stable step \
         of the {mesh} mesh of {gear}"
    )))
}

/// Time from one instant with forces to the next when it is left out, and the longest (s).
const FORCES_EVERY: [f64; 2] = [1e-3, 1e3];

/// Rows from one with forces to the next; `None` without `--forces`.
fn forces_every(arguments: &Arguments, build: Build) -> Result<Option<NonZeroUsize>, BadInput> {
    let Some(path) = &arguments.forces else {
        return Ok(None);
    };
    if build == Build::RealTime {
        return Err(BadInput::message("--forces is for --build reference; the condensed mesh has no nodes"));
    }
    if file::is_stream(path) {
        return Err(BadInput::message(
            "--forces - is out of range; allowed: a file, the output's is the only stream",
        ));
    }
    let every = arguments.forces_every.unwrap_or(FORCES_EVERY[0]);
    let periods = (every / CONTROL_PERIOD).round();
    let whole = (periods * CONTROL_PERIOD - every).abs() <= 1e-9 * every;
    let rows = if whole && every <= FORCES_EVERY[1] { NonZeroUsize::new(periods as usize) } else { None };
    rows.map(Some).ok_or_else(|| {
        BadInput::message(format_args!(
            "--forces-every {every:e} is out of range; allowed: a multiple of {CONTROL_PERIOD:e} s up to {:e} s",
            FORCES_EVERY[1]
        ))
    })
}

fn require_gauges(gauges: &[Gauge], build: Build) -> Result<(), BadInput> {
    for (index, gauge) in gauges.iter().enumerate() {
        let refuse = |why: String| BadInput::message(format_args!("--gauge {gauge}: {why}"));
        gauge.require_on(build.nodes()).map_err(refuse)?;
        if gauges[..index].contains(gauge) {
            return Err(refuse("stands there twice".into()));
        }
    }
    Ok(())
}

/// Rows and largest magnitudes of a run.
#[derive(Default)]
struct Largest {
    rows: u32,
    torsion: f64,
    transmitted: f64,
    wave_generator: f64,
}

impl Largest {
    fn add(&mut self, row: &OpenLoopRow) {
        self.rows += 1;
        self.torsion = self.torsion.max(row.torsion.abs());
        self.transmitted = self.transmitted.max(row.transmitted_torque.abs());
        self.wave_generator = self.wave_generator.max(row.input_torque.abs());
    }

    fn figures(&self) -> [Figure; 4] {
        [
            Figure::reported("sim.rows", f64::from(self.rows), "1"),
            Figure::reported("sim.torsion.max", self.torsion, "rad"),
            Figure::reported("sim.transmitted_torque.max", self.transmitted, "N m"),
            Figure::reported("sim.wave_generator_torque.max", self.wave_generator, "N m"),
        ]
    }
}
