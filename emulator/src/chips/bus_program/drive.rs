//! What a master expects of a joint whose drive is on a bus of its own, beside all else.
//!
//! ```text
//! silent      its heartbeats stop in motion: it is off, and the fault is named
//! error       it has an error in motion: the same, and a reset clears it
//! ```

use std::io;

use strainwave::compensator::schedule::CONTROL_PERIOD;

use super::{CYCLE, Failure, Found, Master, PATIENCE, POSITION, REST};
use crate::chips::host::RELEASED;

/// Error codes.
const DRIVE_ERROR: u16 = 0x5400;
const DRIVE_SILENT: u16 = 0x7500;

impl Master {
    /// Does it all.
    ///
    /// # Errors
    /// When the chip does not go on.
    pub fn works_before_drive(mut self) -> io::Result<Found> {
        self.commands()?;
        self.found.silent_after = self.drive_fails(Failure::Silent, DRIVE_SILENT)?;
        self.found.error_after = self.drive_fails(Failure::Error, DRIVE_ERROR)?;
        self.failed()?;
        Ok(self.found)
    }

    /// Time until it is off and its fault is named (s).
    fn drive_fails(&mut self, failure: Failure, code: u16) -> io::Result<f64> {
        self.moves(POSITION)?;
        let (begin, named) = (self.periods, self.told.errors.len());
        self.failure = Some(failure);
        while self.periods - begin < PATIENCE * CYCLE
            && (self.told.errors.len() == named || self.drive != RELEASED)
        {
            let begins = (self.periods - begin).is_multiple_of(CYCLE);
            self.put(if begins { self.frames() } else { Vec::new() })?;
            self.failure = self.failure.filter(|failure| *failure == Failure::Silent);
        }
        let after = (self.periods - begin) as f64 * CONTROL_PERIOD;
        self.expect("a failure of the drive is named once", self.told.errors[named..] == [code]);
        self.expect("a drive that has failed is off", self.drive == RELEASED);
        self.failure = None;
        self.cycles(REST)?;
        self.leaves_fault()?;
        Ok(after)
    }
}
