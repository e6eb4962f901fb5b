//! `check`: everything that is wrong with a gear file.

use std::path::{Path, PathBuf};

use clap::Args;
use strainwave_desktop::design::buildable::use_of;
use strainwave_desktop::{BadInput, GearFile};

use crate::figures::{Figures, FiguresArguments, complain, say};
use crate::files;

/// Tell everything that is wrong with a gear file, a line each with key, value and range
///
/// Unknown keys with the nearest known one, missing keys, types, ranges, conditions between keys, and whether the firmware's
/// compensator can be built. Conditions between keys are checked where those keys are right by themselves. Exit code 0
/// and one line when nothing is wrong, else 2.
#[derive(Args)]
pub struct Arguments {
    /// Gear file
    #[arg(value_name = "GEAR.toml")]
    gear: PathBuf,
    #[command(flatten)]
    figures: FiguresArguments,
}

/// Reads and checks.
pub fn run(arguments: &Arguments) -> Result<Figures, BadInput> {
    let json = arguments.figures.json.as_deref();
    files::require_distinct(&[("GEAR.toml", Some(&arguments.gear)), ("--json", json)])?;
    files::require_writable(json)?;
    let gear = faultless(&arguments.gear)?;
    say(format_args!("{}: ok{}", arguments.gear.display(), limit(&gear, &arguments.gear)?));
    Ok(Figures::silent(Vec::new(), &arguments.figures))
}

/// A gear file with nothing wrong in it; of another all faults are told.
pub fn faultless(path: &Path) -> Result<GearFile, BadInput> {
    GearFile::faultless(path).map_err(all_but_last)
}

/// Tells all faults but the last one, which ends the command.
fn all_but_last(mut faults: Vec<BadInput>) -> BadInput {
    let last = faults.pop().expect("a refusal has a reason");
    faults.iter().for_each(|fault| complain(format_args!("error: {fault}")));
    last
}

/// What limits the use of a file that is right.
fn limit(gear: &GearFile, path: &Path) -> Result<String, BadInput> {
    let limit = use_of(gear).map_err(|why| BadInput::new(path, why))?;
    Ok(limit.map_or_else(String::new, |why| format!(", for simulation only: {why}")))
}
