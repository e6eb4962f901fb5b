//! An SPI bus, byte for byte, through the registers of its peripheral.
//!
//! The HALs' transfers index slices in a way that can panic, and a panic that the linker can see keeps the image from linking. Nor do
//! they give up: here a byte that does not come ends the transfer with an error.

use embedded_hal::spi::{Error, ErrorKind, ErrorType, SpiBus};

/// A peripheral as the bus sees it, switched on as master.
pub trait Port {
    /// Bytes that it holds of those received.
    const FIFO: u32;
    /// Polls that a byte may take.
    const POLLS: u32;

    /// Begins to send a byte; one comes meanwhile.
    fn send(&mut self, byte: u8);
    /// The byte that has come.
    fn take(&mut self) -> Option<u8>;
}

/// A byte did not come.
#[derive(Clone, Copy, Debug)]
pub struct Missing;

impl Error for Missing {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

/// The bus.
pub struct Bus<P>(P);

impl<P: Port> Bus<P> {
    /// On its peripheral.
    pub fn new(port: P) -> Self {
        Self(port)
    }

    /// Sends a byte, and takes the one that comes meanwhile.
    fn exchange(&mut self, byte: u8) -> Result<u8, Missing> {
        // What came too late for its transfer would be taken for this byte.
        for _ in 0..P::FIFO {
            if self.0.take().is_none() {
                break;
            }
        }
        self.0.send(byte);
        (0..P::POLLS).find_map(|_| self.0.take()).ok_or(Missing)
    }
}

impl<P> ErrorType for Bus<P> {
    type Error = Missing;
}

impl<P: Port> SpiBus for Bus<P> {
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
