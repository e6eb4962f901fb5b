//! SPI of an RP2350, a PL022 (datasheet, 12.3) as a master of bytes in Motorola's format.
//!
//! Interrupts, DMA and other formats are not there.

use rsemu::bus::spi::{BitOrder, Format};
use rsemu::core::device::DeviceClass;
use rsemu::core::error::Result;
use rsemu::core::props::Props;

use crate::chips::spi_master::{Controller, Master, PROPERTIES, mode};

const CR0: u64 = 0x00;
const CR1: u64 = 0x04;
const DR: u64 = 0x08;
const SR: u64 = 0x0c;
const CPSR: u64 = 0x10;

/// In `CR0`: the format of the frames, and the order and clock of the bits.
const FORMAT: u32 = 0b11 << 4;
const IDLE_HIGH: u32 = 1 << 6;
const SECOND_EDGE: u32 = 1 << 7;
/// In `CR1`: on; no master.
const ON: u32 = 1 << 1;
const SLAVE: u32 = 1 << 2;

/// Class of it in a machine's description.
pub static CLASS: DeviceClass = DeviceClass {
    name: "strainwave.rp2350-spi",
    version: 1,
    summary: "RP2350 SPI, a master of bytes",
    properties: PROPERTIES,
    construct: |props| Ok(Box::new(new(props)?)),
};

/// One, of its properties.
///
/// # Errors
/// Without a bus.
pub fn new(props: &Props) -> Result<Master<Pl022>> {
    Master::new(&CLASS, props)
}

/// Its registers.
#[derive(Debug)]
pub struct Pl022 {
    cr0: u32,
    cr1: u32,
    cpsr: u32,
}

impl Controller for Pl022 {
    const RESET: Self = Self { cr0: 0, cr1: 0, cpsr: 0 };
    const SENT: u64 = DR;
    const COME: u64 = DR;
    const STATUS: u64 = SR;
    const HAS_COME: u32 = 1 << 2;
    const HAS_ROOM: u32 = 1 << 1;
    const FIFO: usize = 8;
    const BYTEWISE: bool = false;

    fn write(&mut self, offset: u64, word: u32) {
        match offset {
            CR0 => self.cr0 = word,
            CR1 => self.cr1 = word,
            CPSR => self.cpsr = word & 0xfe,
            _ => {}
        }
    }

    fn read(&self, offset: u64) -> u32 {
        match offset {
            CR0 => self.cr0,
            CR1 => self.cr1,
            CPSR => self.cpsr,
            _ => 0,
        }
    }

    fn format(&self) -> Format {
        let mode = mode(self.cr0 & IDLE_HIGH != 0, self.cr0 & SECOND_EDGE != 0);
        Format::new(mode, (self.cr0 & 0xf) as u8 + 1, BitOrder::MsbFirst)
    }

    fn bit(&self) -> u64 {
        u64::from(self.cpsr) * u64::from((self.cr0 >> 8 & 0xff) + 1)
    }

    fn sends(&self) -> bool {
        self.cr1 & (ON | SLAVE) == ON && self.cr0 & FORMAT == 0 && self.cpsr >= 2
    }
}

#[cfg(test)]
mod tests {
    use rsemu::core::device::Device;

    use super::*;

    /// As the firmware sets it up: bytes, in a mode.
    const USUAL: u32 = 7 | IDLE_HIGH | SECOND_EDGE;

    /// 12 clocks a bit.
    fn spi(cr0: u32, cr1: u32) -> Master<Pl022> {
        Master::set_up(&CLASS, &[(CPSR, 12), (CR0, cr0), (CR1, cr1)])
    }

    fn word(byte: u8) -> [u8; 4] {
        u32::from(byte).to_le_bytes()
    }

    #[test]
    fn bytes_come_after_their_time_one_by_one() {
        let spi = spi(USUAL, ON);
        spi.send(word(0x12));
        spi.send(word(0x34));
        spi.advance_to(95);
        assert!(!spi.has_come());
        spi.advance_to(96);
        assert!(spi.has_come());
        assert_eq!(spi.take(), word(!0x12));
        assert!(!spi.has_come());
        spi.advance_to(192);
        assert_eq!(spi.take(), word(!0x34));
    }

    #[test]
    fn in_another_mode_nothing_is_understood() {
        let spi = spi(7 | IDLE_HIGH, ON);
        spi.send(word(0x12));
        spi.advance_to(96);
        assert_eq!(spi.take(), word(0xff));
    }

    #[test]
    fn what_is_off_a_slave_or_in_another_format_sends_nothing() {
        for (cr0, cr1) in [(USUAL, 0), (USUAL, ON | SLAVE), (USUAL | 1 << 4, ON)] {
            let spi = spi(cr0, cr1);
            spi.send(word(0x12));
            spi.advance_to(96);
            assert!(!spi.has_come(), "{cr0:x} {cr1:x}");
        }
    }
}
