//! SPI1, byte for byte (ST RM0440, chapter 39).
//!
//! Through the registers: the HAL's transfers index slices in a way that can panic, and a panic that the linker can see keeps the image
//! from linking. Nor does it give up: here a byte that does not come ends the transfer with an error.

use embedded_hal::spi::{Error, ErrorKind, ErrorType, Mode, Phase, Polarity, SpiBus};
use stm32g4xx_hal::gpio::{AF5, PA5, PA6, PA7};
use stm32g4xx_hal::pac::SPI1;
use stm32g4xx_hal::rcc::{Enable, Rcc, Reset};

/// Divider of the bus clock.
pub const DIVIDER: u32 = 16;
/// The same as the register has it.
const BAUD_RATE: u8 = DIVIDER.trailing_zeros() as u8 - 1;
/// Bits of a frame, less 1.
const BYTE: u8 = 7;

/// Polls that a byte may take: some ten times its 0.8 us.
const POLLS: u32 = 200;

/// Bytes that the FIFO holds.
const FIFO: u32 = 4;

/// A byte did not come.
#[derive(Clone, Copy, Debug)]
pub struct Missing;

impl Error for Missing {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

/// The bus, its pins taken: clock, MISO, MOSI.
pub struct Bus(SPI1);

impl Bus {
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

    fn has_come(&self) -> bool {
        self.0.sr().read().rxne().bit_is_set()
    }

    /// Sends a byte, and takes the one that comes meanwhile.
    fn exchange(&mut self, byte: u8) -> Result<u8, Missing> {
        let data = self.0.dr().as_ptr().cast::<u8>();
        // What came too late for its transfer would be taken for this byte.
        for _ in 0..FIFO {
            if !self.has_come() {
                break;
            }
            // SAFETY: as below.
            unsafe { data.read_volatile() };
        }
        // SAFETY: the data register, of which a byte is written and read where a frame has 8 bits: a word would be two frames.
        unsafe { data.write_volatile(byte) };
        let come = (0..POLLS).any(|_| self.has_come());
        // SAFETY: as above.
        if come { Ok(unsafe { data.read_volatile() }) } else { Err(Missing) }
    }
}

impl ErrorType for Bus {
    type Error = Missing;
}

impl SpiBus for Bus {
    fn read(&mut self, words: &mut [u8]) -> Result<(), Missing> {
        words.iter_mut().try_for_each(|word| self.exchange(0).map(|come| *word = come))
    }

    fn write(&mut self, words: &[u8]) -> Result<(), Missing> {
        words.iter().try_for_each(|word| self.exchange(*word).map(drop))
    }

    fn transfer(&mut self, read: &mut [u8], write: &[u8]) -> Result<(), Missing> {
        let mut sent = write.iter();
        for word in read {
            *word = self.exchange(sent.next().copied().unwrap_or_default())?;
        }
        self.write(sent.as_slice())
    }

    fn transfer_in_place(&mut self, words: &mut [u8]) -> Result<(), Missing> {
        words.iter_mut().try_for_each(|word| self.exchange(*word).map(|come| *word = come))
    }

    // Each byte has come before the next is sent.
    fn flush(&mut self) -> Result<(), Missing> {
        Ok(())
    }
}
