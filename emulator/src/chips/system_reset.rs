//! The reset of a whole chip, as a watchdog causes it: every peripheral and the core start anew, what is always on keeps its state, memory its
//! contents.
//!
//! It comes at the end of the emulator's quantum, some microseconds later than on a chip.

use std::sync::{Arc, OnceLock};

use rsemu::core::device::{Device, DeviceClass, MachineReset, RealizeCtx, ResetKind, SinkPin};
use rsemu::core::error::Result;
use rsemu::core::wire::{Level, WireId, WireSink};
use rsemu::machine::realize::Instance;
use rsemu::machine::validate::{ClassSchema, PortDir};

/// Class of it in a machine's description.
pub static CLASS: DeviceClass = DeviceClass {
    name: "strainwave.system-reset",
    version: 1,
    summary: "reset of the core and all peripherals",
    properties: &[],
    construct: |_| Ok(Box::new(SystemReset::default())),
};

/// What a description may say of it.
pub fn schema() -> ClassSchema {
    ClassSchema::new(CLASS.name).port("in", PortDir::In)
}

/// Such a reset.
#[derive(Debug, Default)]
pub struct SystemReset {
    // A wire does not keep what it ends at.
    input: Arc<Input>,
}

impl Device for SystemReset {
    fn class(&self) -> &'static DeviceClass {
        &CLASS
    }

    fn realize(&self, context: &mut RealizeCtx<'_>) -> Result<()> {
        let machine = context.machine_reset()?;
        self.input.0.get_or_init(|| machine);
        Ok(())
    }

    fn reset(&self, _kind: ResetKind) {}

    fn sink(&self, port: &str, _sources: &[WireId]) -> Option<SinkPin> {
        (port == "in").then(|| SinkPin { sink: self.input.clone(), line: 0 })
    }
}

impl Instance for SystemReset {}

/// High: the chip is to be reset.
#[derive(Debug, Default)]
struct Input(OnceLock<Arc<MachineReset>>);

impl WireSink for Input {
    fn set_level(&self, _source: WireId, _line: u32, level: Level) {
        if let (Some(machine), true) = (self.0.get(), level.is_high()) {
            machine.request();
        }
    }
}
