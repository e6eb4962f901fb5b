//! UART0 (RP2350 datasheet, 12.1).

use rp235x_pac::{UART0, uart0};

use crate::clock::FULL;

/// Symbols a second [Bd]. The divider misses it by less than 0.01 %. Without the crystal they are some 70000, and the ring oscillator's.
const RATE: u32 = 921_600;

/// Of 16 clocks a symbol, in 1/64.
const DIVIDER: u32 = (4 * FULL + RATE / 2) / RATE;

/// Bits of a character, less 5.
pub const BYTE: u8 = 3;

/// Switches the UART on.
pub fn start(uart: &UART0) {
    // SAFETY: 10 and a fraction, within the 16 and the 6 bits of the divider.
    unsafe {
        uart.uartibrd().write(|w| w.bits(DIVIDER / 64));
        uart.uartfbrd().write(|w| w.bits(DIVIDER % 64));
        // Takes the divider over; without FIFOs, so that each key interrupts at once.
        uart.uartlcr_h().write(|w| w.wlen().bits(BYTE));
    }
    uart.uartimsc().write(|w| w.rxim().set_bit());
    uart.uartcr().write(|w| w.uarten().set_bit().txe().set_bit().rxe().set_bit());
}

/// Sends bytes, waiting for room for each: idle loop only.
pub fn send(bytes: &[u8]) {
    let uart = registers();
    for byte in bytes {
        while uart.uartfr().read().txff().bit_is_set() {}
        // SAFETY: the data register takes any byte.
        uart.uartdr().write(|w| unsafe { w.bits(u32::from(*byte)) });
    }
}

/// Its registers.
pub fn registers() -> &'static uart0::RegisterBlock {
    // SAFETY: `board` gives the peripheral up once it is on. The one register that both directions use
    // is the data register, where they do not meet.
    unsafe { &*UART0::ptr() }
}
