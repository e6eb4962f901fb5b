//! An FDCAN of an STM32G4 (ST RM0440, chapter 44) for classic CAN, by polling.
//!
//! | file | what is in it |
//! | --- | --- |
//! | [`node`] | its registers |
//! | [`message_ram`] | filters and elements |
//! | [`ring`] | elements that are used in turn |
//! | [`bus`] | frames in time, and the peer at the bus |
//!
//! Its clock is an oscillator of 24 MHz, whatever the clock control selects; without its bit there nothing is read or written. Frames of CAN FD
//! and of extended identifiers, remote frames, the queue, cancellation, events of sent frames, overwriting FIFOs, transmission without
//! repetition, modes of test and monitoring, timestamps, pins and interrupt lines are not there. Of the interrupts' flags there are those of the
//! FIFOs, of sent frames and of bus off. A receiver counts no errors, and a sender no others than missing acknowledgements, which alone never take
//! it off the bus.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use rsemu::core::device::{Device, DeviceClass, PropertySpec, RealizeCtx, ResetKind, SinkPin};
use rsemu::core::error::Result;
use rsemu::core::props::{Props, ValueKind};
use rsemu::core::sched::LazyHandle;
use rsemu::core::space::{AccessConstraints, MemAttrs, MemOps, MemResult, Region, RegionRef};
use rsemu::core::value::{Endian, Width};
use rsemu::core::wire::{Level, WireId, WireSink};
use rsemu::machine::realize::Instance;
use rsemu::machine::validate::{ClassSchema, PortDir, PropSchema};

use crate::lock::locked;

pub mod bus;
pub mod message_ram;
pub mod node;
pub mod ring;
#[cfg(test)]
mod tests;

pub use bus::CanBus;

/// Size of the registers' place (bytes).
const SIZE: u64 = 0x400;

/// Class of it in a machine's description.
pub static CLASS: DeviceClass = DeviceClass {
    name: "strainwave.g4-fdcan",
    version: 1,
    summary: "STM32G4 FDCAN",
    properties: &[PropertySpec {
        name: "second",
        kind: ValueKind::Bool,
        required: false,
        summary: "it is at the second bus",
    }],
    construct: |props| Ok(Box::new(Fdcan::new(props, &Default::default())?)),
};

/// What a description may say of it.
pub fn schema() -> ClassSchema {
    ClassSchema::new(CLASS.name)
        .prop(PropSchema::new("second", ValueKind::Bool))
        .port("enable", PortDir::In)
        .region("")
        .region("ram")
}

/// The peripheral.
#[derive(Debug)]
pub struct Fdcan {
    bus: Arc<CanBus>,
    // A wire does not keep what it ends at.
    enable: Arc<Enable>,
}

impl Fdcan {
    /// Of its properties, at one of both buses.
    ///
    /// # Errors
    /// A property that it has not.
    pub fn new(props: &Props, [first, second]: &[Arc<CanBus>; 2]) -> Result<Self> {
        let mut reader = props.reader();
        let bus = if reader.or("second", false)? { second } else { first };
        reader.finish()?;
        Ok(Self::on(bus.clone()))
    }

    /// At a bus.
    pub fn on(bus: Arc<CanBus>) -> Self {
        Self { bus, enable: Arc::default() }
    }

    fn face(&self, place: Place) -> Face {
        Face { bus: self.bus.clone(), enable: self.enable.clone(), place }
    }
}

impl Device for Fdcan {
    fn class(&self) -> &'static DeviceClass {
        &CLASS
    }

    fn realize(&self, _context: &mut RealizeCtx<'_>) -> Result<()> {
        Ok(())
    }

    fn reset(&self, _kind: ResetKind) {
        let mut state = locked(&self.bus.state);
        state.node.reset();
        state.follow(self.bus.time.now());
    }

    fn region(&self, name: &str) -> Option<RegionRef> {
        let (place, size) = match name {
            "" => (Place::Registers, SIZE),
            "ram" => (Place::Ram, message_ram::SIZE as u64),
            _ => return None,
        };
        Some(Arc::new(Region::io(CLASS.name, size, Arc::new(self.face(place)))))
    }

    fn sink(&self, port: &str, _sources: &[WireId]) -> Option<SinkPin> {
        (port == "enable").then(|| SinkPin { sink: self.enable.clone(), line: 0 })
    }

    // An access brings it up to date.
    fn is_lazy(&self) -> bool {
        true
    }

    fn current_tick(&self) -> u64 {
        self.bus.time.now()
    }

    fn advance_to(&self, tick: u64) {
        self.bus.time.advance_to(tick);
    }

    fn attach_lazy(&self, handle: LazyHandle) {
        self.bus.time.attach(handle);
    }
}

impl Instance for Fdcan {}

/// Its bit of the clock control.
#[derive(Debug, Default)]
struct Enable(AtomicBool);

impl WireSink for Enable {
    fn set_level(&self, _source: WireId, _line: u32, level: Level) {
        self.0.store(level.is_high(), Ordering::Relaxed);
    }
}

#[derive(Clone, Copy, Debug)]
enum Place {
    Registers,
    Ram,
}

/// Its registers, or its message RAM.
#[derive(Debug)]
struct Face {
    bus: Arc<CanBus>,
    enable: Arc<Enable>,
    place: Place,
}

impl Face {
    fn has_clock(&self) -> bool {
        self.enable.0.load(Ordering::Relaxed)
    }
}

impl MemOps for Face {
    fn read(&self, offset: u64, bytes: &mut [u8], attributes: MemAttrs) -> MemResult {
        let (now, offset) = (self.bus.time.sync(attributes), offset as usize);
        let mut state = locked(&self.bus.state);
        state.up_to(now);
        let word = match self.place {
            _ if !self.has_clock() => 0,
            Place::Ram => state.node.ram.at(offset),
            Place::Registers => state.node.read(offset, now),
        };
        if let (Place::Registers, false) = (self.place, attributes.debug) {
            state.node.was_read(offset);
        }
        bytes.copy_from_slice(&word.to_le_bytes());
        Ok(())
    }

    fn write(&self, offset: u64, bytes: &[u8], attributes: MemAttrs) -> MemResult {
        let (now, offset) = (self.bus.time.sync(attributes), offset as usize);
        let mut word = [0; 4];
        word.copy_from_slice(bytes);
        let word = u32::from_le_bytes(word);
        let mut state = locked(&self.bus.state);
        state.up_to(now);
        match self.place {
            _ if !self.has_clock() => {}
            Place::Ram => state.node.ram.put(offset, word),
            Place::Registers => state.node.write(offset, word, now),
        }
        state.follow(now);
        Ok(())
    }

    fn constraints(&self) -> AccessConstraints {
        AccessConstraints::word(Width::U32, Endian::Little)
    }
}
