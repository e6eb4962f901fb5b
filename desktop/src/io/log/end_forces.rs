//! File of the forces on the flexspline's ends: a row for each node of rim and flange, at each instant that has them.
//!
//! `t_s, end, node, radial_n, tangential_n, axial_n`; `end` is `rim` or `flange`, `node` 0..n counter-clockwise from the
//! flexspline's zero angle. Forces ON the shell in the node's own frame ([`strainwave::flexspline::end_forces`]): outward,
//! counter-clockwise, towards the flange.

use std::fmt::Display;
use std::path::Path;

use super::open_loop::{OpenLoopRow, write_open_loop};
use crate::io::file::{self, BadInput, WriteError};

const COLUMNS: [&str; 6] = ["t_s", "end", "node", "radial_n", "tangential_n", "axial_n"];
const ENDS: [&str; 2] = ["rim", "flange"];

/// Writes the open-loop output to `path` as [`write_open_loop`], and beside it the rows' forces to `forces`, both complete or not at
/// all.
///
/// # Errors
/// As [`write_open_loop`], for either file.
pub fn write_open_loop_with_forces<E: Display>(
    path: &Path,
    forces: &Path,
    more: &[String],
    rows: impl IntoIterator<Item = Result<(OpenLoopRow, Vec<f64>), E>>,
) -> Result<(), BadInput> {
    let mut failed = None;
    let written = file::write(forces, |out| {
        let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(out);
        writer.serialize(COLUMNS).map_err(io_error)?;
        let watched = rows.into_iter().map(|row| {
            let (row, readings) = row.map_err(|error| error.to_string())?;
            write_forces(&mut writer, &row)?;
            Ok::<_, String>((row, readings))
        });
        if let Err(error) = write_open_loop(path, more, watched) {
            failed = Some(error);
            return Err(WriteError::Refused("the output is not written".into()));
        }
        Ok(writer.flush()?)
    });
    failed.map_or(written, Err)
}

fn io_error(error: csv::Error) -> WriteError {
    WriteError::Io(error.into())
}

/// The rows of one instant, none where it has no forces.
fn write_forces<W: std::io::Write>(writer: &mut csv::Writer<W>, row: &OpenLoopRow) -> Result<(), String> {
    // As the rows of the output beside it, on the grid.
    let time = (row.time * 1e9).round() / 1e9;
    for (end, nodes) in ENDS.iter().zip(row.forces.iter().flatten()) {
        for (node, force) in nodes.iter().enumerate() {
            if ![force.radial, force.tangential, force.axial].iter().all(|part| part.is_finite()) {
                return Err(format!("a force on node {node} of the {end} at {time} s is not finite"));
            }
            let cells = (time, end, node, force.radial, force.tangential, force.axial);
            writer.serialize(cells).map_err(|error| format!("the forces cannot be written: {error}"))?;
        }
    }
    Ok(())
}
