//! UART0 under the tuning link. Each direction has a FIFO of 32 bytes, more than three control periods of them: the idle loop needs no
//! interrupt.

use strainwave_controller::line::Line;

use crate::serial::{BYTE, registers};

/// The link's line. There is one.
pub struct Fifo(());

impl Fifo {
    /// Hands the UART, which was switched on, over to the link.
    pub fn begin() -> Self {
        let uart = registers();
        uart.uartimsc().reset();
        // The character is set up while it is off.
        uart.uartcr().modify(|_, w| w.uarten().clear_bit());
        // SAFETY: a number of bits that a character may have.
        uart.uartlcr_h().write(|w| unsafe { w.wlen().bits(BYTE) }.fen().set_bit());
        uart.uartcr().modify(|_, w| w.uarten().set_bit());
        Self(())
    }
}

impl Line for Fifo {
    fn take(&mut self) -> Option<u8> {
        let uart = registers();
        let has_come = uart.uartfr().read().rxfe().bit_is_clear();
        has_come.then(|| uart.uartdr().read().data().bits())
    }

    fn put(&mut self, byte: u8) -> bool {
        let uart = registers();
        let room = uart.uartfr().read().txff().bit_is_clear();
        if room {
            // SAFETY: the data register takes any byte.
            uart.uartdr().write(|w| unsafe { w.bits(u32::from(byte)) });
        }
        room
    }
}

/// It does not interrupt.
pub fn serve() {}
