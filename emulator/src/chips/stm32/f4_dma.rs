//! Stream 5 of an STM32F4's DMA2, with USART1's receiver at its channel 4 (ST RM0090, chapter 10): bytes into a ring.
//!
//! The emulator's USART has no line for a request: what the line would show is read in its registers, once in the time of a character.

use std::sync::{Arc, Mutex, OnceLock};

use rsemu::core::device::{Device, DeviceClass, RealizeCtx, ResetKind};
use rsemu::core::error::Result;
use rsemu::core::sched::{Budget, Consumed};
use rsemu::core::space::{AccessConstraints, AddressSpace, MemAttrs, MemOps, MemResult, Region, RegionRef};
use rsemu::core::value::{Endian, Width};
use rsemu::machine::realize::{BindCtx, Instance};
use rsemu::machine::validate::ClassSchema;

use crate::lock::locked;

/// Size of the registers' place (bytes), and the stream's first.
const SIZE: u64 = 0x400;
const FIRST: u64 = 0x88;
const REGISTERS: usize = 4;

/// From the USART's data register to its status, and what is in that: a byte has come.
const STATUS: u64 = 0x4;
const HAS_COME: u64 = 1 << 5;
/// From there to what it requests: its received bytes.
const REQUESTS: u64 = 0x10;
const RECEIVED: u64 = 1 << 6;

/// On, its channel, from place to place of the memory, over and over; of a byte each, from the peripheral.
const ON: u32 = 1 << 0;
const SET_UP: u32 = 4 << 25 | 1 << 10 | 1 << 8;

/// Class of it in a machine's description.
pub static CLASS: DeviceClass = DeviceClass {
    name: "strainwave.f4-dma",
    version: 1,
    summary: "STM32F4 DMA2, stream 5 for USART1",
    properties: &[],
    construct: |_| Ok(Box::new(Stream::default())),
};

/// What a description may say of it.
pub fn schema() -> ClassSchema {
    ClassSchema::new(CLASS.name).region("")
}

/// The stream.
#[derive(Debug, Default)]
pub struct Stream(Arc<Port>);

/// Its registers, and how many bytes the ring has.
#[derive(Debug, Default)]
struct State {
    control: u32,
    left: u32,
    from: u32,
    to: u32,
    length: u32,
}

impl State {
    fn register(&mut self, offset: u64) -> Option<&mut u32> {
        let registers: [_; REGISTERS] = [&mut self.control, &mut self.left, &mut self.from, &mut self.to];
        registers.into_iter().nth((offset.checked_sub(FIRST)? / 4) as usize)
    }

    fn write(&mut self, offset: u64, word: u32) {
        // While it is on, but its end, all is kept.
        if self.control & ON != 0 && offset != FIRST {
            return;
        }
        if let Some(register) = self.register(offset) {
            *register = word;
            self.length = self.left;
        }
    }

    /// Where the next byte goes, if it takes one.
    fn place(&mut self) -> Option<u64> {
        let takes = self.control == SET_UP | ON && self.left > 0;
        takes.then(|| {
            let place = self.to + self.length - self.left;
            self.left -= 1;
            if self.left == 0 {
                self.left = self.length;
            }
            place.into()
        })
    }
}

#[derive(Debug, Default)]
struct Port {
    state: Mutex<State>,
    memory: OnceLock<Arc<AddressSpace>>,
}

impl Port {
    /// Takes the byte that has come.
    fn serve(&self) -> MemResult {
        let (Some(memory), from) = (self.memory.get(), u64::from(locked(&self.state).from)) else {
            return Ok(());
        };
        if from == 0 {
            return Ok(());
        }
        let shown = |address| memory.read(address, Width::U32, MemAttrs::DEBUG);
        if shown(from - STATUS)? & HAS_COME == 0 || shown(from + REQUESTS)? & RECEIVED == 0 {
            return Ok(());
        }
        let Some(place) = locked(&self.state).place() else { return Ok(()) };
        let byte = memory.read(from, Width::U32, MemAttrs::DEFAULT)?;
        memory.write(place, Width::U8, byte & 0xff, MemAttrs::DEFAULT)
    }
}

impl MemOps for Port {
    fn read(&self, offset: u64, bytes: &mut [u8], _attributes: MemAttrs) -> MemResult {
        let word = locked(&self.state).register(offset).map_or(0, |register| *register);
        bytes.copy_from_slice(&word.to_le_bytes());
        Ok(())
    }

    fn write(&self, offset: u64, bytes: &[u8], _attributes: MemAttrs) -> MemResult {
        let mut word = [0; 4];
        word.copy_from_slice(bytes);
        locked(&self.state).write(offset, u32::from_le_bytes(word));
        Ok(())
    }

    fn constraints(&self) -> AccessConstraints {
        AccessConstraints::word(Width::U32, Endian::Little)
    }
}

impl Device for Stream {
    fn class(&self) -> &'static DeviceClass {
        &CLASS
    }

    fn realize(&self, _context: &mut RealizeCtx<'_>) -> Result<()> {
        Ok(())
    }

    fn reset(&self, _kind: ResetKind) {
        *locked(&self.0.state) = State::default();
    }

    fn region(&self, name: &str) -> Option<RegionRef> {
        let io = || Region::io(CLASS.name, SIZE, self.0.clone());
        name.is_empty().then(|| Arc::new(io()))
    }

    fn is_runnable(&self) -> bool {
        true
    }

    fn run(&self, budget: Budget) -> Consumed {
        // Where nothing answers, no byte has come.
        let _ = self.0.serve();
        Consumed::new(budget.ticks)
    }
}

impl Instance for Stream {
    fn bind(&self, context: &BindCtx<'_>) -> Result<()> {
        if let Some(space) = context.space() {
            self.0.memory.get_or_init(|| space.clone());
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set_up() -> State {
        let mut state = State::default();
        for (register, word) in [(1, 3), (2, 0x4001_1004), (3, 0x2000_0100), (0, SET_UP | ON)] {
            state.write(FIRST + 4 * register, word);
        }
        state
    }

    #[test]
    fn bytes_go_round_the_ring() {
        let mut state = set_up();
        let places: Vec<_> = (0..4).filter_map(|_| state.place()).collect();
        assert_eq!(places, [0x2000_0100, 0x2000_0101, 0x2000_0102, 0x2000_0100]);
        assert_eq!(state.left, 2);
    }

    #[test]
    fn it_keeps_what_it_was_told_while_it_is_on() {
        let mut state = set_up();
        state.write(FIRST + 12, 0);
        assert_eq!(state.to, 0x2000_0100);
        state.write(FIRST, 0);
        assert_eq!(state.place(), None);
    }
}
