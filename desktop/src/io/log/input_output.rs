//! Logs of any actuator: `u`, its input, and `y`, its output, each in any unit.
//!
//! A column `t_s` may be there; it has to run forwards, and counts for nothing else: hysteresis does not depend on the rate.

use std::path::Path;

use super::LONGEST_FILE;
use super::columns::{Column, Columns, Extra, Schema};
use super::time::{TIME, require_forwards};
use crate::io::file::{self, BadInput};

/// Largest magnitude: the square of a sum of as many as a file can hold is still a number.
const LIMIT: f64 = 1e30;
const INPUT: Column = Column { name: "u", limit: LIMIT, other_names: &["input", "in"] };
const OUTPUT: Column = Column { name: "y", limit: LIMIT, other_names: &["output", "out"] };
const SCHEMA: Schema = Schema { one_of: &[&[INPUT], &[OUTPUT]], optional: &[TIME], may_ignore: true };
/// Least rows.
const LEAST_ROWS: usize = 20;

/// Input and output of any actuator, row by row, as many of each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InputOutput {
    /// u, in its unit.
    pub input: Vec<f64>,
    /// y, in its unit.
    pub output: Vec<f64>,
}

impl InputOutput {
    /// Reads and checks `path`; the names of the columns that were ignored beside it.
    ///
    /// # Errors
    /// One line that names the file, the row and the column.
    pub fn read(path: &Path, extra: Extra) -> Result<(Self, Vec<String>), BadInput> {
        Self::parse(path, &file::read(path, LONGEST_FILE)?, extra)
    }

    /// The file in `bytes`; `path` is only named in errors.
    ///
    /// # Errors
    /// As [`InputOutput::read`].
    pub fn parse(path: &Path, bytes: &[u8], extra: Extra) -> Result<(Self, Vec<String>), BadInput> {
        let mut columns = Columns::parse(path, bytes, SCHEMA, extra)?;
        let log = Self { input: columns.require(INPUT), output: columns.require(OUTPUT) };
        let rows = log.input.len();
        if rows < LEAST_ROWS {
            let why = format_args!("{rows} rows after the header; allowed: at least {LEAST_ROWS}");
            return Err(BadInput::new(path, why));
        }
        require_forwards(&columns.take(TIME).unwrap_or_default()).map_err(|why| BadInput::new(path, why))?;
        Ok((log, columns.ignored()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str, extra: Extra) -> Result<(InputOutput, Vec<String>), String> {
        InputOutput::parse("a.csv".as_ref(), text.as_bytes(), extra).map_err(|why| why.to_string())
    }

    /// A header and 30 rows, one of them another.
    fn with_row(header: &str, row: usize, text: &str) -> String {
        let rows = (0..30).map(|k| if k + 2 == row { text.into() } else { format!("{k},1,2\n") });
        format!("{header}\n{}", rows.collect::<String>())
    }

    #[test]
    fn columns_stand_in_any_order_with_or_without_time() {
        let (log, ignored) = parse(&with_row("t_s,y,u", 0, ""), Extra::Refused).unwrap();
        assert_eq!((log.input[29], log.output[29], ignored.len()), (2.0, 1.0, 0));
        let (log, ignored) = parse(&with_row("y,u,volt", 0, ""), Extra::Ignored).unwrap();
        assert_eq!((log.input[29], log.output[29], ignored), (1.0, 29.0, vec!["volt".to_owned()]));
    }

    #[test]
    fn what_is_wrong_is_named_with_file_row_and_column() {
        let refused = |text: &str| parse(text, Extra::Refused).unwrap_err();
        let starts = |text: &str, start: &str| assert!(refused(text).starts_with(start), "{}", refused(text));
        starts("", "a.csv: empty file");
        starts("t_s,u\n0,1\n", "a.csv: row 1, column y: missing");
        starts("u,y,volt\n0,1,2\n", "a.csv: row 1, column \"volt\": unknown; known columns are u, y, t_s");
        starts("u,y\n0,1\n", "a.csv: 1 rows after the header; allowed: at least 20");
        let row = |text: &str| refused(&with_row("t_s,u,y", 5, text));
        assert!(row("3,one,2\n").starts_with("a.csv: row 5, column u: \"one\" is not a number"));
        assert!(row("3,1,NaN\n").starts_with("a.csv: row 5, column y: \"NaN\" is out of range"));
        assert!(row("3,1\n").starts_with("a.csv: row 5, column y: no value (a gap)"));
        assert!(
            row("2,1,1\n").starts_with("a.csv: row 5, column t_s: time 2 does not come after 2, the row")
        );
    }
}
