//! `faults`: what the joint does when something breaks.

use std::path::{Path, PathBuf};

use clap::{Args, value_parser};
use strainwave_desktop::io::gear_file::shipped;
use strainwave_desktop::verify::faults::{self, COUNT};
use strainwave_desktop::{BadInput, GearFile};

use crate::figures::{Figures, FiguresArguments, say};
use crate::files;
use crate::progress::Progress;

/// Inject faults into runs of S1 to S5, and tell what is noticed and what happens
///
/// Each fault is drawn from its number: what breaks, when, with which sensors, on which plant of which of the shipped gears. Prints every
/// unsafe one, a line for each kind of fault, and the figures with their bounds. With --count 1 it prints that fault's outcome.
#[derive(Args)]
pub struct Arguments {
    /// Number of faults
    #[arg(long, value_name = "COUNT", default_value_t = COUNT, value_parser = value_parser!(u64).range(1..=1_000_000))]
    count: u64,
    /// Number of the first
    #[arg(long, value_name = "NUMBER", default_value_t = 0, value_parser = value_parser!(u64).range(0..=1_000_000_000))]
    first: u64,
    /// Gear file; the shipped gears, one after the other, when left out
    #[arg(long, value_name = "G.toml")]
    gear: Option<PathBuf>,
    #[command(flatten)]
    figures: FiguresArguments,
}

/// Injects and prints.
pub fn run(arguments: &Arguments) -> Result<Figures, BadInput> {
    files::require_distinct(&[
        ("--gear", arguments.gear.as_deref()),
        ("--json", arguments.figures.json.as_deref()),
    ])?;
    inject(arguments.gear.as_deref(), arguments.first, arguments.count, &arguments.figures)
}

/// The same for `verify faults`.
pub fn inject(
    gear: Option<&Path>,
    first: u64,
    count: u64,
    arguments: &FiguresArguments,
) -> Result<Figures, BadInput> {
    let parse = |(name, text): (String, &str)| GearFile::parse(name.as_ref(), text.as_bytes());
    let gears = match gear {
        Some(gear) => vec![GearFile::read(gear)?],
        None => shipped().map(parse).collect::<Result<_, _>>()?,
    };
    files::require_writable(arguments.json.as_deref())?;
    let mut progress = Progress::new(1000, "injected faults");
    let report = faults::measure(&gears, first, count, |fraction| progress.set((fraction * 1e3) as u64));
    drop(progress);
    let report = report.map_err(BadInput::message)?;
    for outcome in report.outcomes.iter().filter(|outcome| count == 1 || outcome.is_unsafe()) {
        say(format_args!("{}", outcome.describe()));
    }
    say(format_args!("{}", report.table()));
    let measured = report.measured();
    for note in &measured.notes {
        say(format_args!("false alarm: {note}"));
    }
    Ok(Figures::new(measured.figures, arguments))
}
