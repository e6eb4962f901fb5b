//! SPI1 (ST RM0433, chapter 50).

use embedded_hal::spi::{Mode, Phase, Polarity};
use stm32h7::stm32h743v::SPI1;
use strainwave_controller::spi::Port;

/// Divider of the clock that the PLL gives it.
pub const DIVIDER: u32 = 8;
/// The same as the register has it.
const BAUD_RATE: u8 = DIVIDER.trailing_zeros() as u8 - 1;
/// Bits of a frame, less 1.
const BYTE: u8 = 7;

/// The peripheral; its pins are set up.
pub struct Spi(SPI1);

impl Spi {
    /// Switched on, as master.
    pub fn new(spi: SPI1, mode: Mode) -> Self {
        // Before it is a master: nobody else selects it, which would end that.
        spi.cr1().write(|w| w.ssi().slave_not_selected());
        // A byte in the FIFO counts as received.
        spi.cfg1().write(|w| w.dsize().set(BYTE).fthlv().one_frame().mbr().set(BAUD_RATE));
        spi.cfg2().write(|w| {
            w.cpol().bit(mode.polarity == Polarity::IdleHigh);
            w.cpha().bit(mode.phase == Phase::CaptureOnSecondTransition);
            // The clock's line is driven while the peripheral is off, too.
            w.master().master().ssm().enabled().afcntr().controlled()
        });
        spi.cr1().modify(|_, w| w.spe().enabled());
        // One transfer without an end, which pauses while there is nothing to send.
        spi.cr1().modify(|_, w| w.cstart().started());
        Self(spi)
    }
}

impl Port for Spi {
    const FIFO: u32 = 16;
    // At least some ten times the 0.64 us of a byte.
    const POLLS: u32 = 500;

    fn send(&mut self, byte: u8) {
        // An access of a byte: a word would be four.
        self.0.txdr8().write(|w| w.txdr().set(byte));
    }

    fn take(&mut self) -> Option<u8> {
        let has_come = self.0.sr().read().rxp().bit_is_set();
        has_come.then(|| self.0.rxdr8().read().rxdr().bits())
    }
}
