//! `sim`: the gear as a two-port, open loop; or an arm link.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use strainwave_desktop::io::log::{OpenLoop, OpenLoopRow, write_open_loop};
use strainwave_desktop::plant::mesh_size::MeshSize;
use strainwave_desktop::plant::two_port::{self, Build, Gauge};
use strainwave_desktop::{BadInput, Figure, GearFile};

use crate::figures::{Figures, FiguresArguments};
use crate::files;
use crate::progress::Progress;
use crate::sim_link;

/// Run the gear as a two-port, open loop: wave-generator motion and load in, output and torques out
///
/// IN.csv has the columns t_s, theta_wg_rad or omega_wg_rad_s, and tau_load_nm, the external torque ON
/// the flexspline. OUT.csv gets a row every 0.1 ms: t_s, theta_fs_rad, omega_fs_rad_s, tau_wg_nm,
/// torsion_rad, tau_t_nm, and a strain for each --gauge. SI units. Prints the intervals of the input's time stamps
/// and the largest magnitudes of the output. Either build runs with any friction model that the gear file names. A reference run whose mesh diverges (a link strained by more than 10 %)
/// ends with the time and the node, exit code 2, and writes nothing.
///
/// With --link in the place of --gear an arm link runs: IN.csv has t_s, theta_joint_rad, and where it has them tip_force_n and voltage_v;
/// OUT.csv gets t_s, tip_deflection_m, tip_x_m, tip_y_m, tau_joint_nm, strain_at_PLACE_m of each gauge of the file, and with a patch
/// voltage_v, couple_nm, charge_c.
#[derive(Args)]
pub struct Arguments {
    /// Gear file
    #[arg(long, value_name = "G.toml", required_unless_present = "link")]
    gear: Option<PathBuf>,
    /// File of an arm link, which runs in the place of a gear
    #[arg(long, value_name = "LINK.toml", conflicts_with_all = ["gear", "build", "mesh", "step", "gauges"])]
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
    /// One of 8x3, 12x3, 16x4, 24x4, 36x4, 48x6, 72x8.
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
    #[command(flatten)]
    figures: FiguresArguments,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Models {
    /// f64, mesh of eq. (6), micro-steps
    Reference,
    /// f32, condensed 8x3 mesh, one step per 0.1 ms: the code of the joint controller, where the observer steps it by 0.2 ms
    Realtime,
}

/// Shortest allowed micro-step (s).
const SHORTEST_STEP: f64 = 1e-9;

/// Reads, runs and writes.
pub fn run(arguments: &Arguments) -> Result<Figures, BadInput> {
    match (&arguments.link, &arguments.gear) {
        (Some(link), _) => sim_link::run(link, &arguments.input, &arguments.output, &arguments.figures),
        (None, Some(gear)) => run_gear(gear, arguments),
        (None, None) => Err(BadInput::message("--gear or --link is needed")),
    }
}

fn run_gear(path: &Path, arguments: &Arguments) -> Result<Figures, BadInput> {
    let json = arguments.figures.json.as_deref();
    files::require_distinct(&[
        ("--gear", Some(path)),
        ("--input", Some(&arguments.input)),
        ("--output", Some(&arguments.output)),
        ("--json", json),
    ])?;
    let gear = GearFile::read(path)?;
    let build = build(path, arguments, &gear)?;
    require_gauges(&arguments.gauges, build)?;
    let input = OpenLoop::read(&arguments.input)?;
    files::require_writable(Some(&arguments.output))?;
    files::require_writable(json)?;
    let rows =
        two_port::run(&gear, &input, build, &arguments.gauges).map_err(|error| BadInput::new(path, error))?;
    let mut progress = Progress::new(rows.len() as u64, "simulating");
    let mut largest = Largest::default();
    let watched = rows.enumerate().map(|(done, row)| {
        progress.set(done as u64);
        row.inspect(|row| largest.add(row))
    });
    let columns: Vec<_> = arguments.gauges.iter().map(Gauge::column).collect();
    write_open_loop(&arguments.output, &columns, watched)?;
    let intervals = input.time.jitter().into_iter().flat_map(|jitter| jitter.figures());
    let figures = intervals.chain(largest.figures()).collect();
    Ok(Figures::beside(&arguments.output, figures, &arguments.figures))
}

/// The build that the arguments name.
fn build(path: &Path, arguments: &Arguments, gear: &GearFile) -> Result<Build, BadInput> {
    if arguments.build == Models::Reference {
        let mesh = arguments.mesh.unwrap_or(MeshSize::DEFAULT);
        arguments.step.map_or(Ok(()), |step| require_step(step, mesh, path, gear))?;
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

fn require_step(step: f64, mesh: MeshSize, path: &Path, gear: &GearFile) -> Result<(), BadInput> {
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
