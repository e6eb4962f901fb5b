//! USART3, which the board's ST-LINK makes a serial port: telemetry out, the operator's keys in (ST RM0433, chapter 48).

use stm32h7::stm32h743v::{USART3, usart1};
use strainwave_controller::keys;

use crate::clock::{FULL, PERIPHERAL_DIVISOR};

/// Symbols a second [Bd]. The divider misses it by 0.5 % at 100 MHz.
const RATE: u32 = 921_600;

/// Switches the USART on; `clock` is the core's (Hz).
pub fn start(usart: USART3, clock: u32) {
    let peripheral = if clock == FULL { clock / PERIPHERAL_DIVISOR } else { clock };
    // SAFETY: the divider has 16 bits, and is at least 16 at either clock.
    usart.brr().write(|w| unsafe { w.bits((peripheral + RATE / 2) / RATE) });
    usart.cr1().write(|w| w.ue().enabled().te().enabled().re().enabled().rxneie().enabled());
}

/// Takes the key that interrupted.
pub fn receive() {
    let usart = registers();
    // An overrun interrupts until it is cleared.
    usart.icr().write(|w| w.orecf().clear_bit_by_one());
    if usart.isr().read().rxne().bit_is_set() {
        keys::take(usart.rdr().read().bits() as u8);
    }
}

/// Sends bytes, waiting for room for each: idle loop only.
pub fn send(bytes: &[u8]) {
    let usart = registers();
    for byte in bytes {
        while usart.isr().read().txe().bit_is_clear() {}
        // SAFETY: the data register takes any byte.
        usart.tdr().write(|w| unsafe { w.bits(u32::from(*byte)) });
    }
}

fn registers() -> &'static usart1::RegisterBlock {
    // SAFETY: `start` took the peripheral, so that nobody else has it. The idle loop only sends and the interrupt only receives, each
    // by registers of its own.
    unsafe { &*USART3::ptr() }
}
