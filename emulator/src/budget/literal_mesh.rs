//! The mesh of eq. (6), stepped literally on the target, and the block that is its reduction.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;

use super::{Block, Error, LITERAL_MESH, Measurement};

/// The literal mesh, and how many times its reduction it must at least cost.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LiteralMesh {
    /// The board's program that steps it and ends by itself, well only when the mesh agrees with its reduction.
    pub program: String,
    /// The block of the control step that is its reduction.
    pub reduced: String,
    /// Least ratio of the two, in instructions. A demand, not a measured value: it neither follows the
    /// measurement nor becomes stale.
    pub at_least: u64,
    /// One control period of the mesh.
    pub period: Block,
}

impl LiteralMesh {
    /// Its inconsistency with these blocks, if any.
    pub(super) fn fault(&self, blocks: &BTreeMap<String, Block>) -> Option<String> {
        let missing = !blocks.contains_key(&self.reduced);
        missing
            .then(|| format!("literal_mesh.reduced = \"{}\", allowed: a name among [blocks]", self.reduced))
    }

    /// Runs the program at `elf` and adds what its mesh costs to the other blocks.
    ///
    /// # Errors
    /// As [`Measurement::add_program`].
    pub fn measure(&self, elf: &Path, measured: &mut Measurement) -> Result<(), Error> {
        measured.add_program(elf, &[(LITERAL_MESH, &self.period)])
    }
}
