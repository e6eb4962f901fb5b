//! Measured logs that a command reads.

use std::path::Path;

use strainwave_desktop::io::log::{Extra, InputOutput, MeasuredLog};
use strainwave_desktop::{BadInput, GearFile};

use crate::figures::complain;

/// How logs are read.
#[derive(Clone, Copy)]
pub struct Reading {
    /// Columns that are not known are left out.
    pub ignore_extra: bool,
    /// The motor torque counts against the motor angle.
    pub reversed_torque: bool,
}

impl Reading {
    /// The log of a joint, checked; what was ignored and what limits its use is told on the error stream.
    pub fn log(self, path: &Path, gear: &GearFile) -> Result<MeasuredLog, BadInput> {
        let (log, ignored) = MeasuredLog::read_with(path, self.extra())?;
        log.require_sound(gear).map_err(|why| BadInput::new(path, why))?;
        let limits = log.limits().into_iter().map(|limit| format!("warning: {limit}"));
        tell_ignored(path, &ignored);
        limits.for_each(|note| complain(format_args!("{}", BadInput::new(path, note))));
        Ok(if self.reversed_torque { log.with_reversed_torque() } else { log })
    }

    /// The log of any actuator, checked; what was ignored is told on the error stream.
    pub fn input_output(self, path: &Path) -> Result<InputOutput, BadInput> {
        let (log, ignored) = InputOutput::read(path, self.extra())?;
        tell_ignored(path, &ignored);
        Ok(log)
    }

    fn extra(self) -> Extra {
        if self.ignore_extra { Extra::Ignored } else { Extra::Refused }
    }
}

fn tell_ignored(path: &Path, columns: &[String]) {
    if !columns.is_empty() {
        let note = format_args!("ignored: {}", columns.join(", "));
        complain(format_args!("{}", BadInput::new(path, note)));
    }
}
