//! Why a joint does not come onto a board, each in one line.

use std::io;
use std::path::PathBuf;

use super::{INSTALL, PROGRAM};
use crate::{budget, firmware, machine, target};

/// A joint that does not come onto its board.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The board's folder does not name its chip.
    #[error("{}: {what}", file.display())]
    Chip {
        /// The file that should.
        file: PathBuf,
        /// Its fault.
        what: String,
    },
    /// The board that cycles are counted on has another core.
    #[error(
        "board {board}: counted_on = \"{other}\" has another core, {found}; allowed: a board with {core}"
    )]
    OtherCore {
        /// The board.
        board: String,
        /// Its core.
        core: String,
        /// The other board.
        other: String,
        /// That one's core.
        found: String,
    },
    /// The flashing program is missing.
    #[error("no {PROGRAM} on PATH, which flashes this board's chip; install it: `{INSTALL}`")]
    NoProgram,
    /// There is no probe to flash with.
    #[error("no debug probe is connected ({said}); connect the board's: `{PROGRAM} list` shows it")]
    NoProbe {
        /// The program's message.
        said: String,
    },
    /// The program failed, with another chip behind the probe for instance.
    #[error("`{PROGRAM} {command}` failed: {said}")]
    Refused {
        /// Its subcommand.
        command: String,
        /// Its message.
        said: String,
    },
    /// The host's side failed.
    #[error("{PROGRAM}: {0}")]
    Io(#[from] io::Error),
    /// No image.
    #[error(transparent)]
    Firmware(#[from] firmware::Error),
    /// The budget, or what cannot be judged by it.
    #[error(transparent)]
    Budget(#[from] budget::Error),
    /// No emulator, or an image that it cannot boot.
    #[error(transparent)]
    Machine(#[from] machine::Error),
    /// The run in the emulator.
    #[error(transparent)]
    Run(#[from] target::Error),
}
