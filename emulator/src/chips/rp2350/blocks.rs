//! Peripherals of an RP2350 that are their registers (datasheet, 7.5, 8.1, 8.2 and 8.6): resets, clocks, crystal and PLL with rules for what
//! gets ready; the others are memory.
//!
//! Each follows its own registers alone: a PLL locks without the crystal, and what is in reset answers.

use rsemu::core::device::{DeviceClass, PropertySpec};
use rsemu::core::error::{Error, Result};
use rsemu::core::props::{Props, ValueKind};
use rsemu::machine::validate::{ClassSchema, PropSchema};

use crate::chips::registers::{Registers, Rules, Words};

/// Class of them in a machine's description.
pub static CLASS: DeviceClass = DeviceClass {
    name: "strainwave.rp2350",
    version: 1,
    summary: "RP2350 peripheral of registers",
    properties: &[PropertySpec { name: "block", kind: ValueKind::Str, required: true, summary: "which" }],
    construct: |props| Ok(Box::new(new(props)?)),
};

/// What a description may say of one.
pub fn schema() -> ClassSchema {
    ClassSchema::new(CLASS.name).prop(PropSchema::new("block", ValueKind::Str).required()).region("")
}

/// The one that the properties name, out of reset.
///
/// # Errors
/// When there is none of that name.
pub fn new(props: &Props) -> Result<Registers> {
    let mut reader = props.reader();
    let block = reader.require_str("block")?;
    reader.finish()?;
    let rules = match block {
        "resets" => &RESETS,
        "clocks" => &CLOCKS,
        "crystal" => &CRYSTAL,
        "pll" => &PLL,
        "memory" => &MEMORY,
        _ => return Err(Error::Property(format!("property `block`: {block} is unknown"))),
    };
    Ok(Registers::new(&CLASS, rules))
}

static MEMORY: Rules = Rules { reset: &[], kept: &[], write: Words::put, wires: &[] };

/// What is in reset; what is not.
const RESET: usize = 0x0;
const RESET_DONE: usize = 0x8;
/// All that can be reset.
const ALL: u32 = 0x1fff_ffff;

static RESETS: Rules = Rules {
    reset: &[(RESET, ALL)],
    kept: &[],
    write: |words, offset, word| match offset {
        RESET_DONE => {}
        RESET => {
            words.put(RESET, word & ALL);
            words.put(RESET_DONE, !word & ALL);
        }
        _ => words.put(offset, word),
    },
    wires: &[],
};

/// Control of the reference's and of the system's clock, and what each has selected.
const REFERENCE: (usize, usize) = (0x30, 0x38);
const SYSTEM: (usize, usize) = (0x3c, 0x44);

static CLOCKS: Rules = Rules {
    reset: &[(REFERENCE.1, 1), (SYSTEM.1, 1)],
    kept: &[],
    write: |words, offset, word| {
        if ![REFERENCE.1, SYSTEM.1].contains(&offset) {
            words.put(offset, word);
        }
        words.put(REFERENCE.1, 1 << (words.at(REFERENCE.0) & 0b11));
        words.put(SYSTEM.1, 1 << (words.at(SYSTEM.0) & 0b1));
    },
    wires: &[],
};

/// Control and status of the crystal's oscillator.
const CONTROL: usize = 0x0;
const STATUS: usize = 0x4;
/// In the control: on, for 1 to 15 MHz.
const ON: u32 = 0xfab << 12 | 0xaa0;
/// In the status: on and stable.
const STABLE: u32 = 1 << 31 | 1 << 12;

static CRYSTAL: Rules = Rules {
    reset: &[],
    // The watchdog resets all but the oscillators.
    kept: &[CONTROL, STATUS],
    write: |words, offset, word| {
        if offset != STATUS {
            words.put(offset, word);
        }
        words.put(STATUS, if words.at(CONTROL) == ON { STABLE } else { 0 });
    },
    wires: &[],
};

/// Control and status of the PLL; power; factor; divisors of its output.
const CS: usize = 0x0;
const PWR: usize = 0x4;
const FBDIV: usize = 0x8;
const PRIM: usize = 0xc;
/// In the status.
const LOCK: u32 = 1 << 31;
/// In the power: the PLL and its oscillator are off.
const OFF: u32 = 1 << 0 | 1 << 5;
/// The crystal, and the range of the oscillator [MHz].
const CRYSTAL_MHZ: u32 = 12;
const OSCILLATOR: std::ops::RangeInclusive<u32> = 750..=1600;

static PLL: Rules = Rules {
    reset: &[(CS, 1), (PWR, 0x2d), (PRIM, 0x0007_7000)],
    kept: &[],
    write: |words, offset, word| {
        words.put(offset, word);
        let divisor = (words.at(CS) & 0x3f).max(1);
        let locks =
            words.at(PWR) & OFF == 0 && OSCILLATOR.contains(&(CRYSTAL_MHZ * words.at(FBDIV) / divisor));
        words.replace(CS, LOCK, if locks { LOCK } else { 0 });
    },
    wires: &[],
};

#[cfg(test)]
mod tests {
    use super::*;

    /// The registers of `rules` after some writes.
    fn after(rules: &Rules, writes: &[(usize, u32)]) -> Words {
        let mut words = rules.reset();
        writes.iter().for_each(|(offset, word)| (rules.write)(&mut words, *offset, *word));
        words
    }

    #[test]
    fn what_is_out_of_reset_says_so() {
        assert_eq!(after(&RESETS, &[(RESET, ALL & !0b101)]).at(RESET_DONE), 0b101);
        assert_eq!(after(&RESETS, &[]).at(RESET_DONE), 0);
    }

    #[test]
    fn a_clock_tells_its_source() {
        let words = after(&CLOCKS, &[(REFERENCE.0, 2), (SYSTEM.0, 1), (SYSTEM.1, 0xff)]);
        assert_eq!((words.at(REFERENCE.1), words.at(SYSTEM.1)), (0b100, 0b10));
    }

    #[test]
    fn the_crystal_starts_in_its_range_alone() {
        assert_eq!(after(&CRYSTAL, &[(CONTROL, ON)]).at(STATUS), STABLE);
        assert_eq!(after(&CRYSTAL, &[(CONTROL, 0xfab << 12 | 0xaa3)]).at(STATUS), 0);
    }

    #[test]
    fn the_pll_locks_where_it_is_on_and_in_its_range() {
        let locked = |power, factor| after(&PLL, &[(FBDIV, factor), (PWR, power)]).at(CS) & LOCK != 0;
        assert!(locked(1 << 3, 125));
        assert!(!locked(0x2d, 125));
        assert!(!locked(0, 134));
        assert!(!locked(0, 62));
    }
}
