//! What is kept of the readings while they come: a log of all of them, and curves to be drawn.

use std::path::Path;

use strainwave_desktop::BadInput;
use strainwave_desktop::io::log::write_rows;
use strainwave_desktop::report::recording::{Curve, Recording};
use strainwave_service::tuning::client::Error;

use super::quantities;
use crate::files;

/// Most rows that are drawn: when there are more, every other one of them is left out.
const DRAWN: usize = 20_000;

/// Writes the rows that come, complete or not at all; without a path takes them only.
pub fn log(
    path: Option<&Path>,
    rows: impl Iterator<Item = Result<Vec<f64>, Error>>,
    failed: impl Fn(Error) -> BadInput,
) -> Result<(), BadInput> {
    let mut rows = rows.map(|row| row.map_err(&failed));
    match path {
        None => rows.try_for_each(|row| row.map(drop)),
        Some(path) => {
            let names: Vec<_> = quantities::all().map(quantities::column).collect();
            let names: Vec<_> = names.iter().map(String::as_str).collect();
            write_rows(path, &names, rows)
        }
    }
}

/// Rows that are to be drawn.
#[derive(Default)]
pub struct Curves {
    rows: Vec<Vec<f64>>,
    /// One of so many rows is taken, and how many have come since the last one.
    every: usize,
    passed: usize,
}

impl Curves {
    /// Takes a row, if it is its turn.
    pub fn push(&mut self, row: &[f64]) {
        let every = self.every.max(1);
        self.passed += 1;
        if self.rows.is_empty() || self.passed >= every {
            self.passed = 0;
            self.rows.push(row.to_vec());
        }
        if self.rows.len() > DRAWN {
            let mut place = 0;
            self.rows.retain(|_| {
                place += 1;
                place % 2 == 1
            });
            self.every = 2 * every;
        }
    }

    /// Draws and writes a page of the joint that the lines tell of.
    pub fn write(&self, path: &Path, joint: &str, lines: &[String]) -> Result<(), BadInput> {
        let column = |place: usize| self.rows.iter().map(|row| row[place]).collect::<Vec<_>>();
        let all: Vec<_> = quantities::all().collect();
        let place = |name: &str| all.iter().position(|(other, _)| *other == name);
        let curve = |quantity: quantities::Quantity| Curve {
            name: quantity.name,
            unit: quantity.unit,
            values: place(quantity.name).map(column).unwrap_or_default(),
            deviations: place(&format!("{}_deviation", quantity.name)).map(column),
        };
        let none = vec![0.0; all.len()];
        let curves: Vec<_> = quantities::of(&none).map(curve).collect();
        let recording = Recording { joint, lines, time: &column(0), curves: &curves };
        files::write_page(path, &recording.page())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_thinned_evenly() {
        let mut curves = Curves::default();
        for number in 0..5 * DRAWN {
            curves.push(&[number as f64]);
        }
        assert!((DRAWN / 2..=DRAWN).contains(&curves.rows.len()), "{}", curves.rows.len());
        assert!(curves.rows.windows(2).all(|pair| pair[1][0] - pair[0][0] == curves.every as f64));
    }
}
