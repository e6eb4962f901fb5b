//! A chip's SPI as a master of bytes, by the registers of its controller.
//!
//! A byte takes its time on the bus, and what comes is held until it is read.

use std::collections::VecDeque;
use std::fmt::Debug;
use std::sync::{Arc, Mutex};

use rsemu::bus::spi::{Format, Mode, SpiBus, buses};
use rsemu::core::device::{Device, DeviceClass, PropertySpec, RealizeCtx, ResetKind};
use rsemu::core::error::Result;
use rsemu::core::props::{Props, ValueKind};
use rsemu::core::sched::LazyHandle;
use rsemu::core::space::{AccessConstraints, MemAttrs, MemOps, MemResult, Region, RegionRef};
use rsemu::core::value::{Endian, Width};
use rsemu::machine::realize::Instance;
use rsemu::machine::validate::{ClassSchema, PropSchema};

use crate::chips::time::Time;
use crate::lock::locked;

/// Size of the registers' place (bytes).
const SIZE: u64 = 0x400;

/// Properties of a class of masters.
pub const PROPERTIES: &[PropertySpec] =
    &[PropertySpec { name: "bus", kind: ValueKind::Str, required: true, summary: "its SPI bus" }];

/// What a description may say of one.
pub fn schema(class: &'static DeviceClass) -> ClassSchema {
    ClassSchema::new(class.name).prop(PropSchema::new("bus", ValueKind::Str).required()).region("")
}

/// The mode in which the clock idles high, and samples at its second edge.
pub fn mode(idle_high: bool, second_edge: bool) -> Mode {
    match (idle_high, second_edge) {
        (false, false) => Mode::Mode0,
        (false, true) => Mode::Mode1,
        (true, false) => Mode::Mode2,
        (true, true) => Mode::Mode3,
    }
}

/// The registers of a controller, but for the data.
pub trait Controller: Debug + Send + Sync + 'static {
    /// Out of reset.
    const RESET: Self;
    /// Offset of what is sent.
    const SENT: u64;
    /// Offset of what has come.
    const COME: u64;
    /// Offset of the status.
    const STATUS: u64;
    /// In the status: a byte has come.
    const HAS_COME: u32;
    /// In the status: there is room for one.
    const HAS_ROOM: u32;
    /// Bytes that it holds.
    const FIFO: usize;
    /// Each byte of an access to the data is a frame; else the access is one.
    const BYTEWISE: bool;

    /// Writes a register.
    fn write(&mut self, offset: u64, word: u32);
    /// Reads one.
    fn read(&self, offset: u64) -> u32;
    /// How it clocks a frame.
    fn format(&self) -> Format;
    /// Clocks that a bit takes.
    fn bit(&self) -> u64;
    /// It is on, and a master.
    fn sends(&self) -> bool;
    /// It drops what it holds.
    fn drops(&self) -> bool {
        false
    }
}

/// Such a peripheral.
#[derive(Debug)]
pub struct Master<C> {
    class: &'static DeviceClass,
    port: Arc<Port<C>>,
}

impl<C: Controller> Master<C> {
    /// Of its properties.
    ///
    /// # Errors
    /// Without a bus.
    pub fn new(class: &'static DeviceClass, props: &Props) -> Result<Self> {
        let mut reader = props.reader();
        let bus = buses::attach(props, reader.require_str("bus")?)?;
        reader.finish()?;
        Ok(Self::on(class, bus))
    }

    fn on(class: &'static DeviceClass, bus: Arc<SpiBus>) -> Self {
        let state = Mutex::new(State { registers: C::RESET, coming: VecDeque::new() });
        Self { class, port: Arc::new(Port { bus, state, time: Time::default() }) }
    }
}

impl<C: Controller> Device for Master<C> {
    fn class(&self) -> &'static DeviceClass {
        self.class
    }

    fn realize(&self, _context: &mut RealizeCtx<'_>) -> Result<()> {
        Ok(())
    }

    fn reset(&self, _kind: ResetKind) {
        *locked(&self.port.state) = State { registers: C::RESET, coming: VecDeque::new() };
    }

    fn region(&self, name: &str) -> Option<RegionRef> {
        let io = || Region::io(self.class.name, SIZE, self.port.clone());
        name.is_empty().then(|| Arc::new(io()))
    }

    // An access brings it up to date.
    fn is_lazy(&self) -> bool {
        true
    }

    fn current_tick(&self) -> u64 {
        self.port.time.now()
    }

    fn advance_to(&self, tick: u64) {
        self.port.time.advance_to(tick);
    }

    fn attach_lazy(&self, handle: LazyHandle) {
        self.port.time.attach(handle);
    }
}

impl<C: Controller> Instance for Master<C> {}

/// Its registers, and what is on the bus.
#[derive(Debug)]
struct State<C> {
    registers: C,
    /// Bytes that come, each with its time.
    coming: VecDeque<(u64, u8)>,
}

impl<C: Controller> State<C> {
    fn has_come(&self, now: u64) -> bool {
        self.coming.front().is_some_and(|(at, _)| *at <= now)
    }

    fn status(&self, now: u64) -> u32 {
        let in_flight = self.coming.iter().filter(|(at, _)| *at > now).count();
        (if self.has_come(now) { C::HAS_COME } else { 0 }) | if in_flight < C::FIFO { C::HAS_ROOM } else { 0 }
    }

    fn read(&self, offset: u64, now: u64) -> u32 {
        if offset == C::STATUS { self.status(now) } else { self.registers.read(offset) }
    }

    fn write(&mut self, offset: u64, word: u32) {
        self.registers.write(offset, word);
        if self.registers.drops() {
            self.coming.clear();
        }
    }

    /// What has come by now.
    fn take(&mut self, now: u64) -> u8 {
        if self.has_come(now) { self.coming.pop_front().map_or(0, |(_, byte)| byte) } else { 0 }
    }

    /// Puts a byte on the bus; one that finds no room is lost.
    fn send(&mut self, bus: &SpiBus, byte: u8, now: u64) {
        if !self.registers.sends() || self.coming.len() >= C::FIFO {
            return;
        }
        let format = self.registers.format();
        // Who is clocked in another mode answers nothing of use.
        let understood = bus.check_format(format).is_none();
        let answer = if understood { bus.transfer(byte.into()) as u8 } else { 0xff };
        let begin = self.coming.back().map_or(now, |(at, _)| now.max(*at));
        let end = begin + u64::from(format.bits) * self.registers.bit();
        self.coming.push_back((end, answer));
    }
}

/// It as the bus of the chip sees it.
#[derive(Debug)]
struct Port<C> {
    bus: Arc<SpiBus>,
    state: Mutex<State<C>>,
    time: Time,
}

/// Frames of an access to the data.
fn frames<C: Controller>(bytes: usize) -> usize {
    if C::BYTEWISE { bytes } else { 1 }
}

impl<C: Controller> MemOps for Port<C> {
    fn read(&self, offset: u64, bytes: &mut [u8], attributes: MemAttrs) -> MemResult {
        let now = self.time.sync(attributes);
        let mut state = locked(&self.state);
        if offset == C::COME && !attributes.debug {
            bytes.fill(0);
            let frames = frames::<C>(bytes.len());
            bytes.iter_mut().take(frames).for_each(|byte| *byte = state.take(now));
        } else {
            bytes.copy_from_slice(&state.read(offset, now).to_le_bytes()[..bytes.len()]);
        }
        Ok(())
    }

    fn write(&self, offset: u64, bytes: &[u8], attributes: MemAttrs) -> MemResult {
        let now = self.time.sync(attributes);
        let mut state = locked(&self.state);
        if offset == C::SENT {
            let frames = frames::<C>(bytes.len());
            bytes.iter().take(frames).for_each(|byte| state.send(&self.bus, *byte, now));
        } else {
            let mut word = [0; 4];
            word[..bytes.len()].copy_from_slice(bytes);
            state.write(offset, u32::from_le_bytes(word));
        }
        Ok(())
    }

    fn constraints(&self) -> AccessConstraints {
        let words = AccessConstraints::word(Width::U32, Endian::Little);
        if C::BYTEWISE { words.with_widths(Width::U8, Width::U32) } else { words }
    }
}

/// What tests of controllers need.
#[cfg(test)]
pub(super) mod tests {
    use rsemu::bus::spi::{BitOrder, ChipSelect, SpiSlave};

    use super::*;

    /// Answers the complement of what comes.
    #[derive(Debug)]
    struct Complement;

    impl SpiSlave for Complement {
        fn format(&self) -> Format {
            Format::new(Mode::Mode3, 8, BitOrder::MsbFirst)
        }

        fn select(&self, _selected: bool) {}

        fn transfer(&self, byte: u32) -> u32 {
            !byte
        }
    }

    impl<C: Controller> Master<C> {
        /// On a bus with `Complement`, these registers written.
        pub fn set_up(class: &'static DeviceClass, registers: &[(u64, u32)]) -> Self {
            let bus = Arc::new(SpiBus::new());
            bus.attach(ChipSelect(0), Arc::new(Complement)).unwrap();
            bus.select(Some(ChipSelect(0)));
            let master = Self::on(class, bus);
            registers.iter().for_each(|(offset, word)| master.write(*offset, &word.to_le_bytes()));
            master
        }

        fn write(&self, offset: u64, bytes: &[u8]) {
            self.port.write(offset, bytes, MemAttrs::DEFAULT).unwrap();
        }

        /// Sends what an access of so many bytes does.
        pub fn send<const BYTES: usize>(&self, bytes: [u8; BYTES]) {
            self.write(C::SENT, &bytes);
        }

        /// What an access of so many bytes takes.
        pub fn take<const BYTES: usize>(&self) -> [u8; BYTES] {
            let mut bytes = [0; BYTES];
            self.port.read(C::COME, &mut bytes, MemAttrs::DEFAULT).unwrap();
            bytes
        }

        /// A byte has come.
        pub fn has_come(&self) -> bool {
            let mut word = [0; 4];
            self.port.read(C::STATUS, &mut word, MemAttrs::DEFAULT).unwrap();
            u32::from_le_bytes(word) & C::HAS_COME != 0
        }
    }
}
