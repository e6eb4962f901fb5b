//! SPI0 (RP2350 datasheet, 12.3).

use embedded_hal::spi::{Mode, Phase, Polarity};
use rp235x_pac::SPI0;
use strainwave_controller::spi::Port;

/// Divider of the peripheral's clock: even.
pub const DIVIDER: u8 = 12;
/// Bits of a frame, less 1.
const BYTE: u8 = 7;

/// The peripheral; its pins are set up.
pub struct Spi(SPI0);

impl Spi {
    /// Switched on, as master.
    pub fn new(spi: SPI0, mode: Mode) -> Self {
        // SAFETY: the divider is even and at least 2.
        spi.sspcpsr().write(|w| unsafe { w.cpsdvsr().bits(DIVIDER) });
        spi.sspcr0().write(|w| {
            w.spo().bit(mode.polarity == Polarity::IdleHigh);
            w.sph().bit(mode.phase == Phase::CaptureOnSecondTransition);
            // SAFETY: a number of bits that a frame may have.
            unsafe { w.dss().bits(BYTE) }
        });
        spi.sspcr1().write(|w| w.sse().set_bit());
        Self(spi)
    }
}

impl Port for Spi {
    const FIFO: u32 = 8;
    // At least some ten times the 0.64 us of a byte.
    const POLLS: u32 = 200;

    fn send(&mut self, byte: u8) {
        // SAFETY: the register takes any byte.
        self.0.sspdr().write(|w| unsafe { w.data().bits(u16::from(byte)) });
    }

    fn take(&mut self) -> Option<u8> {
        let has_come = self.0.sspsr().read().rne().bit_is_set();
        has_come.then(|| self.0.sspdr().read().data().bits() as u8)
    }
}
