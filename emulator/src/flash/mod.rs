//! Brings a joint onto a board: judged, then flashed or, on an emulated board, started.
//!
//! ```text
//! gear -> image -> judgement (seconds) -> real board:     probe-rs download, probe-rs reset
//!                                      -> emulated board: one second of control in QEMU
//! ```

mod chip;
mod error;
mod first_second;
mod judgement;
mod probe;

pub use chip::chip;
pub use error::Error;
pub use first_second::control_for_a_second;
pub use judgement::{Counted, Judgement, WORKLOAD, judge};
pub use probe::Probe;

use std::path::Path;

use crate::budget::Budget;
use crate::machine::{self, Options};

/// Least `drive.delay_periods` of a gear file whose drive is on CAN: the torque of a control step is there up to 0.5 ms after it, of which the
/// control's own period is 0.1 ms.
pub const DRIVE_DELAY: u32 = 4;

/// The program that writes an image through a debug probe.
const PROGRAM: &str = "probe-rs";
/// Its installation.
const INSTALL: &str = "cargo install probe-rs-tools --locked";

/// How an image comes to run on a board.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Way {
    /// The emulator boots it.
    Emulator,
    /// A debug probe writes it into the chip.
    Probe(Probe),
}

impl Way {
    /// The way of the board of a budget.
    ///
    /// # Errors
    /// As [`chip`].
    pub fn of(budget: &Budget) -> Result<Self, Error> {
        if budget.emulated { Ok(Self::Emulator) } else { Ok(Self::Probe(Probe::of(chip(&budget.board)?))) }
    }

    /// The commands that it takes, program first.
    ///
    /// # Errors
    /// As [`machine::command`].
    pub fn commands(&self, elf: &Path) -> Result<Vec<Vec<String>>, Error> {
        match self {
            Self::Emulator => {
                let (program, arguments) = machine::command(elf, &Options::default())?;
                Ok(vec![[vec![program.display().to_string()], arguments].concat()])
            }
            Self::Probe(probe) => Ok(probe.commands(elf).to_vec()),
        }
    }
}
