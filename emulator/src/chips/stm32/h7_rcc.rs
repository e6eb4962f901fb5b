//! Reset and clock control of an STM32H7 (ST RM0433, chapter 8): clocks that get ready, and the causes of a reset.
//!
//! The PLL locks where its input and its oscillator are in the ranges that it is set up for. All else is its registers alone.

use rsemu::core::device::DeviceClass;
use rsemu::machine::validate::{ClassSchema, PortDir};

use crate::chips::registers::{Registers, Rules, Words};

/// Source control; selection of the core's clock.
const CR: usize = 0x00;
const CFGR: usize = 0x10;
/// Source of the PLLs and divisors of their inputs; their ranges; factors of the first.
const PLLCKSELR: usize = 0x28;
const PLLCFGR: usize = 0x2c;
const PLL1DIVR: usize = 0x30;
/// Causes of a reset.
const RSR: usize = 0xd0;

/// In `CR`: on and ready, of the internal clock, the external one and the PLL.
const HSI: (u32, u32) = (1 << 0, 1 << 2);
const HSE: (u32, u32) = (1 << 16, 1 << 17);
const PLL1: (u32, u32) = (1 << 24, 1 << 25);
/// In `CFGR`: the clock that is selected, and from here the one that is in use.
const SELECTED: u32 = 0b111;
const IN_USE: u32 = 3;
/// In `PLLCKSELR`: the external clock.
const FROM_HSE: u32 = 2;
/// In `RSR`: clears the causes; that of the watchdog; those of power-on.
const CLEAR: u32 = 1 << 16;
const WATCHDOG: u32 = 1 << 26;
const POWER_ON: u32 = 1 << 17 | 1 << 19 | 1 << 20 | 1 << 21 | 1 << 22 | 1 << 23;

/// The external clock of the board [MHz].
const HSE_MHZ: u32 = 8;
/// The PLL's oscillator [MHz].
const OSCILLATOR: std::ops::RangeInclusive<u32> = 192..=836;

/// Class of it in a machine's description.
pub static CLASS: DeviceClass = DeviceClass {
    name: "strainwave.h7-rcc",
    version: 1,
    summary: "STM32H7 reset and clock control",
    properties: &[],
    construct: |_| Ok(Box::new(new())),
};

/// What a description may say of it.
pub fn schema() -> ClassSchema {
    ClassSchema::new(CLASS.name).port("iwdgrst", PortDir::In).region("")
}

/// It, out of reset.
pub fn new() -> Registers {
    Registers::new(&CLASS, &RULES)
}

static RULES: Rules = Rules {
    reset: &[
        (CR, HSI.0 | HSI.1),
        (PLLCKSELR, 0x0202_0200),
        (PLLCFGR, 0x01ff_0000),
        (PLL1DIVR, 0x0101_0280),
        (RSR, POWER_ON),
    ],
    kept: &[RSR],
    write,
    wires: &[("iwdgrst", RSR, WATCHDOG)],
};

fn write(words: &mut Words, offset: usize, word: u32) {
    match offset {
        CR => words.put(CR, word & !(HSI.1 | HSE.1 | PLL1.1)),
        CFGR => words.replace(CFGR, !(SELECTED << IN_USE), word),
        RSR if word & CLEAR != 0 => words.put(RSR, 0),
        RSR => {}
        _ => words.put(offset, word),
    }
    settle(words);
}

/// Whatever is on gets ready, and what is selected gets into use.
fn settle(words: &mut Words) {
    for (on, ready) in [HSI, HSE] {
        if words.at(CR) & on != 0 {
            words.replace(CR, ready, ready);
        }
    }
    if words.at(CR) & PLL1.0 != 0 && locks(words) {
        words.replace(CR, PLL1.1, PLL1.1);
    }
    let selected = words.at(CFGR) & SELECTED;
    let ready = match selected {
        0 => HSI.1,
        2 => HSE.1,
        3 => PLL1.1,
        _ => 0,
    };
    if words.at(CR) & ready != 0 {
        words.replace(CFGR, SELECTED << IN_USE, selected << IN_USE);
    }
}

fn locks(words: &Words) -> bool {
    let (input, range) = (words.at(PLLCKSELR), words.at(PLLCFGR) >> 2 & 0b11);
    let divisor = input >> 4 & 0x3f;
    let times = (words.at(PLL1DIVR) & 0x1ff) + 1;
    // From 1, 2, 4 or 8 MHz to twice as much.
    let (least, most) = ((1 << range) * divisor, (2 << range) * divisor);
    words.at(CR) & HSE.1 != 0
        && input & 0b11 == FROM_HSE
        && (least..=most).contains(&HSE_MHZ)
        && divisor != 0
        && OSCILLATOR.contains(&(HSE_MHZ * times / divisor))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The PLL from the external clock: / `divisor`, * `times`, with the range of its input.
    fn started(divisor: u32, times: u32, range: u32) -> Words {
        let mut words = RULES.reset();
        write(&mut words, CR, HSI.0 | HSE.0);
        write(&mut words, PLLCKSELR, FROM_HSE | divisor << 4);
        write(&mut words, PLLCFGR, range << 2);
        write(&mut words, PLL1DIVR, times - 1);
        write(&mut words, CR, HSI.0 | HSE.0 | PLL1.0);
        write(&mut words, CFGR, 3);
        words
    }

    #[test]
    fn the_core_runs_from_a_pll_that_locks() {
        let words = started(2, 200, 0b10);
        assert_eq!(words.at(CR) & (HSE.1 | PLL1.1), HSE.1 | PLL1.1);
        assert_eq!(words.at(CFGR), 0b011_011);
    }

    #[test]
    fn a_pll_out_of_its_ranges_does_not_lock() {
        for (divisor, times, range) in [(1, 100, 0b01), (2, 210, 0b10), (8, 191, 0b00), (0, 100, 0b11)] {
            let words = started(divisor, times, range);
            assert_eq!(words.at(CR) & PLL1.1, 0, "{divisor} {times} {range}");
            assert_eq!(words.at(CFGR), 0b000_011);
        }
    }

    #[test]
    fn causes_stay_until_they_are_cleared() {
        let mut words = RULES.reset();
        write(&mut words, RSR, 0);
        assert_eq!(words.at(RSR), POWER_ON);
        write(&mut words, RSR, POWER_ON | CLEAR);
        assert_eq!(words.at(RSR), 0);
    }
}
