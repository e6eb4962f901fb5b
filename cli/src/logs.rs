//! Measured logs that a command reads.

use std::path::Path;

use strainwave_desktop::io::log::{Extra, MeasuredLog};
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
        let extra = if self.ignore_extra { Extra::Ignored } else { Extra::Refused };
        let (log, ignored) = MeasuredLog::read_with(path, extra)?;
        log.require_sound(gear).map_err(|why| BadInput::new(path, why))?;
        let ignored = (!ignored.is_empty()).then(|| format!("ignored: {}", ignored.join(", ")));
        let limits = log.limits().into_iter().map(|limit| format!("warning: {limit}"));
        for note in ignored.into_iter().chain(limits) {
            complain(format_args!("{}", BadInput::new(path, note)));
        }
        Ok(if self.reversed_torque { log.with_reversed_torque() } else { log })
    }
}
