//! Watchdog of an RP2350 with the ticks that it counts and the choice of what it resets (datasheet, 7.4, 8.5 and 12.9).
//!
//! It counts where its ticks are on and a microsecond long, and resets the chip where it is told to reset the core.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock};

use rsemu::core::device::{Device, DeviceClass, RealizeCtx, ResetKind};
use rsemu::core::error::{Error, Result};
use rsemu::core::sched::LazyHandle;
use rsemu::core::space::{AccessConstraints, MemAttrs, MemOps, MemResult, Region, RegionRef};
use rsemu::core::value::{Endian, Width};
use rsemu::core::wire::{Level, WireSource};
use rsemu::machine::realize::Instance;
use rsemu::machine::validate::{ClassSchema, PortDir};

use crate::chips::time::Time;
use crate::lock::locked;

/// Its registers: control, countdown, cause of the last reset, and eight that a reset by it keeps.
const CTRL: u64 = 0x00;
const LOAD: u64 = 0x04;
const REASON: u64 = 0x08;
const SCRATCH: u64 = 0x0c;
const SCRATCHES: usize = 8;
/// In the control.
const ENABLE: u32 = 1 << 30;
/// In the cause: the countdown.
const COUNTED_DOWN: u32 = 1 << 0;
/// Its ticks: control and length.
const TICK_CTRL: u64 = 0x30;
const TICK_CYCLES: u64 = 0x34;
/// Periods of the ring oscillator in a microsecond.
const MICROSECOND: u32 = 11;
/// What it resets, and there the core.
const WDSEL: u64 = 0x08;
const CORE: u32 = 1 << 23;
/// Size of each place (bytes).
const SIZE: u64 = 0x400;

/// Class of it in a machine's description. Its clock is that of the ticks.
pub static CLASS: DeviceClass = DeviceClass {
    name: "strainwave.rp2350-watchdog",
    version: 1,
    summary: "RP2350 watchdog with its ticks and stages",
    properties: &[],
    construct: |_| Ok(Box::new(Watchdog::default())),
};

/// What a description may say of it.
pub fn schema() -> ClassSchema {
    let schema = ClassSchema::new(CLASS.name).port("reset", PortDir::Out);
    schema.region("").region("ticks").region("stages")
}

/// Such a peripheral.
#[derive(Debug, Default)]
pub struct Watchdog(Arc<Dog>);

impl Device for Watchdog {
    fn class(&self) -> &'static DeviceClass {
        &CLASS
    }

    fn realize(&self, _context: &mut RealizeCtx<'_>) -> Result<()> {
        Ok(())
    }

    fn reset(&self, kind: ResetKind) {
        let mut state = locked(&self.0.state);
        *state = match kind {
            ResetKind::Cold => State { tick: state.tick, ..State::default() },
            _ => state.after_reset(),
        };
        self.0.publish(&state);
    }

    fn region(&self, name: &str) -> Option<RegionRef> {
        let place = match name {
            "" => Place::Watchdog,
            "ticks" => Place::Ticks,
            "stages" => Place::Stages,
            _ => return None,
        };
        Some(Arc::new(Region::io(CLASS.name, SIZE, Arc::new(Registers { dog: self.0.clone(), place }))))
    }

    fn connect(&self, port: &str, source: WireSource) -> Result<()> {
        if port != "reset" {
            return Err(Error::Config { at: port.into(), message: "it drives `reset`".into() });
        }
        self.0.wire.get_or_init(|| source);
        Ok(())
    }

    fn is_lazy(&self) -> bool {
        true
    }

    fn current_tick(&self) -> u64 {
        self.0.time.now()
    }

    fn advance_to(&self, tick: u64) {
        self.0.advance_to(tick);
    }

    fn next_event_tick(&self) -> Option<u64> {
        Some(self.0.event.load(Ordering::Relaxed)).filter(|event| *event != 0)
    }

    fn attach_lazy(&self, handle: LazyHandle) {
        self.0.time.attach(handle);
    }
}

impl Instance for Watchdog {}

#[derive(Clone, Copy, Debug)]
enum Place {
    Watchdog,
    Ticks,
    Stages,
}

/// All registers.
#[derive(Debug, Default)]
struct State {
    ctrl: u32,
    /// Left of the countdown.
    left: u64,
    reason: u32,
    scratch: [u32; SCRATCHES],
    tick_ctrl: u32,
    tick_cycles: u32,
    stages: u32,
    /// Time until which it has counted.
    tick: u64,
}

impl State {
    fn counts(&self) -> bool {
        self.ctrl & ENABLE != 0 && self.tick_ctrl & 1 != 0 && self.tick_cycles == MICROSECOND && self.left > 0
    }

    /// Time of its end; 0 where it does not count.
    fn end(&self) -> u64 {
        if self.counts() { self.tick + self.left } else { 0 }
    }

    /// Counts; whether it resets the core.
    fn count(&mut self, tick: u64) -> bool {
        let span = tick.saturating_sub(self.tick);
        self.tick = self.tick.max(tick);
        if !self.counts() {
            return false;
        }
        self.left = self.left.saturating_sub(span);
        if self.left > 0 || self.stages & CORE == 0 {
            return false;
        }
        *self = Self { reason: COUNTED_DOWN, ..self.after_reset() };
        true
    }

    /// What a reset by it leaves.
    fn after_reset(&self) -> Self {
        Self { reason: self.reason, scratch: self.scratch, tick: self.tick, ..Self::default() }
    }

    fn scratch(&mut self, offset: u64) -> Option<&mut u32> {
        self.scratch.get_mut((offset.checked_sub(SCRATCH)? / 4) as usize)
    }

    fn read(&mut self, place: Place, offset: u64) -> u32 {
        match (place, offset) {
            (Place::Watchdog, CTRL) => self.ctrl | self.left as u32,
            (Place::Watchdog, REASON) => self.reason,
            (Place::Watchdog, _) => self.scratch(offset).map_or(0, |word| *word),
            (Place::Ticks, TICK_CTRL) => self.tick_ctrl,
            (Place::Ticks, TICK_CYCLES) => self.tick_cycles,
            (Place::Stages, WDSEL) => self.stages,
            _ => 0,
        }
    }

    fn write(&mut self, place: Place, offset: u64, word: u32) {
        match (place, offset) {
            (Place::Watchdog, CTRL) => self.ctrl = word & !0x00ff_ffff,
            (Place::Watchdog, LOAD) => self.left = u64::from(word & 0x00ff_ffff),
            (Place::Watchdog, _) => {
                if let Some(scratch) = self.scratch(offset) {
                    *scratch = word;
                }
            }
            (Place::Ticks, TICK_CTRL) => self.tick_ctrl = word,
            (Place::Ticks, TICK_CYCLES) => self.tick_cycles = word,
            (Place::Stages, WDSEL) => self.stages = word,
            _ => {}
        }
    }
}

/// It with its time and its wire.
#[derive(Debug, Default)]
struct Dog {
    state: Mutex<State>,
    /// Of the state, for those who must not wait for it.
    time: Time,
    event: AtomicU64,
    wire: OnceLock<WireSource>,
}

impl Dog {
    fn publish(&self, state: &State) {
        self.time.advance_to(state.tick);
        self.event.store(state.end(), Ordering::Relaxed);
    }

    fn advance_to(&self, tick: u64) {
        let resets = {
            let mut state = locked(&self.state);
            let resets = state.count(tick);
            self.publish(&state);
            resets
        };
        if let (true, Some(wire)) = (resets, self.wire.get()) {
            wire.pulse(Level::High);
        }
    }
}

/// One of its places as the chip's bus sees it.
#[derive(Debug)]
struct Registers {
    dog: Arc<Dog>,
    place: Place,
}

impl MemOps for Registers {
    fn read(&self, offset: u64, bytes: &mut [u8], attributes: MemAttrs) -> MemResult {
        self.dog.time.sync(attributes);
        bytes.copy_from_slice(&locked(&self.dog.state).read(self.place, offset).to_le_bytes());
        Ok(())
    }

    fn write(&self, offset: u64, bytes: &[u8], attributes: MemAttrs) -> MemResult {
        self.dog.time.sync(attributes);
        let mut word = [0; 4];
        word.copy_from_slice(bytes);
        let mut state = locked(&self.dog.state);
        state.write(self.place, offset, u32::from_le_bytes(word));
        self.dog.publish(&state);
        Ok(())
    }

    fn constraints(&self) -> AccessConstraints {
        AccessConstraints::word(Width::U32, Endian::Little)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Set up as the firmware does, with 2000 us to count.
    fn started() -> State {
        let mut state = State::default();
        state.write(Place::Ticks, TICK_CYCLES, MICROSECOND);
        state.write(Place::Ticks, TICK_CTRL, 1);
        state.write(Place::Stages, WDSEL, CORE);
        state.write(Place::Watchdog, SCRATCH, 7);
        state.write(Place::Watchdog, LOAD, 2000);
        state.write(Place::Watchdog, CTRL, ENABLE);
        state
    }

    #[test]
    fn it_resets_when_it_is_not_fed_and_keeps_what_was_left_for_then() {
        let mut state = started();
        assert!(!state.count(1999));
        state.write(Place::Watchdog, LOAD, 2000);
        assert!(!state.count(3998));
        assert_eq!(state.end(), 3999);
        assert!(state.count(3999));
        assert_eq!(state.read(Place::Watchdog, REASON), COUNTED_DOWN);
        assert_eq!(state.read(Place::Watchdog, SCRATCH), 7);
        assert!(!state.count(10_000));
    }

    #[test]
    fn without_ticks_or_told_to_reset_nothing_it_does_not() {
        for (place, offset) in
            [(Place::Ticks, TICK_CTRL), (Place::Ticks, TICK_CYCLES), (Place::Stages, WDSEL)]
        {
            let mut state = started();
            state.write(place, offset, 0);
            assert!(!state.count(10_000), "{place:?}");
        }
    }
}
