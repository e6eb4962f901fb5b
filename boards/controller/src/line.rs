//! The serial port under the tuning link: bytes in and out, neither of which waits.
//!
//! The idle loop looks at least once in a control period, in which 9 bytes come at 921600 Bd; the control's interrupt may hold it and the
//! port's own interrupt up for 20 us, in which two come. So a byte waits in the port's FIFO or its DMA buffer until it is taken, and
//! in a queue until the link wants it. A host sends a request of at most 19 bytes, and the next one when it has been answered.

use core::convert::Infallible;
use embedded_hal_nb::nb;
use embedded_hal_nb::serial::{ErrorType, Read, Write};
use heapless::mpmc::Q64;

/// A serial port as the idle loop sees it.
pub trait Line {
    /// The next byte that has come.
    fn take(&mut self) -> Option<u8>;
    /// Sends a byte, now or as soon as those before it are out; false where there is no room for it.
    fn put(&mut self, byte: u8) -> bool;
}

/// Bytes between a port's interrupt and the idle loop: 0.7 ms of them.
pub type Queue = Q64<u8>;

/// A line with the traits of HALs.
pub struct Port<L>(pub L);

impl<L> ErrorType for Port<L> {
    type Error = Infallible;
}

impl<L: Line> Read<u8> for Port<L> {
    fn read(&mut self) -> nb::Result<u8, Infallible> {
        self.0.take().ok_or(nb::Error::WouldBlock)
    }
}

impl<L: Line> Write<u8> for Port<L> {
    fn write(&mut self, byte: u8) -> nb::Result<(), Infallible> {
        if self.0.put(byte) { Ok(()) } else { Err(nb::Error::WouldBlock) }
    }

    // What was put goes out by itself.
    fn flush(&mut self) -> nb::Result<(), Infallible> {
        Ok(())
    }
}
