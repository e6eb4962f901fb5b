//! The operator's keys, from UART0.

use strainwave_controller::keys;

use crate::serial::registers;

/// Takes the key that interrupted.
pub fn receive() {
    let uart = registers();
    // Reading the data clears the interrupt, an overrun with it.
    if uart.uartfr().read().rxfe().bit_is_clear() {
        keys::take(uart.uartdr().read().data().bits());
    }
}
