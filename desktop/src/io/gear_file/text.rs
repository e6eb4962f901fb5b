//! Text of a gear file: read and checked, written, edited in place.

use std::path::Path;

use serde::Deserialize as _;
use toml::Table;
use toml::de::DeTable;
use toml_edit::{DocumentMut, TomlError};

use super::{Baselines, DEFAULT, GearFile, KEYS, Key, Learnt, aliases, check, physics};
use crate::io::file::{self, BadInput};

/// Longest file of this kind (bytes).
pub(crate) const LONGEST_FILE: u64 = 1 << 20;

impl GearFile {
    /// Reads and checks `path`.
    ///
    /// # Errors
    /// One line that names the file, the key, its value and what is allowed.
    pub fn read(path: &Path) -> Result<Self, BadInput> {
        Self::read_with_text(path).map(|(gear, _)| gear)
    }

    /// The same with the text that it was read from.
    ///
    /// # Errors
    /// As [`GearFile::read`].
    pub fn read_with_text(path: &Path) -> Result<(Self, String), BadInput> {
        let bytes = file::read(path, LONGEST_FILE)?;
        Ok((Self::parse(path, &bytes)?, String::from_utf8_lossy(&bytes).into_owned()))
    }

    /// The gear file in `bytes`; `path` is only named in errors.
    ///
    /// # Errors
    /// As [`GearFile::read`].
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Self, BadInput> {
        checked(bytes).map_err(|faults| {
            let file = path.display();
            let first = faults.first().map_or("", String::as_str);
            match faults.len() {
                1 => BadInput::new(path, first),
                count => BadInput::new(
                    path,
                    format_args!("{first}; and {} more: strainwave check {file}", count - 1),
                ),
            }
        })
    }

    /// Reads and checks `path`, and tells everything that is wrong with it. Conditions between keys are checked where their
    /// sections are right otherwise.
    ///
    /// # Errors
    /// An error for each fault, as [`GearFile::read`] has it for the first.
    pub fn faultless(path: &Path) -> Result<Self, Vec<BadInput>> {
        let bytes = file::read(path, LONGEST_FILE).map_err(|error| vec![error])?;
        checked(&bytes).map_err(|faults| faults.iter().map(|why| BadInput::new(path, why)).collect())
    }

    /// The file could be written and read again.
    ///
    /// # Errors
    /// One line that names the key, its value and what is allowed.
    pub fn check(&self) -> Result<(), BadInput> {
        Self::parse(Path::new(&self.gear.name), self.to_toml().as_bytes()).map(|_| ())
    }

    /// The default gear `hd25-100`.
    pub fn default_gear() -> Self {
        Self::parse(Path::new("hd25-100.toml"), DEFAULT.as_bytes()).expect("the default gear file is tested")
    }

    /// The same as text that [`GearFile::parse`] reads back.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).expect("every field has a TOML form")
    }

    /// Writes `path`, complete or not at all, after checking that it could be read again.
    ///
    /// # Errors
    /// A value is out of range, or the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), BadInput> {
        let text = self.to_toml();
        Self::parse(path, text.as_bytes())?;
        file::write(path, |out| Ok(out.write_all(text.as_bytes())?))
    }
}

impl Baselines {
    /// Writes the gear file of this `text` with these sections to `path`, complete or not at all. All else of it,
    /// comments and other baselines too, stays as it is.
    ///
    /// # Errors
    /// A gain is out of the file's range, `text` is no gear file, or the file cannot be written.
    pub fn keep_in(&self, text: &str, path: &Path) -> Result<(), BadInput> {
        keep(path, text, |document| self.put_into(document))
    }
}

impl Learnt {
    /// Writes the gear file of this `text` with this as its `[learnt]` to `path`, complete or not at all. All else of it,
    /// comments too, stays as it is.
    ///
    /// # Errors
    /// When a learnt value is out of the file's range, `text` is no gear file, or the file cannot be written.
    pub fn keep_in(&self, text: &str, path: &Path) -> Result<(), BadInput> {
        keep(path, text, |document| self.put_into(document))
    }
}

/// Writes the gear file of this `text`, as `put` changes it, to `path`, complete or not at all. All else of it, comments
/// too, stays as it is.
///
/// # Errors
/// `text` is no gear file, before or after the change, or the file cannot be written.
fn keep(path: &Path, text: &str, put: impl FnOnce(&mut DocumentMut)) -> Result<(), BadInput> {
    let kept = edited(text, put).map_err(|error| BadInput::new(path, error.message()))?;
    GearFile::parse(path, kept.as_bytes())?;
    file::write(path, |out| Ok(out.write_all(kept.as_bytes())?))
}

pub(super) fn edited(text: &str, put: impl FnOnce(&mut DocumentMut)) -> Result<String, TomlError> {
    let mut document = text.parse()?;
    put(&mut document);
    Ok(document.to_string())
}

/// The table in the `bytes` of a file of other `keys`, or everything that is wrong with them, a line each.
pub(crate) fn checked_table(bytes: &[u8], keys: &'static [Key]) -> Result<Table, Vec<String>> {
    let table = table(bytes)?;
    let faults = check::of_keys(&table, keys);
    if faults.is_empty() { Ok(table) } else { Err(faults.into_iter().map(|fault| fault.line).collect()) }
}

/// The gear file in `bytes`, or everything that is wrong with it, a line each.
fn checked(bytes: &[u8]) -> Result<GearFile, Vec<String>> {
    let mut table = table(bytes)?;
    aliases::rename(&mut table);
    let faults = check::faults(&table);
    let damaged: Vec<_> = faults.iter().map(check::Fault::section).collect();
    let gear = GearFile::deserialize(mended(table, &damaged)).map_err(|error| error.message().to_owned());
    let conditions =
        gear.as_ref().map_or_else(|why| vec![why.clone()], |gear| physics::faults(gear, &damaged));
    let faults: Vec<_> = faults.into_iter().map(|fault| fault.line).chain(conditions).collect();
    gear.ok().filter(|_| faults.is_empty()).ok_or(faults)
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

/// The file with the default gear's section in the place of each that is damaged, so that the others can be read.
fn mended(file: Table, damaged: &[&str]) -> Table {
    if damaged.is_empty() {
        return file;
    }
    let mut whole: Table = DEFAULT.parse().expect("the default gear file is tested");
    let sound = |section: &str| check::is_table(section, KEYS) && !damaged.contains(&section);
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
