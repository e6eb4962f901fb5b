//! Torque by strain gauges on the target, in an image of its own, which the host feeds.

use std::path::Path;

use serde::Deserialize;

use super::error::Failure;
use super::{Block, Error, Measurement, TORQUE_GAUGES};

/// The program, and the step that it takes for each reading.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TorqueGauges {
    /// The board's program; it ends when the host closes the link.
    pub program: String,
    /// Torque and standard deviation of a control period.
    pub step: Block,
}

impl TorqueGauges {
    /// Adds what the step costs in the image at `elf` while `workload` feeds it.
    ///
    /// # Errors
    /// As [`Measurement::add_workload`].
    pub fn measure(
        &self,
        elf: &Path,
        measured: &mut Measurement,
        workload: impl FnOnce(&[String]) -> Result<(), Failure>,
    ) -> Result<(), Error> {
        measured.add_workload(elf, &[(TORQUE_GAUGES, &self.step)], workload)
    }
}
