//! SPI of an STM32H7 (ST RM0433, chapter 50) as a master: one transfer without an end, frames of a byte.
//!
//! Interrupts, DMA, CRC and transfers of a given length are not there.

use rsemu::bus::spi::{BitOrder, Format};
use rsemu::core::device::DeviceClass;
use rsemu::core::error::Result;
use rsemu::core::props::Props;

use crate::chips::spi_master::{Controller, Master, PROPERTIES, mode};

const CR1: u64 = 0x00;
const CFG1: u64 = 0x08;
const CFG2: u64 = 0x0c;
const SR: u64 = 0x14;
const TXDR: u64 = 0x20;
const RXDR: u64 = 0x30;

/// In `CR1`: on; the transfer is started; nobody else selects it.
const ON: u32 = 1 << 0;
const STARTED: u32 = 1 << 9;
const NOT_SELECTED: u32 = 1 << 12;
/// In `CFG2`: master, and the order and clock of the bits.
const MASTER: u32 = 1 << 22;
const LEAST_FIRST: u32 = 1 << 23;
const SECOND_EDGE: u32 = 1 << 24;
const IDLE_HIGH: u32 = 1 << 25;
/// `CFG1` out of reset.
const CFG1_RESET: u32 = 0x0007_0007;

/// Class of it in a machine's description.
pub static CLASS: DeviceClass = DeviceClass {
    name: "strainwave.h7-spi",
    version: 1,
    summary: "STM32H7 SPI, a master of bytes",
    properties: PROPERTIES,
    construct: |props| Ok(Box::new(new(props)?)),
};

/// One, of its properties.
///
/// # Errors
/// Without a bus.
pub fn new(props: &Props) -> Result<Master<H7Spi>> {
    Master::new(&CLASS, props)
}

/// Its registers.
#[derive(Debug)]
pub struct H7Spi {
    cr1: u32,
    cfg1: u32,
    cfg2: u32,
}

impl Controller for H7Spi {
    const RESET: Self = Self { cr1: 0, cfg1: CFG1_RESET, cfg2: 0 };
    const SENT: u64 = TXDR;
    const COME: u64 = RXDR;
    const STATUS: u64 = SR;
    const HAS_COME: u32 = 1 << 0;
    const HAS_ROOM: u32 = 1 << 1;
    const FIFO: usize = 16;
    const BYTEWISE: bool = true;

    fn write(&mut self, offset: u64, word: u32) {
        let on = self.cr1 & ON != 0;
        match offset {
            // The start is taken when it is on already.
            CR1 => self.cr1 = if on { word } else { word & !STARTED },
            CFG1 if !on => self.cfg1 = word,
            // It ceases to be a master when somebody else selects it.
            CFG2 if !on && self.cr1 & NOT_SELECTED == 0 => self.cfg2 = word & !MASTER,
            CFG2 if !on => self.cfg2 = word,
            _ => {}
        }
    }

    fn read(&self, offset: u64) -> u32 {
        match offset {
            CR1 => self.cr1,
            CFG1 => self.cfg1,
            CFG2 => self.cfg2,
            _ => 0,
        }
    }

    fn format(&self) -> Format {
        let mode = mode(self.cfg2 & IDLE_HIGH != 0, self.cfg2 & SECOND_EDGE != 0);
        let order = if self.cfg2 & LEAST_FIRST != 0 { BitOrder::LsbFirst } else { BitOrder::MsbFirst };
        Format::new(mode, (self.cfg1 & 0x1f) as u8 + 1, order)
    }

    fn bit(&self) -> u64 {
        2 << (self.cfg1 >> 28 & 0b111)
    }

    fn sends(&self) -> bool {
        self.cr1 & (ON | STARTED) == ON | STARTED && self.cfg2 & MASTER != 0
    }

    fn drops(&self) -> bool {
        self.cr1 & ON == 0
    }
}

#[cfg(test)]
mod tests {
    use rsemu::core::device::Device;

    use super::*;

    /// In a mode, `cr1` written before and after it is set up; eight clocks a bit.
    fn spi(mode: u32, [before, on, started]: [u32; 3]) -> Master<H7Spi> {
        let (clock, order) = ((CFG1, CFG1_RESET | 0b010 << 28), (CFG2, MASTER | mode));
        Master::set_up(&CLASS, &[(CR1, before), clock, order, (CR1, on), (CR1, started)])
    }

    /// As the firmware sets it up.
    const USUAL: [u32; 3] = [NOT_SELECTED, NOT_SELECTED | ON, NOT_SELECTED | ON | STARTED];

    #[test]
    fn bytes_come_after_their_time_one_by_one() {
        let spi = spi(IDLE_HIGH | SECOND_EDGE, USUAL);
        spi.send([0x12]);
        spi.send([0x34]);
        spi.advance_to(63);
        assert!(!spi.has_come());
        spi.advance_to(64);
        assert!(spi.has_come());
        assert_eq!(spi.take(), [!0x12]);
        assert!(!spi.has_come());
        spi.advance_to(128);
        assert_eq!(spi.take(), [!0x34]);
    }

    #[test]
    fn a_word_is_four_bytes() {
        let spi = spi(IDLE_HIGH | SECOND_EDGE, USUAL);
        spi.send([1, 2, 3, 4]);
        spi.advance_to(4 * 64);
        assert_eq!(spi.take(), [!1, !2, !3, !4]);
    }

    #[test]
    fn in_another_mode_nothing_is_understood() {
        let spi = spi(IDLE_HIGH, USUAL);
        spi.send([0x12]);
        spi.advance_to(64);
        assert_eq!(spi.take(), [0xff]);
    }

    #[test]
    fn what_is_off_not_started_or_selected_sends_nothing() {
        let all = NOT_SELECTED | ON | STARTED;
        for cr1 in [[NOT_SELECTED; 3], [NOT_SELECTED, all, NOT_SELECTED | ON], [0, ON, all], [ON, all, all]] {
            let spi = spi(IDLE_HIGH | SECOND_EDGE, cr1);
            spi.send([0x12]);
            spi.advance_to(64);
            assert!(!spi.has_come(), "{cr1:x?}");
        }
    }
}
