//! An operator as a TOML file.
//!
//! ```toml
//! [operator]
//! input_low = -1.0                 # range of the input u
//! input_high = 1.0
//! offset = 0.25                    # c, in the unit of the output y
//! slope = 0.5                      # k, unit of y over unit of u
//! weights = [[0.1], [0.3, 0.2]]    # mu_ij, in the unit of y: row i has the numbers j = 0 to i
//! ```
//!
//! The rows of the weights are the levels. Relay (i, j) switches up between i/L and (i + 1)/L of the range and down between j/L
//! and (j + 1)/L, evenly; +-mu_ij is its output.

use std::fmt::Write as _;
use std::path::Path;

use serde::Deserialize;

use super::grid::Grid;
use super::model::{LARGEST, LEVELS, Operator};
use crate::io::file::{self, BadInput};
use crate::io::keyed_file::line_of;

/// Longest file (bytes).
const LONGEST_FILE: u64 = 1 << 20;
/// What stands at the top of a file.
const HEADER: &str = "\
# Preisach operator: y = offset + slope*(u - (input_low + input_high)/2) + sum over i, j of weights[i][j]*x_ij
# x_ij is the mean state, -1 to 1, of the relays that switch up between i/L and (i + 1)/L of the range of the input and
# down between j/L and (j + 1)/L; row i of the weights has j = 0 to i, and L rows are L levels. Units: those of u and y.
";

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    operator: Numbers,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Numbers {
    input_low: f64,
    input_high: f64,
    offset: f64,
    slope: f64,
    weights: Vec<Vec<f64>>,
}

impl Operator {
    /// Reads and checks `path`.
    ///
    /// # Errors
    /// One line that names the file, the line or the key, and what is allowed.
    pub fn read(path: &Path) -> Result<Self, BadInput> {
        Self::parse(path, &file::read(path, LONGEST_FILE)?)
    }

    /// The file in `bytes`; `path` is only named in errors.
    ///
    /// # Errors
    /// As [`Operator::read`].
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Self, BadInput> {
        let refuse = |why: String| BadInput::new(path, why);
        let text = std::str::from_utf8(bytes).map_err(|_| refuse("not TOML: not UTF-8 text".into()))?;
        let document: Document = toml::from_str(text).map_err(|error| refuse(faulty(text, &error)))?;
        let numbers = document.operator;
        numbers.check().map_err(refuse)?;
        let grid = Grid { low: numbers.input_low, high: numbers.input_high, levels: numbers.weights.len() };
        Self::build(grid, numbers.offset, numbers.slope, numbers.weights.concat())
            .map_err(|why| BadInput::new(path, why))
    }

    /// The same as text that [`Operator::parse`] reads back.
    pub fn to_toml(&self) -> String {
        let grid = self.grid();
        let mut text = format!(
            "{HEADER}\n[operator]\ninput_low = {:?}\ninput_high = {:?}\noffset = {:?}\nslope = {:?}\nweights = [\n",
            grid.low,
            grid.high,
            self.offset(),
            self.slope()
        );
        let mut rest = self.weights();
        for level in 0..grid.levels {
            let (row, others) = rest.split_at(level + 1);
            rest = others;
            // A string takes whatever is written to it.
            let _ = writeln!(text, "    {row:?},");
        }
        text + "]\n"
    }

    /// Writes `path`, complete or not at all.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), BadInput> {
        file::write(path, |out| Ok(out.write_all(self.to_toml().as_bytes())?))
    }
}

impl Numbers {
    fn check(&self) -> Result<(), String> {
        let keys = [
            ("input_low", self.input_low),
            ("input_high", self.input_high),
            ("offset", self.offset),
            ("slope", self.slope),
        ];
        for (key, value) in keys {
            check(&format!("operator.{key}"), value)?;
        }
        if self.input_low >= self.input_high {
            let Self { input_low, input_high, .. } = self;
            return Err(format!(
                "operator.input_high = {input_high}; allowed: more than input_low, {input_low}"
            ));
        }
        if !LEVELS.contains(&self.weights.len()) {
            let (least, most) = (LEVELS.start(), LEVELS.end());
            return Err(format!(
                "operator.weights has {} rows; allowed: {least} to {most}",
                self.weights.len()
            ));
        }
        for (level, row) in self.weights.iter().enumerate() {
            if row.len() != level + 1 {
                let (numbers, expected) = (row.len(), level + 1);
                return Err(format!("operator.weights[{level}] has {numbers} numbers; allowed: {expected}"));
            }
            for (column, weight) in row.iter().enumerate() {
                check(&format!("operator.weights[{level}][{column}]"), *weight)?;
            }
        }
        Ok(())
    }
}

fn check(key: &str, value: f64) -> Result<(), String> {
    let holds = value.abs() <= LARGEST;
    if holds {
        Ok(())
    } else {
        Err(format!("{key} = {value}; allowed: a number from -{LARGEST:e} to {LARGEST:e}"))
    }
}

/// What is no operator's file, with its line.
fn faulty(text: &str, error: &toml::de::Error) -> String {
    format!("line {}: {}", line_of(text, error), error.message().replace('\n', "; "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Operator, String> {
        Operator::parse("op.toml".as_ref(), text.as_bytes()).map_err(|why| why.to_string())
    }

    #[test]
    fn a_written_operator_is_read_back_to_the_last_bit() {
        let grid = Grid { low: -0.1, high: 1.0 / 3.0, levels: 5 };
        let weights = grid.cells().map(|(i, j)| (i as f64 - 0.7 * j as f64).sin() * 1e-9).collect();
        let operator = Operator::build(grid, 1e20, -0.3, weights).unwrap();
        assert_eq!(parse(&operator.to_toml()).unwrap(), operator);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let file = |weights: &str| {
            format!(
                "[operator]\ninput_low = 0\ninput_high = 1.0\noffset = 0.0\nslope = 0.0\nweights = {weights}\n"
            )
        };
        assert!(parse(&file("[[1.0], [1, 2.0]]")).is_ok());
        let refused = |text: &str| parse(text).unwrap_err();
        let of_weights = |weights: &str| refused(&file(weights));
        assert_eq!(of_weights("[[1.0]]"), "op.toml: operator.weights has 1 rows; allowed: 2 to 64");
        assert_eq!(of_weights("[[1.0], [1.0]]"), "op.toml: operator.weights[1] has 1 numbers; allowed: 2");
        assert!(
            of_weights("[[1.0], [1.0, nan]]").starts_with("op.toml: operator.weights[1][1] = NaN; allowed")
        );
        assert!(of_weights("[[1.0], [1.0, \"2\"]]").starts_with("op.toml: line 6: "));
        let swapped = file("[[1.0], [1.0, 2.0]]").replace("input_low = 0", "input_low = 2");
        assert_eq!(refused(&swapped), "op.toml: operator.input_high = 1; allowed: more than input_low, 2");
        assert!(refused("[operator]\nlow = 1\n").contains("unknown field `low`"));
        assert!(refused("[operator]\ninput_low = 1\n").contains("missing field `input_high`"));
    }
}
