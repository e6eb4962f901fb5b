//! USART2, which the board's ST-LINK makes a serial port.
//!
//! Through the registers: the HAL would take its divider from the clock that it assumes.

use stm32g4xx_hal::gpio::{PA2, PA3, Pull};
use stm32g4xx_hal::pac::USART2;
use stm32g4xx_hal::rcc::{Enable, Rcc, Reset};
use strainwave_stm32::usart::{self, Usart};

/// The USART.
pub enum Serial {}

// SAFETY: `start` takes the peripheral and switches its clock on.
unsafe impl Usart for Serial {
    const ADDRESS: usize = 0x4000_4400;
}

/// Switches it on; `clock` is the core's (Hz). The divider misses the rate by 0.25 % at 170 MHz.
pub fn start(_usart: USART2, transmit: PA2, receive: PA3, clock: u32, rcc: &mut Rcc) {
    let _pins = (transmit.into_alternate::<7>(), receive.into_alternate::<7>().internal_resistor(Pull::Up));
    USART2::enable(rcc);
    USART2::reset(rcc);
    usart::start::<Serial>(clock);
}
