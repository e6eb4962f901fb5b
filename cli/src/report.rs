//! `report`: one HTML page with the paper's figures and ours.

use std::path::PathBuf;

use clap::Args;
use strainwave_desktop::io::file;
use strainwave_desktop::{BadInput, GearFile, report};

use crate::figures::{Figures, FiguresArguments, say};
use crate::files;
use crate::progress::Progress;

/// Write one self-contained HTML page: the paper's figures and ours, drawn from a gear
///
/// Every figure and table of the paper has its place: ours, the paper's caption and what its text says, and what differs.
/// The flexspline is drawn in three dimensions (WebGL), coloured by strain, over the motion of a scenario. The
/// flexspline's chapter has eq. (1) and its curve, the assembled mesh, torque over torsion of both builds against
/// the catalogue's line, strain at a gauge over a revolution, the mesh sizes, and the figures of `verify flexspline` beside
/// their bounds. The friction's has every model with the numbers of the gear's input side: steady friction over speed,
/// force over displacement in presliding, and stick-slip. Then S1 to S7 with every baseline, and an identification from the example
/// logs. All of it is computed now. The page needs no other file and no network; it prints, and follows a dark screen.
#[derive(Args)]
pub struct Arguments {
    /// Gear file; the default gear hd25-100 when left out
    #[arg(long, value_name = "G.toml")]
    gear: Option<PathBuf>,
    /// The page; written complete or not at all, its folder made when missing
    #[arg(long, value_name = "FILE", default_value = "out/report.html")]
    output: PathBuf,
    /// Also write each picture as a file of its own into this folder (SVG)
    #[arg(long, value_name = "DIR")]
    pictures: Option<PathBuf>,
    #[command(flatten)]
    figures: FiguresArguments,
}

/// Measures, draws and writes.
pub fn run(arguments: &Arguments) -> Result<Figures, BadInput> {
    let (output, json) = (arguments.output.as_path(), arguments.figures.json.as_deref());
    files::require_distinct(&[
        ("--gear", arguments.gear.as_deref()),
        ("--output", Some(output)),
        ("--json", json),
    ])?;
    let gear = arguments.gear.as_deref().map_or_else(|| Ok(GearFile::default_gear()), GearFile::read)?;
    files::require_writable(json)?;
    files::require_page(output)?;
    if let Some(pictures) = &arguments.pictures {
        files::require_folder(pictures)?;
    }
    let mut progress = Progress::new(1000, "measuring and drawing");
    let report = report::build(&gear, |fraction| progress.set((fraction * 1e3) as u64))?;
    drop(progress);
    files::write_page(output, &report.html)?;
    if let Some(pictures) = &arguments.pictures {
        files::make_folder(pictures)?;
        for picture in &report.pictures {
            let path = pictures.join(format!("{}.svg", picture.name));
            file::write(&path, |out| Ok(out.write_all(picture.svg.as_bytes())?))?;
        }
    }
    for note in &report.measured.notes {
        say(format_args!("{note}"));
    }
    say(format_args!("report: {}", output.display()));
    Ok(Figures::new(report.measured.figures, &arguments.figures))
}
