//! USART2, which the board's ST-LINK makes a serial port: telemetry out, the operator's keys in (ST RM0440, chapter 37).
//!
//! Through the registers: the HAL would take its divider from the clock that it assumes.

use stm32g4xx_hal::gpio::{PA2, PA3, Pull};
use stm32g4xx_hal::pac::USART2;
use stm32g4xx_hal::rcc::{Enable, Rcc, Reset};
use strainwave_controller::keys;

/// Symbols a second [Bd]. The divider misses it by 0.25 % at 170 MHz.
const RATE: u32 = 921_600;

/// Switches the USART on; `clock` is the core's (Hz).
pub fn start(usart: USART2, transmit: PA2, receive: PA3, clock: u32, rcc: &mut Rcc) {
    let _pins = (transmit.into_alternate::<7>(), receive.into_alternate::<7>().internal_resistor(Pull::Up));
    USART2::enable(rcc);
    USART2::reset(rcc);
    // SAFETY: the divider has 16 bits, and is at least 16 at either clock.
    usart.brr().write(|w| unsafe { w.bits((clock + RATE / 2) / RATE) });
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

fn registers() -> &'static stm32g4xx_hal::pac::usart1::RegisterBlock {
    // SAFETY: `start` took the peripheral, so that nobody else has it. The idle loop only sends and the interrupt only receives, each
    // by registers of its own.
    unsafe { &*USART2::ptr() }
}
