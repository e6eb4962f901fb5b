//! SPI of an RP2350, a PL022 (datasheet, 12.3) as a master of bytes in Motorola's format.
//!
//! A byte takes its time on the bus, and what comes is held until it is read. Interrupts, DMA and other formats are not there.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock};

use rsemu::bus::spi::{BitOrder, Format, Mode, SpiBus, buses};
use rsemu::core::device::{Device, DeviceClass, PropertySpec, RealizeCtx, ResetKind};
use rsemu::core::error::Result;
use rsemu::core::props::{Props, ValueKind};
use rsemu::core::sched::{AccessKind, LazyHandle};
use rsemu::core::space::{AccessConstraints, MemAttrs, MemOps, MemResult, Region, RegionRef};
use rsemu::core::value::{Endian, Width};
use rsemu::machine::realize::Instance;
use rsemu::machine::validate::{ClassSchema, PropSchema};

use crate::lock::locked;

const CR0: u64 = 0x00;
const CR1: u64 = 0x04;
const DR: u64 = 0x08;
const SR: u64 = 0x0c;
const CPSR: u64 = 0x10;
/// Size of their place (bytes).
const SIZE: u64 = 0x400;

/// In `CR0`: the format of the frames, and the order and clock of the bits.
const FORMAT: u32 = 0b11 << 4;
const IDLE_HIGH: u32 = 1 << 6;
const SECOND_EDGE: u32 = 1 << 7;
/// In `CR1`: on; no master.
const ON: u32 = 1 << 1;
const SLAVE: u32 = 1 << 2;
/// In `SR`: there is room for a byte; one has come.
const HAS_ROOM: u32 = 1 << 1;
const HAS_COME: u32 = 1 << 2;
/// Bytes that it holds.
const FIFO: usize = 8;

/// Class of it in a machine's description.
pub static CLASS: DeviceClass = DeviceClass {
    name: "strainwave.rp2350-spi",
    version: 1,
    summary: "RP2350 SPI, a master of bytes",
    properties: &[PropertySpec { name: "bus", kind: ValueKind::Str, required: true, summary: "its SPI bus" }],
    construct: |props| Ok(Box::new(Spi::new(props)?)),
};

/// What a description may say of it.
pub fn schema() -> ClassSchema {
    ClassSchema::new(CLASS.name).prop(PropSchema::new("bus", ValueKind::Str).required()).region("")
}

/// Such a peripheral.
#[derive(Debug)]
pub struct Spi(Arc<Port>);

impl Spi {
    /// Of its properties.
    pub fn new(props: &Props) -> Result<Self> {
        let mut reader = props.reader();
        let bus = buses::attach(props, reader.require_str("bus")?)?;
        reader.finish()?;
        Ok(Self::on(bus))
    }

    fn on(bus: Arc<SpiBus>) -> Self {
        let (state, tick, clock) = (Mutex::new(State::RESET), AtomicU64::new(0), OnceLock::new());
        Self(Arc::new(Port { bus, state, tick, clock }))
    }
}

impl Device for Spi {
    fn class(&self) -> &'static DeviceClass {
        &CLASS
    }

    fn realize(&self, _context: &mut RealizeCtx<'_>) -> Result<()> {
        Ok(())
    }

    fn reset(&self, _kind: ResetKind) {
        *locked(&self.0.state) = State::RESET;
    }

    fn region(&self, name: &str) -> Option<RegionRef> {
        let io = || Region::io(CLASS.name, SIZE, self.0.clone());
        name.is_empty().then(|| Arc::new(io()))
    }

    // An access brings it up to date: `Port::now`.
    fn is_lazy(&self) -> bool {
        true
    }

    fn current_tick(&self) -> u64 {
        self.0.tick.load(Ordering::Relaxed)
    }

    fn advance_to(&self, tick: u64) {
        self.0.tick.fetch_max(tick, Ordering::Relaxed);
    }

    fn attach_lazy(&self, handle: LazyHandle) {
        self.0.clock.get_or_init(|| handle);
    }
}

impl Instance for Spi {}

/// Its registers, and what is on the bus.
#[derive(Debug)]
struct State {
    cr0: u32,
    cr1: u32,
    cpsr: u32,
    /// Bytes that come, each with its time.
    coming: VecDeque<(u64, u8)>,
}

impl State {
    const RESET: Self = Self { cr0: 0, cr1: 0, cpsr: 0, coming: VecDeque::new() };

    fn write(&mut self, offset: u64, word: u32) {
        match offset {
            CR0 => self.cr0 = word,
            CR1 => self.cr1 = word,
            CPSR => self.cpsr = word & 0xfe,
            _ => {}
        }
    }

    fn read(&self, offset: u64, now: u64) -> u32 {
        match offset {
            CR0 => self.cr0,
            CR1 => self.cr1,
            CPSR => self.cpsr,
            SR => {
                let in_flight = self.coming.iter().filter(|(at, _)| *at > now).count();
                let come = self.coming.front().is_some_and(|(at, _)| *at <= now);
                (if come { HAS_COME } else { 0 }) | if in_flight < FIFO { HAS_ROOM } else { 0 }
            }
            _ => 0,
        }
    }

    /// How it clocks a frame.
    fn format(&self) -> Format {
        let mode = match (self.cr0 & IDLE_HIGH != 0, self.cr0 & SECOND_EDGE != 0) {
            (false, false) => Mode::Mode0,
            (false, true) => Mode::Mode1,
            (true, false) => Mode::Mode2,
            (true, true) => Mode::Mode3,
        };
        Format::new(mode, (self.cr0 & 0xf) as u8 + 1, BitOrder::MsbFirst)
    }

    /// Clocks that a frame takes.
    fn duration(&self) -> u64 {
        u64::from(self.format().bits) * u64::from(self.cpsr) * u64::from((self.cr0 >> 8 & 0xff) + 1)
    }

    fn sends(&self) -> bool {
        self.cr1 & (ON | SLAVE) == ON && self.cr0 & FORMAT == 0 && self.cpsr >= 2
    }

    /// What has come by now.
    fn take(&mut self, now: u64) -> u8 {
        let come = self.coming.front().is_some_and(|(at, _)| *at <= now);
        if come { self.coming.pop_front().map_or(0, |(_, byte)| byte) } else { 0 }
    }
}

/// It as the bus of the chip sees it.
#[derive(Debug)]
struct Port {
    bus: Arc<SpiBus>,
    state: Mutex<State>,
    tick: AtomicU64,
    clock: OnceLock<LazyHandle>,
}

impl Port {
    /// The time of an access, in its own clocks. That of a debugger stands still.
    fn now(&self, attributes: MemAttrs) -> u64 {
        if let (Some(clock), false) = (self.clock.get(), attributes.debug) {
            // Refused where it is being brought up to date already: then it is.
            let _ = clock.sync(AccessKind::Guest);
        }
        self.tick.load(Ordering::Relaxed)
    }

    /// Puts a byte on the bus; one that finds no room is lost.
    fn send(&self, byte: u8, now: u64) {
        let mut state = locked(&self.state);
        if !state.sends() || state.coming.len() >= FIFO {
            return;
        }
        // Who is clocked in another mode answers nothing of use.
        let understood = self.bus.check_format(state.format()).is_none();
        let answer = if understood { self.bus.transfer(byte.into()) as u8 } else { 0xff };
        let begin = state.coming.back().map_or(now, |(at, _)| now.max(*at));
        let end = begin + state.duration();
        state.coming.push_back((end, answer));
    }
}

impl MemOps for Port {
    fn read(&self, offset: u64, bytes: &mut [u8], attributes: MemAttrs) -> MemResult {
        let now = self.now(attributes);
        let mut state = locked(&self.state);
        let word =
            if offset == DR && !attributes.debug { state.take(now).into() } else { state.read(offset, now) };
        bytes.copy_from_slice(&word.to_le_bytes());
        Ok(())
    }

    fn write(&self, offset: u64, bytes: &[u8], attributes: MemAttrs) -> MemResult {
        let mut word = [0; 4];
        word.copy_from_slice(bytes);
        if offset == DR {
            self.send(word[0], self.now(attributes));
        } else {
            locked(&self.state).write(offset, u32::from_le_bytes(word));
        }
        Ok(())
    }

    fn constraints(&self) -> AccessConstraints {
        AccessConstraints::word(Width::U32, Endian::Little)
    }
}

#[cfg(test)]
mod tests {
    use rsemu::bus::spi::{ChipSelect, SpiSlave};

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

    /// As the firmware sets it up: bytes, in a mode.
    const USUAL: u32 = 7 | IDLE_HIGH | SECOND_EDGE;

    /// On a bus with `Complement`, 12 clocks a bit.
    fn spi(cr0: u32, cr1: u32) -> Spi {
        let bus = Arc::new(SpiBus::new());
        bus.attach(ChipSelect(0), Arc::new(Complement)).unwrap();
        bus.select(Some(ChipSelect(0)));
        let spi = Spi::on(bus);
        write(&spi, CPSR, 12);
        write(&spi, CR0, cr0);
        write(&spi, CR1, cr1);
        spi
    }

    fn write(spi: &Spi, offset: u64, word: u32) {
        spi.0.write(offset, &word.to_le_bytes(), MemAttrs::DEFAULT).unwrap();
    }

    fn read(spi: &Spi, offset: u64) -> u32 {
        let mut bytes = [0; 4];
        spi.0.read(offset, &mut bytes, MemAttrs::DEFAULT).unwrap();
        u32::from_le_bytes(bytes)
    }

    fn has_come(spi: &Spi) -> bool {
        read(spi, SR) & HAS_COME != 0
    }

    #[test]
    fn bytes_come_after_their_time_one_by_one() {
        let spi = spi(USUAL, ON);
        write(&spi, DR, 0x12);
        write(&spi, DR, 0x34);
        spi.advance_to(95);
        assert!(!has_come(&spi));
        spi.advance_to(96);
        assert!(has_come(&spi));
        assert_eq!(read(&spi, DR), u32::from(!0x12_u8));
        assert!(!has_come(&spi));
        spi.advance_to(192);
        assert_eq!(read(&spi, DR), u32::from(!0x34_u8));
    }

    #[test]
    fn in_another_mode_nothing_is_understood() {
        let spi = spi(7 | IDLE_HIGH, ON);
        write(&spi, DR, 0x12);
        spi.advance_to(96);
        assert_eq!(read(&spi, DR), 0xff);
    }

    #[test]
    fn what_is_off_a_slave_or_in_another_format_sends_nothing() {
        for (cr0, cr1) in [(USUAL, 0), (USUAL, ON | SLAVE), (USUAL | 1 << 4, ON)] {
            let spi = spi(cr0, cr1);
            write(&spi, DR, 0x12);
            spi.advance_to(96);
            assert!(!has_come(&spi), "{cr0:x} {cr1:x}");
        }
    }
}
