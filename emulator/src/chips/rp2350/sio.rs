//! The outputs that the core of an RP2350 switches itself (datasheet, 3.1): those of bank 0, each changed alone.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use rsemu::core::device::{Device, DeviceClass, RealizeCtx, ResetKind};
use rsemu::core::error::{Error, Result};
use rsemu::core::space::{AccessConstraints, MemAttrs, MemOps, MemResult, Region, RegionRef};
use rsemu::core::value::{Endian, Width};
use rsemu::core::wire::{Level, WireSource};
use rsemu::machine::realize::Instance;
use rsemu::machine::validate::{ClassSchema, PortDir};

use crate::lock::locked;

/// Levels, and that they are driven. Each is followed by what sets, clears and inverts it, 8 bytes apart.
const OUT: u64 = 0x10;
const ENABLE: u64 = 0x30;
/// Size of their place (bytes), and pins.
const SIZE: u64 = 0x400;
const PINS: u32 = 30;

/// Class of it in a machine's description.
pub static CLASS: DeviceClass = DeviceClass {
    name: "strainwave.rp2350-sio",
    version: 1,
    summary: "RP2350 outputs of the core",
    properties: &[],
    construct: |_| Ok(Box::new(Sio::default())),
};

/// What a description may say of it.
pub fn schema() -> ClassSchema {
    ClassSchema::new(CLASS.name).port_bank("p", PortDir::Out, PINS).region("")
}

/// Such a peripheral.
#[derive(Debug, Default)]
pub struct Sio(Arc<Port>);

impl Device for Sio {
    fn class(&self) -> &'static DeviceClass {
        &CLASS
    }

    fn realize(&self, _context: &mut RealizeCtx<'_>) -> Result<()> {
        Ok(())
    }

    fn reset(&self, _kind: ResetKind) {
        *locked(&self.0.state) = State::default();
        self.0.show();
    }

    fn region(&self, name: &str) -> Option<RegionRef> {
        let io = || Region::io(CLASS.name, SIZE, self.0.clone());
        name.is_empty().then(|| Arc::new(io()))
    }

    fn connect(&self, port: &str, source: WireSource) -> Result<()> {
        let unknown = || Error::Config { at: port.into(), message: format!("no pin of p0 to p{}", PINS - 1) };
        let pin = port.strip_prefix('p').and_then(|pin| pin.parse().ok()).ok_or_else(unknown)?;
        locked(&self.0.pins).insert(pin, source);
        self.0.show();
        Ok(())
    }

    fn announce(&self, _port: &str) {
        self.0.show();
    }
}

impl Instance for Sio {}

/// Its registers.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    out: u32,
    enable: u32,
}

impl State {
    fn write(&mut self, offset: u64, word: u32) {
        let (register, begin) = match offset {
            OUT..ENABLE => (&mut self.out, OUT),
            ENABLE..0x50 => (&mut self.enable, ENABLE),
            _ => return,
        };
        match offset - begin {
            0x0 => *register = word,
            0x8 => *register |= word,
            0x10 => *register &= !word,
            0x18 => *register ^= word,
            _ => {}
        }
    }

    /// A pin that nobody drives is pulled up: the encoder is not selected.
    fn is_high(&self, pin: u32) -> bool {
        (self.out | !self.enable) >> pin & 1 == 1
    }
}

/// It as the chip's bus sees it.
#[derive(Debug, Default)]
struct Port {
    state: Mutex<State>,
    pins: Mutex<BTreeMap<u32, WireSource>>,
}

impl Port {
    /// Puts the levels on the wires.
    fn show(&self) {
        let state = *locked(&self.state);
        let pins = locked(&self.pins).clone();
        for (pin, wire) in pins {
            wire.set(Level::from_bool(state.is_high(pin)));
        }
    }
}

impl MemOps for Port {
    fn read(&self, offset: u64, bytes: &mut [u8], _attributes: MemAttrs) -> MemResult {
        let state = locked(&self.state);
        let word = match offset {
            OUT => state.out,
            ENABLE => state.enable,
            _ => 0,
        };
        bytes.copy_from_slice(&word.to_le_bytes());
        Ok(())
    }

    fn write(&self, offset: u64, bytes: &[u8], _attributes: MemAttrs) -> MemResult {
        let mut word = [0; 4];
        word.copy_from_slice(bytes);
        locked(&self.state).write(offset, u32::from_le_bytes(word));
        self.show();
        Ok(())
    }

    fn constraints(&self) -> AccessConstraints {
        AccessConstraints::word(Width::U32, Endian::Little)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_set_cleared_and_inverted_alone() {
        let mut state = State::default();
        state.write(OUT, 0b0011);
        state.write(OUT + 0x8, 0b0100);
        state.write(OUT + 0x10, 0b0001);
        state.write(OUT + 0x18, 0b1010);
        assert_eq!((state.out, state.enable), (0b1100, 0));
    }

    #[test]
    fn a_pin_is_low_where_it_is_driven_low() {
        let mut state = State::default();
        assert!(state.is_high(17));
        state.write(ENABLE + 0x8, 1 << 17);
        assert!(!state.is_high(17));
        state.write(OUT + 0x8, 1 << 17);
        assert!(state.is_high(17));
    }
}
