//! `verify`: every claimed figure, measured here and now.

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use strainwave_desktop::verify::Part;
use strainwave_desktop::{BadInput, Figure};

use crate::files;
use crate::progress::Progress;
use crate::report::{Report, ReportArguments};

/// Measure every accuracy and cost figure that the project claims, beside its bound
#[derive(Args)]
pub struct Arguments {
    /// Only this part; every part when left out
    #[arg(value_name = "PART", value_parser = part_parser())]
    part: Option<Part>,
    #[command(flatten)]
    report: ReportArguments,
}

fn part_parser() -> impl TypedValueParser<Value = Part> {
    let names = PossibleValuesParser::new(Part::ALL.map(Part::name));
    names.try_map(|name| Part::from_name(&name).ok_or("unknown part"))
}

/// Measures the parts asked for.
pub fn run(arguments: &Arguments) -> Result<Report, BadInput> {
    files::require_writable(arguments.report.json.as_deref())?;
    let parts = arguments.part.map_or(Part::ALL.to_vec(), |part| vec![part]);
    let mut progress = Progress::new(parts.len() as u64, "measuring");
    let mut figures: Vec<Figure> = Vec::new();
    for (done, part) in parts.into_iter().enumerate() {
        progress.set(done as u64);
        figures.extend(part.measure());
    }
    Ok(Report::new(figures, &arguments.report))
}
