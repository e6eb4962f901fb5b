//! What the tests of all drivers share: a bus on which frames are expected, one on which nothing works, and CAN frames.

use embedded_can::{Frame, Id, StandardId};
use embedded_hal::spi::{ErrorKind, ErrorType, Operation, SpiDevice};
use embedded_hal_mock::eh1::delay::NoopDelay;
use embedded_hal_mock::eh1::spi::{Mock, Transaction};
use std::vec::Vec;

use crate::bus::Pauses;

/// The clock of the pauses in tests.
pub(crate) type Delay = NoopDelay;

/// The bus in tests.
pub(crate) type Spi = Mock<u8>;

/// A bus and its clock; expected are frames, each with what is sent and what is received.
pub(crate) fn bus<T: AsRef<[u8]>>(pauses: Pauses, frames: &[(T, T)]) -> (Spi, Delay) {
    let expected: Vec<_> = frames
        .iter()
        .flat_map(|(sent, received)| {
            [
                Transaction::transaction_start(),
                Transaction::delay(pauses.setup),
                Transaction::transfer_in_place(sent.as_ref().to_vec(), received.as_ref().to_vec()),
                Transaction::transaction_end(),
            ]
        })
        .collect();
    (Mock::new(&expected), NoopDelay::new())
}

/// Every expected frame was exchanged.
pub(crate) fn done((mut spi, _): (Spi, Delay)) {
    spi.done();
}

/// A bus on which nothing works: the mock has no errors.
#[derive(Debug)]
pub(crate) struct DeadBus;

impl ErrorType for DeadBus {
    type Error = ErrorKind;
}

impl SpiDevice for DeadBus {
    fn transaction(&mut self, _: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        Err(ErrorKind::Overrun)
    }
}

/// A bus that answers every transfer with the same bytes, over and over.
#[derive(Debug)]
pub(crate) struct Echo<'a>(pub(crate) &'a [u8]);

impl ErrorType for Echo<'_> {
    type Error = ErrorKind;
}

impl SpiDevice for Echo<'_> {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        let mut reply = self.0.iter().cycle();
        for operation in operations {
            if let Operation::TransferInPlace(bytes) = operation {
                bytes.fill_with(|| *reply.next().unwrap_or(&0));
            }
        }
        Ok(())
    }
}

/// Every frame that differs from this one in a single bit.
pub(crate) fn flipped<const N: usize>(frame: [u8; N]) -> impl Iterator<Item = [u8; N]> {
    (0..8 * N).map(move |bit| {
        let mut other = frame;
        other[bit / 8] ^= 0x80 >> (bit % 8);
        other
    })
}

/// A classic CAN frame.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sent(pub(crate) Id, pub(crate) Vec<u8>);

impl Frame for Sent {
    fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
        Some(Self(id.into(), data.to_vec()))
    }

    fn new_remote(_: impl Into<Id>, _: usize) -> Option<Self> {
        None
    }

    fn is_extended(&self) -> bool {
        matches!(self.0, Id::Extended(_))
    }

    fn is_remote_frame(&self) -> bool {
        false
    }

    fn id(&self) -> Id {
        self.0
    }

    fn dlc(&self) -> usize {
        self.1.len()
    }

    fn data(&self) -> &[u8] {
        &self.1
    }
}

/// A frame with an 11-bit identifier.
pub(crate) fn frame(id: u16, data: &[u8]) -> Sent {
    Sent::new(StandardId::new(id).unwrap(), data).unwrap()
}
