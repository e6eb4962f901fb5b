//! `sim --link`: an arm link, open loop.

use std::convert::Infallible;
use std::f64::consts::TAU;
use std::path::Path;

use strainwave_desktop::io::log::{LinkInputLog, write_rows};
use strainwave_desktop::plant::link::{self, LinkRow, LinkRun};
use strainwave_desktop::{BadInput, Figure, LinkFile};

use crate::figures::{Figures, FiguresArguments, tell};
use crate::files;
use crate::progress::Progress;

/// Reads, runs and writes.
pub fn run(
    path: &Path,
    input: &Path,
    output: &Path,
    arguments: &FiguresArguments,
) -> Result<Figures, BadInput> {
    let json = arguments.json.as_deref();
    files::require_distinct(&[
        ("--link", Some(path)),
        ("--input", Some(input)),
        ("--output", Some(output)),
        ("--json", json),
    ])?;
    let file = LinkFile::read(path)?;
    let log = LinkInputLog::read(input, file.piezo.is_some())?;
    files::require_writable(Some(output))?;
    files::require_writable(json)?;
    if let Some(warning) = file.warning() {
        tell(output, format_args!("warning: {}: {warning}", path.display()));
    }
    let LinkRun { frequencies, rows } = link::run(&file, &log).map_err(|error| BadInput::new(path, error))?;
    let mut progress = Progress::new(rows.len() as u64, "simulating");
    let mut largest = Largest::default();
    let watched = rows.enumerate().map(|(done, row)| {
        progress.set(done as u64);
        largest.add(&row);
        Ok::<_, Infallible>(row.numbers())
    });
    let columns = link::columns(&file);
    write_rows(output, &columns.iter().map(String::as_str).collect::<Vec<_>>(), watched)?;
    let intervals = log.time.jitter().into_iter().flat_map(|jitter| jitter.figures());
    let modes = (1..)
        .zip(frequencies)
        .map(|(mode, omega)| Figure::reported(format!("sim.link.mode_{mode}.frequency"), omega / TAU, "Hz"));
    let figures = intervals.chain(modes).chain(largest.figures()).collect();
    Ok(Figures::beside(output, figures, arguments))
}

/// Rows and largest magnitudes of a run.
#[derive(Default)]
struct Largest {
    rows: u32,
    deflection: f64,
    torque: f64,
    strain: Option<f64>,
    charge: Option<f64>,
}

impl Largest {
    fn add(&mut self, row: &LinkRow) {
        self.rows += 1;
        self.deflection = self.deflection.max(row.deflection.abs());
        self.torque = self.torque.max(row.torque.abs());
        let larger = |most: Option<f64>, value: f64| Some(most.unwrap_or(0.0).max(value.abs()));
        self.strain = row.strains.iter().fold(self.strain, |most, strain| larger(most, *strain));
        self.charge = row.patch.iter().fold(self.charge, |most, patch| larger(most, patch.charge));
    }

    fn figures(&self) -> Vec<Figure> {
        let always = [
            ("rows", Some(f64::from(self.rows)), "1"),
            ("tip_deflection.max", Some(self.deflection), "m"),
            ("joint_torque.max", Some(self.torque), "N m"),
            ("strain.max", self.strain, "1"),
            ("charge.max", self.charge, "C"),
        ];
        let named = always.into_iter().filter_map(|(name, value, unit)| {
            Some(Figure::reported(format!("sim.link.{name}"), value?, unit))
        });
        named.collect()
    }
}
