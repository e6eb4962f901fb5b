//! Power control of an STM32H7 (ST RM0433, chapter 6): the choice of the supply, which is taken once, and the voltage for the core.

use rsemu::core::device::DeviceClass;
use rsemu::machine::validate::ClassSchema;

use crate::chips::registers::{Registers, Rules, Words};

/// Status; supply; voltage.
const CSR1: usize = 0x04;
const CR3: usize = 0x0c;
const D3CR: usize = 0x18;

/// In `CSR1` that the voltage in use, in `D3CR` that the one asked for is reached.
const READY: u32 = 1 << 13;
/// In `CR3`: the supply.
const SUPPLY: u32 = 0xff;
/// In `D3CR` and `CSR1`: the lowest voltage.
const SCALE_3: u32 = 0b01 << 14;

/// Class of it in a machine's description.
pub static CLASS: DeviceClass = DeviceClass {
    name: "strainwave.h7-pwr",
    version: 1,
    summary: "STM32H7 power control",
    properties: &[],
    construct: |_| Ok(Box::new(new())),
};

/// What a description may say of it.
pub fn schema() -> ClassSchema {
    ClassSchema::new(CLASS.name).region("")
}

/// It, out of reset.
pub fn new() -> Registers {
    Registers::new(&CLASS, &RULES)
}

static RULES: Rules =
    Rules { reset: &[(CSR1, SCALE_3), (CR3, 0b110), (D3CR, SCALE_3)], kept: &[], write, wires: &[] };

fn write(words: &mut Words, offset: usize, word: u32) {
    let supplied = words.at(CSR1) & READY != 0;
    match offset {
        CSR1 => {}
        CR3 if supplied => words.replace(CR3, !SUPPLY, word),
        CR3 => {
            words.put(CR3, word);
            words.replace(CSR1, READY, READY);
        }
        // Before that the voltage cannot be changed.
        D3CR if supplied => words.put(D3CR, word | READY),
        D3CR => {}
        _ => words.put(offset, word),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_voltage_is_taken_after_the_supply() {
        let mut words = RULES.reset();
        write(&mut words, D3CR, 0b11 << 14);
        assert_eq!(words.at(D3CR), SCALE_3);
        write(&mut words, CR3, 0b010);
        assert_eq!(words.at(CSR1), SCALE_3 | READY);
        write(&mut words, D3CR, 0b11 << 14);
        assert_eq!(words.at(D3CR), 0b11 << 14 | READY);
    }

    #[test]
    fn the_supply_is_taken_once() {
        let mut words = RULES.reset();
        write(&mut words, CR3, 0b010);
        write(&mut words, CR3, 0x100 | 0b001);
        assert_eq!(words.at(CR3), 0x100 | 0b010);
    }
}
