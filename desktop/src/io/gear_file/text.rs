//! Text of a gear file: read and checked, written, edited in place.

use std::path::Path;

use toml::Table;
use toml_edit::{DocumentMut, TomlError};

use super::{Baselines, DEFAULT, GearFile, Learnt, aliases, keys, physics};
use crate::io::file::{self, BadInput};
use crate::io::keyed_file::key::Schema;
use crate::io::keyed_file::{self, KeyedFile, LONGEST_FILE};

impl KeyedFile for GearFile {
    const SCHEMA: Schema = keys::SCHEMA;
    const DEFAULT: &'static str = DEFAULT;

    fn rename(table: &mut Table) {
        aliases::rename(table);
    }

    fn conditions(&self, damaged: &[&str]) -> Vec<String> {
        physics::faults(self, damaged)
    }
}

impl GearFile {
    /// Reads and checks `path`, where nothing is known of a belt in front of the gear.
    ///
    /// # Errors
    /// One line that names the file, the key, its value and what is allowed, or the section `[belt]`.
    pub fn read(path: &Path) -> Result<Self, BadInput> {
        Self::read_with_belt(path)?.without_belt(path)
    }

    /// Reads and checks `path`; it may have a belt.
    ///
    /// # Errors
    /// One line that names the file, the key, its value and what is allowed.
    pub fn read_with_belt(path: &Path) -> Result<Self, BadInput> {
        Ok(Self::read_with_text(path)?.0)
    }

    /// Reads and checks `path`, with the text that it was read from; it may have a belt.
    ///
    /// # Errors
    /// One line that names the file, the key, its value and what is allowed.
    pub fn read_with_text(path: &Path) -> Result<(Self, String), BadInput> {
        let bytes = file::read(path, LONGEST_FILE)?;
        Ok((Self::parse(path, &bytes)?, String::from_utf8_lossy(&bytes).into_owned()))
    }

    /// The gear file in `bytes`; `path` is only named in errors.
    ///
    /// # Errors
    /// As [`GearFile::read`].
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Self, BadInput> {
        keyed_file::parse(path, bytes)
    }

    /// Reads and checks `path`, and tells everything that is wrong with it. Conditions between keys are checked where their
    /// sections are right otherwise.
    ///
    /// # Errors
    /// An error for each fault, as [`GearFile::read`] has it for the first.
    pub fn faultless(path: &Path) -> Result<Self, Vec<BadInput>> {
        keyed_file::faultless(path)
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
