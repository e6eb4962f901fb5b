//! SPI1 (ST RM0440, chapter 39).

use embedded_hal::spi::{Mode, Phase, Polarity};
use stm32g4xx_hal::gpio::{AF5, PA5, PA6, PA7};
use stm32g4xx_hal::pac::SPI1;
use stm32g4xx_hal::rcc::{Enable, Rcc, Reset};
use strainwave_controller::spi::Port;

/// Divider of the bus clock.
pub const DIVIDER: u32 = 16;
/// The same as the register has it.
const BAUD_RATE: u8 = DIVIDER.trailing_zeros() as u8 - 1;
/// Bits of a frame, less 1.
const BYTE: u8 = 7;

/// The peripheral, its pins taken: clock, MISO, MOSI.
pub struct Spi(SPI1);

impl Spi {
    /// Switched on, as master.
    pub fn new(spi: SPI1, _pins: (PA5<AF5>, PA6<AF5>, PA7<AF5>), mode: Mode, rcc: &mut Rcc) -> Self {
        SPI1::enable(rcc);
        SPI1::reset(rcc);
        // A byte in the FIFO counts as received.
        // SAFETY: frames of 8 bits are allowed.
        spi.cr2().write(|w| unsafe { w.ds().bits(BYTE).frxth().set_bit() });
        spi.cr1().write(|w| {
            w.cpol().bit(mode.polarity == Polarity::IdleHigh);
            w.cpha().bit(mode.phase == Phase::CaptureOnSecondTransition);
            w.mstr().set_bit().ssm().set_bit().ssi().set_bit();
            // SAFETY: any divider is allowed.
            unsafe { w.br().bits(BAUD_RATE) }.spe().set_bit()
        });
        Self(spi)
    }

    /// The data register, of which a byte is written and read where a frame has 8 bits: a word would be two frames.
    fn data(&self) -> *mut u8 {
        self.0.dr().as_ptr().cast()
    }
}

impl Port for Spi {
    const FIFO: u32 = 4;
    // Some ten times the 0.8 us of a byte.
    const POLLS: u32 = 200;

    fn send(&mut self, byte: u8) {
        // SAFETY: the register takes any byte.
        unsafe { self.data().write_volatile(byte) };
    }

    fn take(&mut self) -> Option<u8> {
        let has_come = self.0.sr().read().rxne().bit_is_set();
        // SAFETY: a byte has come.
        has_come.then(|| unsafe { self.data().read_volatile() })
    }
}
