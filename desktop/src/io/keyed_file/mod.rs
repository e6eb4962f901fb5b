//! TOML files that a table of keys describes: an unknown or missing key, a wrong type and a value out of range are refused by one line
//! that names the file, the key, the value and what is allowed.

pub(crate) mod check;
pub mod key;

use std::path::Path;

use serde::de::DeserializeOwned;
use toml::Table;
use toml::de::DeTable;

use crate::io::file::{self, BadInput};
use key::{Schema, section_of};

/// Longest file (bytes).
pub(crate) const LONGEST_FILE: u64 = 1 << 20;

/// A kind of file that a table of keys describes.
pub(crate) trait KeyedFile: DeserializeOwned {
    /// What it may hold.
    const SCHEMA: Schema;
    /// A sound file, whose sections take the place of damaged ones while the others are checked.
    const DEFAULT: &'static str;

    /// Gives keys with a former name their name.
    fn rename(_: &mut Table) {}

    /// Conditions on several keys at once that do not hold, of those that read none of the `damaged` sections, a line each.
    fn conditions(&self, damaged: &[&str]) -> Vec<String>;
}

/// Which kind of file is at a path, right or wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// A gear file, and whatever is none of the others.
    Gear,
    /// A belt file: it has a table `[belt]` and none `[gear]`.
    Belt,
    /// A link file: it has a table `[link]`.
    Link,
    /// A robot file: it has a table `[robot]`.
    Robot,
    /// A sensor file: it has a table `[sensor_set]`.
    Sensor,
}

impl FileKind {
    /// That of the file at `path`.
    pub fn at(path: &Path) -> Self {
        let table = file::read(path, LONGEST_FILE).ok().and_then(|bytes| table(&bytes).ok());
        let has = |name: &str| table.as_ref().is_some_and(|table| table.contains_key(name));
        let kinds = [
            ("gear", Self::Gear),
            ("belt", Self::Belt),
            ("link", Self::Link),
            ("robot", Self::Robot),
            ("sensor_set", Self::Sensor),
        ];
        kinds.into_iter().find(|(name, _)| has(name)).map_or(Self::Gear, |(_, kind)| kind)
    }
}

/// The file in `bytes`; `path` is only named in errors.
///
/// # Errors
/// One line that names the file, the key, its value and what is allowed, and how many more there are.
pub(crate) fn parse<F: KeyedFile>(path: &Path, bytes: &[u8]) -> Result<F, BadInput> {
    checked(bytes).map_err(|faults| {
        let file = path.display();
        let first = faults.first().map_or("", String::as_str);
        match faults.len() {
            1 => BadInput::new(path, first),
            count => {
                BadInput::new(path, format_args!("{first}; and {} more: strainwave check {file}", count - 1))
            }
        }
    })
}

/// Reads and checks `path`, and tells everything that is wrong with it. Conditions between keys are checked where their sections are
/// right otherwise.
///
/// # Errors
/// An error for each fault, as [`parse`] has it for the first.
pub(crate) fn faultless<F: KeyedFile>(path: &Path) -> Result<F, Vec<BadInput>> {
    let bytes = file::read(path, LONGEST_FILE).map_err(|error| vec![error])?;
    checked(&bytes).map_err(|faults| faults.iter().map(|why| BadInput::new(path, why)).collect())
}

/// The file in `bytes`, or everything that is wrong with it, a line each.
fn checked<F: KeyedFile>(bytes: &[u8]) -> Result<F, Vec<String>> {
    let mut table = table(bytes)?;
    F::rename(&mut table);
    let faults = check::faults(&table, &F::SCHEMA);
    let damaged: Vec<_> = faults.iter().map(check::Fault::section).collect();
    let file = F::deserialize(mended::<F>(table, &damaged)).map_err(|error| error.message().to_owned());
    let conditions = file.as_ref().map_or_else(|why| vec![why.clone()], |file| file.conditions(&damaged));
    let faults: Vec<_> = faults.into_iter().map(|fault| fault.line).chain(conditions).collect();
    file.ok().filter(|_| faults.is_empty()).ok_or(faults)
}

/// The table that TOML text describes, or every reason why it is not TOML.
fn table(bytes: &[u8]) -> Result<Table, Vec<String>> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        vec![format!("line {}: not TOML: not UTF-8 text", line_at(bytes, error.valid_up_to()))]
    })?;
    text.parse().map_err(|_| {
        let (_, mut errors) = DeTable::parse_recoverable(text);
        errors.sort_by_key(|error| error.span().map_or(0, |span| span.start));
        // One slip may be several errors of a line.
        errors.dedup_by_key(|error| line_of(text, error));
        errors.iter().map(|error| not_toml(text, error)).collect()
    })
}

/// The file with the default's section in the place of each that is damaged, so that the others can be read.
fn mended<F: KeyedFile>(file: Table, damaged: &[&str]) -> Table {
    if damaged.is_empty() {
        return file;
    }
    let mut whole: Table = F::DEFAULT.parse().expect("the default file is tested");
    let sound = |section: &str| {
        F::SCHEMA.keys.iter().any(|key| section_of(key.path) == section) && !damaged.contains(&section)
    };
    whole.extend(file.into_iter().filter(|(section, _)| sound(section)));
    whole
}

fn not_toml(text: &str, error: &toml::de::Error) -> String {
    format!("line {}: not TOML: {}", line_of(text, error), error.message().replace('\n', "; "))
}

/// Line of TOML text that an error is about, from 1.
pub(crate) fn line_of(text: &str, error: &toml::de::Error) -> usize {
    line_at(text.as_bytes(), error.span().map_or(0, |span| span.start))
}

/// Line of the byte at `offset`, from 1.
fn line_at(bytes: &[u8], offset: usize) -> usize {
    1 + bytes.iter().take(offset).filter(|byte| **byte == b'\n').count()
}
