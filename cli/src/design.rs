//! `design`: gains, poles and margins of a joint.

use std::path::PathBuf;

use clap::Args;
use strainwave_desktop::bench::SensorSet;
use strainwave_desktop::design::Levels;
use strainwave_desktop::design::report::Report;
use strainwave_desktop::design::sweep::{Measured, sweep};
use strainwave_desktop::{BadInput, GearFile};

use crate::figures::{Figures, FiguresArguments, columns, say};
use crate::files;

/// Where |L| is measured (Hz).
const FREQUENCIES: [u32; 8] = [5, 10, 20, 40, 60, 80, 120, 200];

/// Print the gains that follow from a gear file, and the margins of each loop over the box that its joint may lie in
///
/// Linear analysis at the motor's torque command and at the disturbance path, with the motor's encoder alone and with
/// both; the worst corner of each margin is named. What cannot be given margins is named with the level that has them.
#[derive(Args)]
pub struct Arguments {
    /// The gear file
    #[arg(value_name = "GEAR.toml")]
    gear: PathBuf,
    /// Draw the open loops of the nominal joint into this file
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
    /// Judge the joint without output feedback and without the disturbance path's fast part
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
    files::require_writable(arguments.figures.json.as_deref())?;
    files::require_writable(arguments.plot.as_deref())?;
    let gear = GearFile::read(&arguments.gear)?;
    gear.require_firmware_friction().map_err(BadInput::message)?;
    let report = match arguments.bare {
        true => Report::at(&gear, 1, Levels::NONE),
        false => Report::of(&gear, 1),
    };
    let report = report.map_err(BadInput::message)?;
    let table = |header: [&str; 4], rows: Vec<[String; 4]>| {
        let all: Vec<Vec<String>> =
            std::iter::once(header.map(String::from)).chain(rows).map(|row| row.to_vec()).collect();
        say(format_args!("{}\n", columns(&all)));
    };
    table(["gain", "value", "unit", "rule"], report.gains());
    table(["loop", "margin", "value", "worst corner"], report.margins());
    say(format_args!("poles of the nominal joint (frequency/damping ratio):"));
    for line in report.poles() {
        say(format_args!("  {line}"));
    }
    say(format_args!(
        "\nstability: {} corners by their poles, {} unstable",
        report.looked_at,
        report.unstable.len()
    ));
    let [off, on] = report.unstable_by_path;
    say(format_args!("  disturbance path off: {off}, on: {on}"));
    for name in report.unstable.iter().take(5) {
        say(format_args!("  unstable: {name}"));
    }
    for line in report.switched() {
        say(format_args!("{line}"));
    }
    say(format_args!(""));
    if arguments.sweep {
        for set in SensorSet::ALL {
            for point in sweep(&gear, set, &FREQUENCIES).map_err(BadInput::message)? {
                let Measured { frequency, measured, linear } = point;
                let name = set.name();
                say(format_args!(
                    "{name} {frequency:.0} Hz: |L| measured {measured:.3} dB, linear {linear:.3} dB"
                ));
            }
        }
    }
    if let Some(path) = &arguments.plot {
        report.page().write(path)?;
    }
    Ok(Figures::new(report.figures(), &arguments.figures))
}
