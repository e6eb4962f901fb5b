//! USART1 (ST RM0090, chapter 30).
//!
//! Through the registers: the HAL would take its divider from the clock that it assumes.

use stm32f4xx_hal::gpio::{PA9, PA10};
use stm32f4xx_hal::pac::USART1;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use crate::clock::{FULL, PERIPHERAL_DIVISOR};

/// Symbols a second [Bd]. The divider misses it by 0.16 % at 84 MHz.
const RATE: u32 = 921_600;

/// Switches the USART on; `clock` is the core's (Hz).
pub fn start(usart: USART1, transmit: PA9, receive: PA10, clock: u32, rcc: &mut Rcc) {
    let _pins = (transmit.into_alternate::<7>(), receive.into_alternate::<7>().internal_pull_up(true));
    USART1::enable(rcc);
    USART1::reset(rcc);
    let peripheral = if clock == FULL { clock / PERIPHERAL_DIVISOR } else { clock };
    // SAFETY: the divider has 16 bits, 12 of them before the binary point, and exceeds 1 at either clock.
    usart.brr().write(|w| unsafe { w.bits(((peripheral + RATE / 2) / RATE) as u16) });
    usart.cr1().write(|w| w.ue().enabled().te().enabled().re().enabled().rxneie().enabled());
}

/// Sends bytes, waiting for room for each: idle loop only.
pub fn send(bytes: &[u8]) {
    let usart = registers();
    for byte in bytes {
        while usart.sr().read().txe().bit_is_clear() {}
        // SAFETY: the data register takes any byte.
        usart.dr().write(|w| unsafe { w.bits(u16::from(*byte)) });
    }
}

/// Its registers. The idle loop only sends; of what is received, the interrupt or a DMA stream has all.
pub fn registers() -> &'static stm32f4xx_hal::pac::usart1::RegisterBlock {
    // SAFETY: `start` took the peripheral, so that nobody else has it. The one register that both directions use is the data
    // register, where they do not meet.
    unsafe { &*USART1::ptr() }
}
