//! Numbers as a CSV file, by columns or row by row.

use std::fmt::Display;
use std::path::Path;

use crate::io::file::{self, BadInput, WriteError};

/// Writes columns of one length with their names, complete or not at all.
///
/// # Errors
/// The file cannot be written, or a value is not finite.
pub fn write_columns(path: &Path, columns: &[(String, &[f64])]) -> Result<(), BadInput> {
    file::write(path, |out| {
        let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(out);
        let failed = |error: csv::Error| WriteError::Io(error.into());
        writer.serialize(columns.iter().map(|(name, _)| name).collect::<Vec<_>>()).map_err(failed)?;
        let rows = columns.iter().map(|(_, column)| column.len()).min().unwrap_or(0);
        for row in 0..rows {
            let numbers: Vec<_> = columns.iter().map(|(_, column)| column[row]).collect();
            if let Some(at) = numbers.iter().position(|number| !number.is_finite()) {
                let why =
                    format!("column {} of row {} is not finite", columns[at].0, super::columns::row_of(row));
                return Err(WriteError::Refused(why));
            }
            writer.serialize(numbers).map_err(failed)?;
        }
        Ok(writer.flush()?)
    })
}

/// Writes rows of as many numbers as there are `names`, the time (s) first, complete or not at all; each row is computed when it is
/// written.
///
/// # Errors
/// The file cannot be written, a row has failed, or a value is not finite.
pub fn write_rows<E: Display>(
    path: &Path,
    names: &[&str],
    rows: impl IntoIterator<Item = Result<Vec<f64>, E>>,
) -> Result<(), BadInput> {
    file::write(path, |out| {
        let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(out);
        let failed = |error: csv::Error| WriteError::Io(error.into());
        writer.serialize(names).map_err(failed)?;
        for row in rows {
            let mut row = row.map_err(|error| WriteError::Refused(error.to_string()))?;
            if !row.iter().all(|number| number.is_finite()) {
                return Err(WriteError::Refused(format!("a value at {} s is not finite", row[0])));
            }
            // Stamps on the grid, not with the last digits of their rounding.
            row[0] = (row[0] * 1e9).round() / 1e9;
            writer.serialize(row).map_err(failed)?;
        }
        Ok(writer.flush()?)
    })
}
