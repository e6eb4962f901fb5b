//! Blocks along the histories that cost most, which no scenario brings about.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;

use super::{Block, Error, Measurement};
use crate::artifact::Image;
use crate::counting::worst_path::worst_case_path;

/// A program that drives blocks through the histories that cost most.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WorstCase {
    /// The board's program; it ends by itself, well only when what it drives is right.
    pub program: String,
    /// Blocks that it drives, by name.
    pub blocks: BTreeMap<String, Block>,
}

impl WorstCase {
    /// The blocks, by name.
    pub(super) fn rows(&self) -> impl Iterator<Item = (&str, &Block)> {
        self.blocks.iter().map(|(name, block)| (name.as_str(), block))
    }

    /// Runs the program at `elf` and adds what its blocks cost to the others.
    ///
    /// # Errors
    /// As [`Measurement::add_program`].
    pub fn measure(&self, elf: &Path, measured: &mut Measurement) -> Result<(), Error> {
        measured.add_program(elf, &self.rows().collect::<Vec<_>>())
    }

    /// Most cycles that any path through the code of a block takes, whether or not a history leads along it;
    /// `None` where the code shows no bound.
    ///
    /// # Errors
    /// [`Error::Image`].
    pub fn worst_case(&self, elf: &Path, block: &str) -> Result<Option<u64>, Error> {
        let Some(block) = self.blocks.get(block) else { return Ok(None) };
        block.worst_case(&Image::read(elf)?)
    }
}

impl Block {
    /// Most cycles that any path through its code takes; `None` where the code shows no bound.
    ///
    /// # Errors
    /// [`Error::Image`].
    pub fn worst_case(&self, image: &Image) -> Result<Option<u64>, Error> {
        let paths = image.find(&self.symbol)?.into_iter().map(|function| worst_case_path(image, function));
        Ok(paths.collect::<Option<Vec<_>>>().and_then(|cycles| cycles.into_iter().max()))
    }
}
