//! One select of an encoder: the pauses that its datasheet prescribes, and a transfer.

use embedded_hal::delay::DelayNs;
use embedded_hal::spi::{Operation, SpiDevice};

use crate::fault::Error;

/// Pauses (ns).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pauses {
    /// Not selected, before a frame.
    pub idle: u32,
    /// From the select to the first clock edge.
    pub setup: u32,
}

impl Pauses {
    /// Time of `frames` of `bits` each at a clock (Hz), in s.
    pub(crate) const fn time(self, frames: u32, bits: u32, clock: u32) -> f32 {
        let pauses = frames * (self.idle + self.setup);
        pauses as f32 * 1e-9 + (frames * bits) as f32 / clock as f32
    }
}

/// The bus and the clock of the pauses.
#[derive(Debug)]
pub(crate) struct Bus<S, D> {
    spi: S,
    delay: D,
}

impl<S: SpiDevice, D: DelayNs> Bus<S, D> {
    pub(crate) const fn new(spi: S, delay: D) -> Self {
        Self { spi, delay }
    }

    pub(crate) fn release(self) -> (S, D) {
        (self.spi, self.delay)
    }

    /// Sends `frame` and brings back what was received in its place.
    pub(crate) fn exchange(&mut self, pauses: Pauses, frame: &mut [u8]) -> Result<(), Error<S::Error>> {
        self.delay.delay_ns(pauses.idle);
        self.spi
            .transaction(&mut [Operation::DelayNs(pauses.setup), Operation::TransferInPlace(frame)])
            .map_err(Error::Bus)
    }

    /// As [`Self::exchange`], with a pause (ns) between `command` and `reply`.
    pub(crate) fn turn_round(
        &mut self,
        pauses: Pauses,
        command: &mut [u8],
        between: u32,
        reply: &mut [u8],
    ) -> Result<(), Error<S::Error>> {
        self.delay.delay_ns(pauses.idle);
        self.spi
            .transaction(&mut [
                Operation::DelayNs(pauses.setup),
                Operation::TransferInPlace(command),
                Operation::DelayNs(between),
                Operation::TransferInPlace(reply),
            ])
            .map_err(Error::Bus)
    }
}
