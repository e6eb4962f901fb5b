//! A peripheral that is its registers, with rules for what becomes of them: control of clocks and power.

use std::sync::{Arc, Mutex};

use rsemu::core::device::{Device, DeviceClass, RealizeCtx, ResetKind, SinkPin};
use rsemu::core::space::{AccessConstraints, MemAttrs, MemOps, MemResult, Region, RegionRef};
use rsemu::core::value::{Endian, Width};
use rsemu::core::wire::{Level, WireId, WireSink};
use rsemu::machine::realize::Instance;

use crate::lock::locked;

/// Size of their place (bytes).
const SIZE: usize = 0x400;

/// The registers, by the offset of each.
#[derive(Clone, Debug)]
pub struct Words([u32; SIZE / 4]);

impl Words {
    /// Out of reset: 0 but for these.
    pub fn reset(values: &[(usize, u32)]) -> Self {
        let mut words = Self([0; SIZE / 4]);
        values.iter().for_each(|(offset, word)| words.put(*offset, *word));
        words
    }

    /// The register at an offset.
    pub fn at(&self, offset: usize) -> u32 {
        self.0[offset / 4]
    }

    /// Puts it.
    pub fn put(&mut self, offset: usize, word: u32) {
        self.0[offset / 4] = word;
    }

    /// Its bits of the mask.
    pub fn replace(&mut self, offset: usize, mask: u32, word: u32) {
        self.put(offset, self.at(offset) & !mask | word & mask);
    }
}

/// What a peripheral does.
#[derive(Debug)]
pub struct Rules {
    /// Registers that are not 0 out of reset.
    pub reset: &'static [(usize, u32)],
    /// Registers that a reset of the chip keeps, as long as it has power.
    pub kept: &'static [usize],
    /// What a word that is written to an offset changes.
    pub write: fn(&mut Words, usize, u32),
    /// Wires, each with a register and the bits of it that it sets.
    pub wires: &'static [(&'static str, usize, u32)],
}

impl Rules {
    /// The registers out of reset.
    pub fn reset(&self) -> Words {
        Words::reset(self.reset)
    }
}

/// Such a peripheral.
#[derive(Debug)]
pub struct Registers {
    class: &'static DeviceClass,
    // A wire does not keep what it ends at.
    file: Arc<File>,
}

impl Registers {
    /// Out of reset.
    pub fn new(class: &'static DeviceClass, rules: &'static Rules) -> Self {
        Self { class, file: Arc::new(File { rules, words: Mutex::new(rules.reset()) }) }
    }
}

impl Device for Registers {
    fn class(&self) -> &'static DeviceClass {
        self.class
    }

    fn realize(&self, _context: &mut RealizeCtx<'_>) -> rsemu::core::error::Result<()> {
        Ok(())
    }

    fn reset(&self, kind: ResetKind) {
        let (rules, mut words) = (self.file.rules, locked(&self.file.words));
        let before = std::mem::replace(&mut *words, rules.reset());
        if kind != ResetKind::Cold {
            rules.kept.iter().for_each(|offset| words.put(*offset, before.at(*offset)));
        }
    }

    fn region(&self, name: &str) -> Option<RegionRef> {
        let io = || Region::io(self.class.name, SIZE as u64, self.file.clone());
        name.is_empty().then(|| Arc::new(io()))
    }

    fn sink(&self, port: &str, _sources: &[WireId]) -> Option<SinkPin> {
        let line = self.file.rules.wires.iter().position(|(name, ..)| *name == port)?;
        Some(SinkPin { sink: self.file.clone(), line: line as u32 })
    }
}

impl Instance for Registers {}

/// The registers with their rules.
#[derive(Debug)]
struct File {
    rules: &'static Rules,
    words: Mutex<Words>,
}

impl MemOps for File {
    fn read(&self, offset: u64, bytes: &mut [u8], _attributes: MemAttrs) -> MemResult {
        bytes.copy_from_slice(&locked(&self.words).at(offset as usize).to_le_bytes());
        Ok(())
    }

    fn write(&self, offset: u64, bytes: &[u8], _attributes: MemAttrs) -> MemResult {
        let mut word = [0; 4];
        word.copy_from_slice(bytes);
        (self.rules.write)(&mut locked(&self.words), offset as usize, u32::from_le_bytes(word));
        Ok(())
    }

    fn constraints(&self) -> AccessConstraints {
        AccessConstraints::word(Width::U32, Endian::Little)
    }
}

impl WireSink for File {
    fn set_level(&self, _source: WireId, line: u32, level: Level) {
        if let (Some((_, offset, bits)), true) = (self.rules.wires.get(line as usize), level.is_high()) {
            locked(&self.words).replace(*offset, *bits, *bits);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    static CLASS: DeviceClass = DeviceClass {
        name: "strainwave.test",
        version: 1,
        summary: "doubles what is written",
        properties: &[],
        construct: |_| Ok(Box::new(Registers::new(&CLASS, &RULES))),
    };

    static RULES: Rules = Rules {
        reset: &[(8, 7)],
        kept: &[12],
        write: |words, offset, word| words.put(offset, 2 * word),
        wires: &[("flag", 12, 0b100)],
    };

    #[test]
    fn a_write_follows_the_rules_and_a_reset_takes_it_back_but_for_what_it_keeps() {
        let registers = Registers::new(&CLASS, &RULES);
        let read = |offset| locked(&registers.file.words).at(offset);
        assert_eq!(read(8), 7);
        registers.file.write(8, &[3, 1, 0, 0], MemAttrs::DEFAULT).unwrap();
        assert_eq!(read(8), 2 * 0x103);
        registers.file.write(12, &[1, 0, 0, 0], MemAttrs::DEFAULT).unwrap();
        registers.reset(ResetKind::Warm);
        assert_eq!([8, 12].map(read), [7, 2]);
        registers.reset(ResetKind::Cold);
        assert_eq!([8, 12].map(read), [7, 0]);
    }

    #[test]
    fn a_wire_sets_its_bits_and_leaves_them() {
        let registers = Registers::new(&CLASS, &RULES);
        let wire = WireId::new(1);
        assert!(registers.sink("other", &[wire]).is_none());
        let pin = registers.sink("flag", &[wire]).unwrap();
        for level in [Level::High, Level::Low] {
            pin.sink.set_level(wire, pin.line, level);
            assert_eq!(locked(&registers.file.words).at(12), 0b100);
        }
    }
}
