//! A checked CSV table: the columns that a file may have, and every cell a finite number.
//!
//! Rows are counted as an editor counts lines, the header being row 1. Refused, with row and column
//! named: an empty file, an unknown, doubled or missing column, an empty cell, a missing or surplus
//! cell, an empty line between rows, text, NaN, infinities, and what is outside a column's range.

use std::path::Path;

use csv::{ByteRecord, ReaderBuilder, Trim};

use crate::io::file::BadInput;

/// A column that a file may have.
#[derive(Clone, Copy, Debug)]
pub(super) struct Column {
    /// Name in the header, with the unit.
    pub name: &'static str,
    /// Largest magnitude.
    pub limit: f64,
}

/// The columns of one kind of file; any order.
#[derive(Clone, Copy, Debug)]
pub(super) struct Schema {
    /// Exactly one column of each group must be there.
    pub one_of: &'static [&'static [Column]],
    /// These may be there.
    pub optional: &'static [Column],
}

impl Schema {
    fn columns(self) -> impl Iterator<Item = Column> {
        self.one_of.iter().flat_map(|group| group.iter()).chain(self.optional).copied()
    }

    fn known_names(self) -> String {
        self.columns().map(|column| column.name).collect::<Vec<_>>().join(", ")
    }
}

/// The numbers of a file, by column, each a value in every row.
#[derive(Debug)]
pub(super) struct Columns {
    columns: Vec<(Column, Vec<f64>)>,
    /// Rows after the header, at least one.
    rows: usize,
}

/// Row in the file of a sample, from 0.
pub(super) fn row_of(sample: usize) -> usize {
    sample + 2
}

impl Columns {
    /// The numbers of a column that the schema requires.
    pub fn require(&mut self, column: Column) -> Vec<f64> {
        self.take(column).expect("the header was checked")
    }

    /// The numbers of a column that may be there.
    pub fn take(&mut self, column: Column) -> Option<Vec<f64>> {
        let found = self.columns.iter_mut().find(|(present, _)| present.name == column.name);
        found.map(|(_, numbers)| std::mem::take(numbers))
    }

    /// The table in `bytes`; `path` is only named in errors.
    pub fn parse(path: &Path, bytes: &[u8], schema: Schema) -> Result<Self, BadInput> {
        Self::check(bytes.trim_ascii_end(), schema).map_err(|why| BadInput::new(path, why))
    }

    fn check(bytes: &[u8], schema: Schema) -> Result<Self, String> {
        // The parser skips empty lines without a word, and the row numbers would be off.
        if let Some(line) = bytes.split(|byte| *byte == b'\n').position(|line| line.trim_ascii().is_empty()) {
            return Err(if bytes.is_empty() {
                "empty file".into()
            } else {
                format!("row {}: empty (a gap)", line + 1)
            });
        }
        // Ragged rows are let through, to be refused here by column.
        let mut reader =
            ReaderBuilder::new().flexible(true).has_headers(false).trim(Trim::All).from_reader(bytes);
        let mut records = reader.byte_records();
        let header = records.next().ok_or("empty file")?.map_err(|error| error.to_string())?;
        let header = check_header(&header, schema).map_err(|why| format!("row 1, {why}"))?;
        let columns = header.into_iter().map(|column| (column, Vec::new())).collect();
        let mut table = Self { columns, rows: 0 };
        for record in records {
            let row = row_of(table.rows);
            let record = record.map_err(|error| format!("row {row}: {error}"))?;
            table.add(&record).map_err(|why| format!("row {row}, {why}"))?;
        }
        if table.rows == 0 { Err("no rows after the header".into()) } else { Ok(table) }
    }

    fn add(&mut self, record: &ByteRecord) -> Result<(), String> {
        if let Some(surplus) = record.get(self.columns.len()) {
            return Err(format!(
                "column {}: {} has no name in the header",
                self.columns.len() + 1,
                shown(surplus)
            ));
        }
        for (index, (column, numbers)) in self.columns.iter_mut().enumerate() {
            let number =
                number(record.get(index), *column).map_err(|why| format!("column {}: {why}", column.name))?;
            numbers.push(number);
        }
        self.rows += 1;
        Ok(())
    }
}

/// The columns in the file's order.
fn check_header(header: &ByteRecord, schema: Schema) -> Result<Vec<Column>, String> {
    let mut present: Vec<Column> = Vec::new();
    for name in header {
        let known = schema.columns().find(|column| column.name.as_bytes() == name);
        let column = known.ok_or_else(|| {
            format!("column {}: unknown; known columns are {}", shown(name), schema.known_names())
        })?;
        if present.iter().any(|other| other.name == column.name) {
            return Err(format!("column {}: stands there twice", column.name));
        }
        present.push(column);
    }
    for group in schema.one_of {
        check_group(group, &present)?;
    }
    Ok(present)
}

fn check_group(group: &[Column], present: &[Column]) -> Result<(), String> {
    let names: Vec<_> = group.iter().map(|column| column.name).collect();
    let found: Vec<_> = names.iter().filter(|name| present.iter().any(|c| c.name == **name)).collect();
    match found.as_slice() {
        [] => Err(format!("column {}: missing", names.join(" or "))),
        [_] => Ok(()),
        [_, second, ..] => Err(format!("column {second}: only one of {} is allowed", names.join(" and "))),
    }
}

fn number(cell: Option<&[u8]>, column: Column) -> Result<f64, String> {
    let cell = cell.filter(|cell| !cell.is_empty()).ok_or("no value (a gap)")?;
    let number: f64 = std::str::from_utf8(cell)
        .ok()
        .and_then(|text| text.parse().ok())
        .ok_or_else(|| format!("{} is not a number", shown(cell)))?;
    if number.abs() <= column.limit {
        Ok(number)
    } else {
        let limit = column.limit;
        Err(format!("{} is out of range; allowed: a number from -{limit:e} to {limit:e}", shown(cell)))
    }
}

/// A cell as a message shows it: quoted, shortened, without control characters.
fn shown(cell: &[u8]) -> String {
    const LONGEST: usize = 40;
    let text = String::from_utf8_lossy(cell);
    let mut short: String = text.chars().take(LONGEST).collect();
    if short.len() < text.len() {
        short.push_str("...");
    }
    format!("{short:?}")
}
