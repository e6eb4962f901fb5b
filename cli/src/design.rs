//! `design`: gains, poles and margins of a joint.

use std::f64::consts::TAU;
use std::path::PathBuf;

use clap::Args;
use strainwave_desktop::bench::SensorSet;
use strainwave_desktop::design::levels::Levels;
use strainwave_desktop::design::parts::Parts;
use strainwave_desktop::design::report::Report;
use strainwave_desktop::design::sweep::{Measured, sweep};
use strainwave_desktop::{BadInput, GearFile};

use crate::figures::{Figures, FiguresArguments, columns, say};
use crate::files;
use crate::progress::Progress;

/// Where |L| is measured (Hz).
const FREQUENCIES: [u32; 8] = [5, 10, 20, 40, 60, 80, 120, 200];

/// Print the gains that follow from a gear file, and the margins of each loop over the box that its joint may lie in
///
/// Linear analysis at the motor's torque command and at the disturbance path, with the motor's encoder alone and with
/// both. Each margin stands beside its bound and the corner of the box where it is worst; below them the closed loop's
/// poles and the corners that are not stable. The exit code is 1 when a margin is missed.
#[derive(Args)]
pub struct Arguments {
    /// The gear file
    #[arg(value_name = "GEAR.toml")]
    gear: PathBuf,
    /// Judge the cascade alone, without output feedback and disturbance path
    #[arg(long)]
    bare: bool,
    /// Also measure |L| in the loop of the real code and print it beside the linear one
    #[arg(long)]
    sweep: bool,
    #[command(flatten)]
    figures: FiguresArguments,
}

/// Analyses and judges.
pub fn run(arguments: &Arguments) -> Result<Figures, BadInput> {
    let json = arguments.figures.json.as_deref();
    files::require_distinct(&[("GEAR.toml", Some(&arguments.gear)), ("--json", json)])?;
    let file = GearFile::read(&arguments.gear)?;
    file.require_firmware_friction().map_err(|why| BadInput::new(&arguments.gear, why))?;
    files::require_writable(json)?;
    let parts = Parts::of(&file).map_err(BadInput::message)?;
    let levels = if arguments.bare { Levels::NONE } else { Levels::FULL };
    let mut progress = Progress::new(1000, "margins");
    let report = Report::of(&file, levels.apply(&parts), |share| progress.set((share * 1e3) as u64));
    drop(progress);
    print(&report);
    if arguments.sweep {
        print_sweep(&file)?;
    }
    Ok(Figures::new(report.figures(), &arguments.figures))
}

fn table<const N: usize>(header: [&str; N], rows: Vec<[String; N]>) {
    let rows = std::iter::once(header.map(String::from)).chain(rows);
    say(format_args!("{}\n", columns(&rows.map(|row| row.to_vec()).collect::<Vec<_>>())));
}

fn print(report: &Report) {
    table(["gain", "value", "unit", "rule"], report.gains());
    table(["loop", "margin", "value", "bound", "worst corner"], report.margins());
    say(format_args!("poles of the nominal joint, frequency/damping ratio:"));
    for (set, mode, poles) in &report.poles {
        let poles: Vec<_> =
            poles.iter().map(|(w, damping)| format!("{:.1} Hz/{damping:.2}", w / TAU)).collect();
        say(format_args!("  {} {mode:?}: {}", set.name(), poles.join(", ")));
    }
    for (variant, corner) in &report.unstable {
        let path = if variant.passes { "path_on" } else { "path_off" };
        say(format_args!("unstable: {} {path} {:?} {}", variant.set.name(), variant.mode, corner.name()));
    }
    say(format_args!(""));
}

fn print_sweep(file: &GearFile) -> Result<(), BadInput> {
    let mut rows = Vec::new();
    for set in SensorSet::ALL {
        for Measured { frequency, measured, linear } in
            sweep(file, set, &FREQUENCIES).map_err(BadInput::message)?
        {
            rows.push([
                set.name().into(),
                format!("{frequency:.0}"),
                format!("{measured:.3}"),
                format!("{linear:.3}"),
            ]);
        }
    }
    table(["set", "frequency [Hz]", "|L| measured [dB]", "|L| linear [dB]"], rows);
    Ok(())
}
