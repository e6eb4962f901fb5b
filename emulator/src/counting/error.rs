//! Why nothing was counted.

use crate::{artifact, setup};

/// A count that could not be made, in one line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The image cannot be read.
    #[error(transparent)]
    Image(#[from] artifact::Error),
    /// There is no emulator.
    #[error(transparent)]
    Setup(#[from] setup::Error),
    /// The emulator does not say its version.
    #[error("emulator version: \"{said}\", allowed: ... version MAJOR.MINOR ...")]
    Version {
        /// Its output.
        said: String,
    },
    /// The plugin does not compile.
    #[error("counting plugin does not build: {line}")]
    PluginBuild {
        /// The compiler's first error.
        line: String,
    },
    /// The plan cannot be written.
    #[error("counting plan: {0}")]
    Plan(#[from] std::io::Error),
    /// QEMU wrote no result.
    #[error("the emulator left no counts: it was killed, or did not load the plugin")]
    NoResult,
    /// An instruction without a row in the cycle table.
    #[error("{function} at {address:#x}: `{text}` has no row in the Cortex-M4 cycle table")]
    NoCost {
        /// The function.
        function: String,
        /// Its address.
        address: u32,
        /// The instruction, written out.
        text: String,
    },
    /// Code outside of the image was executed in a tracked function.
    #[error("instruction at {address:#x} was executed but is not in the image, allowed: code of the image")]
    NotInImage {
        /// Its address.
        address: u32,
    },
    /// Calls and returns do not match.
    #[error(
        "{function}: calls and returns do not match ({what}), allowed: plain calls, tail calls, exceptions"
    )]
    LostTrack {
        /// The function.
        function: String,
        /// The plugin's words.
        what: String,
    },
}
