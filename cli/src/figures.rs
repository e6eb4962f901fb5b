//! The figures that a subcommand answers with, as a table and as JSON.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use comfy_table::{CellAlignment, Table, presets};
use serde::Serialize;
use strainwave_desktop::io::file;
use strainwave_desktop::{BadInput, Figure};

/// Options of every subcommand.
#[derive(Args)]
pub struct FiguresArguments {
    /// Also write the figures to this file, as {"figures": [{"name", "value", "unit", "bound", "holds"}, ...]}
    ///
    /// A bound is the largest allowed value; with "at_least": true it is the smallest. The worst of many samples of the
    /// plant has its "seed".
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// The figures of a subcommand.
#[derive(Serialize)]
pub struct Figures {
    figures: Vec<Figure>,
    #[serde(skip)]
    json: Option<PathBuf>,
    #[serde(skip)]
    table: Stream,
}

/// Where the table of figures goes.
enum Stream {
    Output,
    /// The standard output has a result.
    Error,
    /// The subcommand has printed a table of its own.
    None,
}

impl Figures {
    /// Figures to be published as `arguments` ask.
    pub fn new(figures: Vec<Figure>, arguments: &FiguresArguments) -> Self {
        Self { figures, json: arguments.json.clone(), table: Stream::Output }
    }

    /// The same beside a result that goes to the file `output`.
    pub fn beside(output: &Path, figures: Vec<Figure>, arguments: &FiguresArguments) -> Self {
        let table = if file::is_stream(output) { Stream::Error } else { Stream::Output };
        Self { table, ..Self::new(figures, arguments) }
    }

    /// The same of a subcommand that prints its figures itself.
    pub fn silent(figures: Vec<Figure>, arguments: &FiguresArguments) -> Self {
        Self { table: Stream::None, ..Self::new(figures, arguments) }
    }

    /// Measured figures.
    pub fn measured(&self) -> &[Figure] {
        &self.figures
    }

    /// Writes the JSON file, prints the table, and tells whether every figure holds.
    pub fn publish(self) -> Result<bool, BadInput> {
        if let Some(path) = &self.json {
            self.write_json(path)?;
        }
        match self.table {
            Stream::Output => say(format_args!("{}", table(&self.figures))),
            Stream::Error => complain(format_args!("{}", table(&self.figures))),
            Stream::None => {}
        }
        Ok(self.figures.iter().all(|figure| figure.holds))
    }

    fn write_json(&self, path: &Path) -> Result<(), BadInput> {
        file::write(path, |out| {
            serde_json::to_writer_pretty(&mut *out, self).map_err(io::Error::from)?;
            Ok(writeln!(out)?)
        })
    }
}

/// A line for people; a reader that has seen enough and closed the pipe changes nothing.
pub fn say(line: std::fmt::Arguments<'_>) {
    let _ = writeln!(io::stdout(), "{line}");
}

/// A line for people beside a result that goes to this file: to the error stream when that is standard output.
pub fn tell(output: &Path, line: std::fmt::Arguments<'_>) {
    if file::is_stream(output) { complain(line) } else { say(line) }
}

/// A line about what went wrong; without an error stream there is nobody to tell.
pub fn complain(line: std::fmt::Arguments<'_>) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// Rows of cells for people, the header first; all but the first column to the right.
pub fn columns(rows: &[Vec<String>]) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING);
    if let [header, rows @ ..] = rows {
        table.set_header(header).add_rows(rows);
    }
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    trimmed(&table)
}

fn trimmed(table: &Table) -> String {
    table.lines().map(|line| line.trim().to_owned()).collect::<Vec<_>>().join("\n")
}

/// One row a figure.
pub fn table(figures: &[Figure]) -> String {
    let mut table = Table::new();
    let header = Figure::HEADER.map(String::from).to_vec();
    table.load_style(presets::NOTHING);
    if figures.iter().any(|figure| figure.seed.is_some()) {
        let seed = |figure: &Figure| figure.seed.map_or_else(|| "-".into(), |seed| seed.to_string());
        table.set_header([header, vec!["worst seed".into()]].concat());
        table.add_rows(figures.iter().map(|figure| [figure.cells().to_vec(), vec![seed(figure)]].concat()));
    } else {
        table.set_header(header).add_rows(figures.iter().map(Figure::cells));
    }
    for column in [1, 3] {
        if let Some(column) = table.column_mut(column) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    trimmed(&table)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_missed_bound_is_enough() {
        let published =
            |figures| Figures::silent(figures, &FiguresArguments { json: None }).publish().unwrap();
        let (kept, missed) = (Figure::bounded("a", 1.0, "1", 1.0), Figure::bounded("b", 1.1, "1", 1.0));
        let not_measured = Figure::bounded("c", f64::NAN, "1", 1.0);
        assert!(published(vec![kept.clone(), Figure::reported("d", 9.0, "1")]));
        assert!(!published(vec![kept.clone(), missed]));
        assert!(!published(vec![not_measured, kept.clone()]));
        let floor = |value| Figure::at_least("e", value, "1", 300.0);
        assert!(published(vec![floor(300.0)]));
        assert!(!published(vec![kept.clone(), floor(299.0)]));
        assert!(!published(vec![kept, floor(f64::NAN)]));
    }

    /// The smallest allowed value is marked as such; the others keep the keys that they have always had.
    #[test]
    fn a_floor_is_told_from_a_ceiling_in_json() {
        let keys = |figure: Figure| {
            let json = serde_json::to_value(figure).unwrap();
            let keys = json.as_object().unwrap().keys().cloned();
            (keys.collect::<Vec<_>>().join(" "), json["at_least"].as_bool())
        };
        assert_eq!(keys(Figure::bounded("a", 1.0, "1", 2.0)), ("bound holds name unit value".into(), None));
        assert_eq!(
            keys(Figure::at_least("a", 1.0, "1", 2.0)),
            ("at_least bound holds name unit value".into(), Some(true))
        );
    }

    #[test]
    fn the_table_lines_up() {
        let figures = [
            Figure::bounded("a.long.name", 0.5, "rad", 0.25),
            Figure::reported("b", 12.0, "1"),
            Figure::bounded("c.d", 1.0, "s", 2.0),
            Figure::at_least("e", 1.0, "1", 2.0),
        ];
        let expected = "\
 name         value  unit  bound   holds
 a.long.name  0.5000 rad   0.2500  NO
 b                12 1          -  -
 c.d               1 s          2  yes
 e                 1 1       >= 2  NO";
        assert_eq!(
            table(&figures).split_whitespace().collect::<Vec<_>>(),
            expected.split_whitespace().collect::<Vec<_>>()
        );
    }
}
