//! SPI of an STM32H7 (ST RM0433, chapter 50) as a master: one transfer without an end, frames of a byte.
//!
//! A byte takes its time on the bus, and what comes is held until it is read. Interrupts, DMA, CRC and transfers of a given length are
//! not there.

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

const CR1: u64 = 0x00;
const CFG1: u64 = 0x08;
const CFG2: u64 = 0x0c;
const SR: u64 = 0x14;
const TXDR: u64 = 0x20;
const RXDR: u64 = 0x30;
/// Size of their place (bytes).
const SIZE: u64 = 0x400;

/// In `CR1`: on; the transfer is started; nobody else selects it.
const ON: u32 = 1 << 0;
const STARTED: u32 = 1 << 9;
const NOT_SELECTED: u32 = 1 << 12;
/// In `CFG2`: master, and the order and clock of the bits.
const MASTER: u32 = 1 << 22;
const LEAST_FIRST: u32 = 1 << 23;
const SECOND_EDGE: u32 = 1 << 24;
const IDLE_HIGH: u32 = 1 << 25;
/// In `SR`: a byte has come; there is room for one.
const HAS_COME: u32 = 1 << 0;
const HAS_ROOM: u32 = 1 << 1;
/// `CFG1` out of reset.
const CFG1_RESET: u32 = 0x0007_0007;
/// Bytes that it holds.
const FIFO: usize = 16;

/// Class of it in a machine's description.
pub static CLASS: DeviceClass = DeviceClass {
    name: "strainwave.h7-spi",
    version: 1,
    summary: "STM32H7 SPI, a master of bytes",
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
    cr1: u32,
    cfg1: u32,
    cfg2: u32,
    /// Bytes that come, each with its time.
    coming: VecDeque<(u64, u8)>,
}

impl State {
    const RESET: Self = Self { cr1: 0, cfg1: CFG1_RESET, cfg2: 0, coming: VecDeque::new() };

    fn write(&mut self, offset: u64, word: u32) {
        let on = self.cr1 & ON != 0;
        match offset {
            CR1 => {
                // The start is taken when it is on already.
                self.cr1 = if on { word } else { word & !STARTED };
                if word & ON == 0 {
                    self.coming.clear();
                }
            }
            CFG1 if !on => self.cfg1 = word,
            // It ceases to be a master when somebody else selects it.
            CFG2 if !on && self.cr1 & NOT_SELECTED == 0 => self.cfg2 = word & !MASTER,
            CFG2 if !on => self.cfg2 = word,
            _ => {}
        }
    }

    fn read(&self, offset: u64, now: u64) -> u32 {
        match offset {
            CR1 => self.cr1,
            CFG1 => self.cfg1,
            CFG2 => self.cfg2,
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
        let mode = match (self.cfg2 & IDLE_HIGH != 0, self.cfg2 & SECOND_EDGE != 0) {
            (false, false) => Mode::Mode0,
            (false, true) => Mode::Mode1,
            (true, false) => Mode::Mode2,
            (true, true) => Mode::Mode3,
        };
        let order = if self.cfg2 & LEAST_FIRST != 0 { BitOrder::LsbFirst } else { BitOrder::MsbFirst };
        Format::new(mode, (self.cfg1 & 0x1f) as u8 + 1, order)
    }

    /// Clocks that a frame takes.
    fn duration(&self) -> u64 {
        u64::from(self.format().bits) << ((self.cfg1 >> 28 & 0b111) + 1)
    }

    fn sends(&self) -> bool {
        self.cr1 & (ON | STARTED) == ON | STARTED && self.cfg2 & MASTER != 0
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
        if offset == RXDR && !attributes.debug {
            bytes.fill_with(|| state.take(now));
        } else {
            bytes.copy_from_slice(&state.read(offset, now).to_le_bytes()[..bytes.len()]);
        }
        Ok(())
    }

    fn write(&self, offset: u64, bytes: &[u8], attributes: MemAttrs) -> MemResult {
        if offset == TXDR {
            let now = self.now(attributes);
            bytes.iter().for_each(|byte| self.send(*byte, now));
        } else {
            let mut word = [0; 4];
            word[..bytes.len()].copy_from_slice(bytes);
            locked(&self.state).write(offset, u32::from_le_bytes(word));
        }
        Ok(())
    }

    fn constraints(&self) -> AccessConstraints {
        AccessConstraints::word(Width::U32, Endian::Little).with_widths(Width::U8, Width::U32)
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

    /// On a bus with `Complement`, in a mode, `cr1` written before and after it is set up.
    fn spi(mode: u32, cr1: [u32; 3]) -> Spi {
        let bus = Arc::new(SpiBus::new());
        bus.attach(ChipSelect(0), Arc::new(Complement)).unwrap();
        bus.select(Some(ChipSelect(0)));
        let spi = Spi::on(bus);
        write(&spi, CR1, &cr1[0].to_le_bytes());
        write(&spi, CFG1, &(CFG1_RESET | 0b010 << 28).to_le_bytes());
        write(&spi, CFG2, &(MASTER | mode).to_le_bytes());
        write(&spi, CR1, &cr1[1].to_le_bytes());
        write(&spi, CR1, &cr1[2].to_le_bytes());
        spi
    }

    /// As the firmware sets it up.
    const USUAL: [u32; 3] = [NOT_SELECTED, NOT_SELECTED | ON, NOT_SELECTED | ON | STARTED];

    fn write(spi: &Spi, offset: u64, bytes: &[u8]) {
        spi.0.write(offset, bytes, MemAttrs::DEFAULT).unwrap();
    }

    fn read<const BYTES: usize>(spi: &Spi, offset: u64) -> [u8; BYTES] {
        let mut bytes = [0; BYTES];
        spi.0.read(offset, &mut bytes, MemAttrs::DEFAULT).unwrap();
        bytes
    }

    fn has_come(spi: &Spi) -> bool {
        u32::from_le_bytes(read(spi, SR)) & HAS_COME != 0
    }

    #[test]
    fn bytes_come_after_their_time_one_by_one() {
        let spi = spi(IDLE_HIGH | SECOND_EDGE, USUAL);
        write(&spi, TXDR, &[0x12]);
        write(&spi, TXDR, &[0x34]);
        // Eight bits of eight clocks each.
        spi.advance_to(63);
        assert!(!has_come(&spi));
        spi.advance_to(64);
        assert!(has_come(&spi));
        assert_eq!(read(&spi, RXDR), [!0x12]);
        assert!(!has_come(&spi));
        spi.advance_to(128);
        assert_eq!(read(&spi, RXDR), [!0x34]);
    }

    #[test]
    fn a_word_is_four_bytes() {
        let spi = spi(IDLE_HIGH | SECOND_EDGE, USUAL);
        write(&spi, TXDR, &[1, 2, 3, 4]);
        spi.advance_to(4 * 64);
        assert_eq!(read(&spi, RXDR), [!1, !2, !3, !4]);
    }

    #[test]
    fn in_another_mode_nothing_is_understood() {
        let spi = spi(IDLE_HIGH, USUAL);
        write(&spi, TXDR, &[0x12]);
        spi.advance_to(64);
        assert_eq!(read(&spi, RXDR), [0xff]);
    }

    #[test]
    fn what_is_off_not_started_or_selected_sends_nothing() {
        let all = NOT_SELECTED | ON | STARTED;
        for cr1 in [[NOT_SELECTED; 3], [NOT_SELECTED, all, NOT_SELECTED | ON], [0, ON, all], [ON, all, all]] {
            let spi = spi(IDLE_HIGH | SECOND_EDGE, cr1);
            write(&spi, TXDR, &[0x12]);
            spi.advance_to(64);
            assert!(!has_come(&spi), "{cr1:x?}");
        }
    }
}
