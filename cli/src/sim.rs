//! `sim`: the gear as a two-port, open loop.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use strainwave_desktop::log::{OpenLoop, OpenLoopRow, write_open_loop};
use strainwave_desktop::two_port::{self, Build};
use strainwave_desktop::{BadInput, Figure, GearFile};

use crate::files;
use crate::progress::Progress;
use crate::report::{Report, ReportArguments};

/// Run the gear as a two-port, open loop: wave-generator motion and load in, output and torques out
///
/// IN.csv has the columns t_s, theta_wg_rad or omega_wg_rad_s, and tau_load_nm, the external torque ON
/// the flexspline. OUT.csv gets a row every 0.1 ms: t_s, theta_fs_rad, omega_fs_rad_s, tau_wg_nm,
/// torsion_rad, tau_t_nm. SI units. Prints the intervals of the input's time stamps and the largest
/// magnitudes of the output.
#[derive(Args)]
pub struct Arguments {
    /// Gear file
    #[arg(long, value_name = "G.toml")]
    gear: PathBuf,
    /// Input over time
    #[arg(long, value_name = "IN.csv")]
    input: PathBuf,
    /// Output over time; written complete or not at all
    #[arg(long, value_name = "OUT.csv")]
    output: PathBuf,
    /// Which build of the models
    #[arg(long, value_enum, default_value_t = Models::Reference)]
    build: Models,
    #[command(flatten)]
    report: ReportArguments,
}

#[derive(Clone, Copy, ValueEnum)]
enum Models {
    /// f64, 36 x 4 mesh, micro-steps
    Reference,
    /// f32, condensed mesh, one step per 0.1 ms: what runs on the joint controller
    Realtime,
}

/// Reads, runs and writes.
pub fn run(arguments: &Arguments) -> Result<Report, BadInput> {
    let json = arguments.report.json.as_deref();
    files::require_distinct(&[
        ("--gear", Some(&arguments.gear)),
        ("--input", Some(&arguments.input)),
        ("--output", Some(&arguments.output)),
        ("--json", json),
    ])?;
    let gear = GearFile::read(&arguments.gear)?;
    let input = OpenLoop::read(&arguments.input)?;
    files::require_writable(Some(&arguments.output))?;
    files::require_writable(json)?;
    let build = match arguments.build {
        Models::Reference => Build::Reference,
        Models::Realtime => Build::RealTime,
    };
    let rows = two_port::run(&gear, &input, build).map_err(|error| BadInput::new(&arguments.gear, error))?;
    let mut progress = Progress::new(rows.len() as u64, "simulating");
    let mut largest = Largest::default();
    let watched = rows.enumerate().map(|(done, row)| {
        progress.set(done as u64);
        largest.add(&row);
        row
    });
    write_open_loop(&arguments.output, watched)?;
    let intervals = input.time.jitter().into_iter().flat_map(|jitter| jitter.figures());
    Ok(Report::new(intervals.chain(largest.figures()).collect(), &arguments.report))
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
