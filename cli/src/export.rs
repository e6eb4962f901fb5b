//! `export`: the built compensator of a joint as constants for firmware.

use std::path::{Path, PathBuf};

use clap::Args;
use strainwave::compensator::words::WORDS;
use strainwave_desktop::design::buildable::buildable;
use strainwave_desktop::design::export::Export;
use strainwave_desktop::io::file;
use strainwave_desktop::{BadInput, Figure, GearFile};

use crate::figures::{Figures, FiguresArguments};
use crate::files;

/// Write the compensator of a joint, built, as constants for firmware
///
/// Everything that follows from the gear file is computed here. What is written are words that firmware reads in place,
/// in flash or in RAM: at start-up it only compares their layout with its own, their number and their CRC-32
/// (`Compensator::from_words`). Firmware of another version of this library refuses them. The same file gives the same words.
#[derive(Args)]
pub struct Arguments {
    /// Gear file
    #[arg(value_name = "GEAR.toml")]
    gear: PathBuf,
    /// Rust source to write, complete or not at all: what STRAINWAVE_JOINT names when a board is built; - for the standard output
    #[arg(long, value_name = "JOINT.rs", required_unless_present = "c", conflicts_with = "c")]
    rust: Option<PathBuf>,
    /// C header to write, complete or not at all: an array of uint32_t with its layout, size and CRC; - for the standard output
    #[arg(long, value_name = "JOINT.h")]
    c: Option<PathBuf>,
    #[command(flatten)]
    figures: FiguresArguments,
}

/// Builds and writes.
pub fn run(arguments: &Arguments) -> Result<Figures, BadInput> {
    let json = arguments.figures.json.as_deref();
    let (name, output, source) = arguments.format();
    files::require_distinct(&[("GEAR.toml", Some(&arguments.gear)), (name, Some(output)), ("--json", json)])?;
    let (gear, _) = GearFile::read_with_text(&arguments.gear)?;
    buildable(&gear).map_err(|why| BadInput::new(&arguments.gear, why))?;
    files::require_writable(json)?;
    let text = source(&Export::of(&gear).map_err(BadInput::message)?);
    file::write(output, |out| Ok(out.write_all(text.as_bytes())?))?;
    Ok(Figures::beside(output, vec![size()], &arguments.figures))
}

impl Arguments {
    /// Name of the argument, the file, and how its text is made.
    fn format(&self) -> (&'static str, &Path, fn(&Export) -> String) {
        match (&self.rust, &self.c) {
            (Some(rust), _) => ("--rust", rust, Export::rust),
            (None, c) => ("--c", c.as_ref().expect("one of the two is required"), Export::c),
        }
    }
}

/// What the words take in flash, and as much again in RAM where they are copied there.
fn size() -> Figure {
    Figure::reported("export.size", 4.0 * WORDS as f64, "byte")
}
