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
    /// Names that other programs give it, in lower case.
    pub other_names: &'static [&'static str],
}

/// The columns of one kind of file; any order.
#[derive(Clone, Copy, Debug)]
pub(super) struct Schema {
    /// Exactly one column of each group must be there.
    pub one_of: &'static [&'static [Column]],
    /// These may be there.
    pub optional: &'static [Column],
    /// The commands that read it have `--ignore-extra`.
    pub may_ignore: bool,
}

impl Schema {
    fn columns(self) -> impl Iterator<Item = Column> {
        self.one_of.iter().flat_map(|group| group.iter()).chain(self.optional).copied()
    }

    fn known_names(self) -> String {
        self.columns().map(|column| column.name).collect::<Vec<_>>().join(", ")
    }
}

/// Columns that a file has beyond those of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extra {
    /// They are errors.
    Refused,
    /// They are left out.
    Ignored,
}

/// The numbers of a file, by column, each a value in every row.
#[derive(Debug)]
pub(super) struct Columns {
    /// In the file's order; one that is ignored has no numbers.
    columns: Vec<(Named, Vec<f64>)>,
    /// Rows after the header, at least one.
    rows: usize,
}

/// A column of a header.
#[derive(Clone, Debug)]
enum Named {
    Known(Column),
    Ignored(String),
}

impl Named {
    fn is(&self, column: &Column) -> bool {
        matches!(self, Self::Known(known) if known.name == column.name)
    }
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
        let found = self.columns.iter_mut().find(|(present, _)| present.is(&column));
        found.map(|(_, numbers)| std::mem::take(numbers))
    }

    /// Names of the columns that are ignored.
    pub fn ignored(&self) -> Vec<String> {
        let names = self.columns.iter().filter_map(|(column, _)| match column {
            Named::Ignored(name) => Some(name.clone()),
            Named::Known(_) => None,
        });
        names.collect()
    }

    /// The table in `bytes`; `path` is only named in errors.
    pub fn parse(path: &Path, bytes: &[u8], schema: Schema, extra: Extra) -> Result<Self, BadInput> {
        Self::check(bytes.trim_ascii_end(), schema, extra).map_err(|why| BadInput::new(path, why))
    }

    fn check(bytes: &[u8], schema: Schema, extra: Extra) -> Result<Self, String> {
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
        let header = check_header(&header, schema, extra).map_err(|why| format!("row 1, {why}"))?;
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
            let Named::Known(column) = column else { continue };
            let number =
                number(record.get(index), *column).map_err(|why| format!("column {}: {why}", column.name))?;
            numbers.push(number);
        }
        self.rows += 1;
        Ok(())
    }
}

/// The columns in the file's order.
fn check_header(header: &ByteRecord, schema: Schema, extra: Extra) -> Result<Vec<Named>, String> {
    if header.len() == 1 && header.iter().any(|whole| whole.contains(&b';')) {
        return Err("columns are separated by `;`; allowed: commas, and decimal points in numbers".into());
    }
    let mut present: Vec<Named> = Vec::new();
    for name in header {
        let known = schema.columns().find(|column| column.name.as_bytes() == name);
        let column = match known {
            Some(column) if present.iter().any(|other| other.is(&column)) => {
                return Err(format!("column {}: stands there twice", column.name));
            }
            Some(column) => Named::Known(column),
            None if extra == Extra::Ignored => Named::Ignored(String::from_utf8_lossy(name).into_owned()),
            None => return Err(unknown(name, schema)),
        };
        present.push(column);
    }
    for group in schema.one_of {
        check_group(group, &present)?;
    }
    Ok(present)
}

fn unknown(name: &[u8], schema: Schema) -> String {
    let text = String::from_utf8_lossy(name);
    let nearest = meant(&text, schema).or_else(|| nearest(&text, schema));
    let hint = nearest.map(|nearest| format!("; meant is perhaps {nearest}")).unwrap_or_default();
    let ignore = if schema.may_ignore { "; --ignore-extra reads the file without it" } else { "" };
    format!("column {}: unknown; known columns are {}{hint}{ignore}", shown(name), schema.known_names())
}

/// A known column by another program's name.
fn meant(name: &str, schema: Schema) -> Option<&'static str> {
    let lower = name.to_lowercase();
    let column = schema.columns().find(|column| column.other_names.contains(&lower.as_str()));
    column.map(|column| column.name)
}

/// A known column of nearly the same name.
fn nearest(name: &str, schema: Schema) -> Option<&'static str> {
    const ALIKE: f64 = 0.85;
    let likeness = schema.columns().map(|column| (column.name, strsim::jaro_winkler(name, column.name)));
    let (nearest, alike) = likeness.max_by(|a, b| a.1.total_cmp(&b.1))?;
    (alike >= ALIKE).then_some(nearest)
}

fn check_group(group: &[Column], present: &[Named]) -> Result<(), String> {
    let names: Vec<_> = group.iter().map(|column| column.name).collect();
    let found: Vec<_> = group
        .iter()
        .filter(|column| present.iter().any(|c| c.is(column)))
        .map(|column| column.name)
        .collect();
    match found.as_slice() {
        [] => Err(format!("column {}: missing{}", names.join(" or "), ignored_instead(group, present))),
        [_] => Ok(()),
        [_, second, ..] => Err(format!("column {second}: only one of {} is allowed", names.join(" and "))),
    }
}

/// An ignored column that is perhaps the one that is missing.
fn ignored_instead(group: &[Column], present: &[Named]) -> String {
    let is_other_name = |name: &str| group.iter().any(|column| column.other_names.contains(&name));
    let meant = |column: &Named| match column {
        Named::Ignored(name) if is_other_name(&name.to_lowercase()) => {
            Some(format!("; {name:?} is perhaps it"))
        }
        _ => None,
    };
    present.iter().find_map(meant).unwrap_or_default()
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
