//! `verify`: every claimed figure, measured here and now.

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use strainwave_desktop::{BadInput, Figure, verify};
use strainwave_emulator::verify as firmware;

use crate::figures::{Figures, FiguresArguments, say};
use crate::files;
use crate::progress::Progress;

/// The part that needs the emulator.
const FIRMWARE: &str = "firmware";

/// Measure every accuracy and cost figure that the project claims, beside its bound
///
/// The part `firmware` boots the image in the emulator and runs S1-S6; it takes some minutes.
#[derive(Args)]
pub struct Arguments {
    /// Only this part; every part when left out
    #[arg(value_name = "PART", value_parser = part_parser())]
    part: Option<String>,
    #[command(flatten)]
    figures: FiguresArguments,
}

fn part_parser() -> impl TypedValueParser<Value = String> {
    let names = verify::Part::ALL.map(verify::Part::name);
    PossibleValuesParser::new(names.into_iter().chain([FIRMWARE])).map(String::from)
}

/// Measures the parts asked for.
pub fn run(arguments: &Arguments) -> Result<Figures, BadInput> {
    files::require_writable(arguments.figures.json.as_deref())?;
    let wanted = |name: &str| arguments.part.as_ref().is_none_or(|part| part == name);
    let mut figures: Vec<Figure> = Vec::new();
    let parts: Vec<_> = verify::Part::ALL.into_iter().filter(|part| wanted(part.name())).collect();
    let mut progress = Progress::new(parts.len() as u64, "measuring");
    for (done, part) in parts.into_iter().enumerate() {
        progress.set(done as u64);
        figures.extend(part.measure());
    }
    drop(progress);
    if wanted(FIRMWARE) {
        figures.extend(measure_firmware()?);
    }
    Ok(Figures::new(figures, &arguments.figures))
}

fn measure_firmware() -> Result<Vec<Figure>, BadInput> {
    let mut progress = Progress::new(1000, "firmware");
    let (figures, skipped) =
        firmware::measure(|share| progress.set((share * 1e3) as u64)).map_err(BadInput::message)?;
    drop(progress);
    if let Some(why) = skipped {
        say(format_args!("{why}"));
    }
    Ok(figures)
}
