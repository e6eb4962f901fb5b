//! USART3, which the board's ST-LINK makes a serial port.

use stm32h7::stm32h743v::USART3;
use strainwave_stm32::usart::{self, Usart};

use crate::clock::{FULL, PERIPHERAL_DIVISOR};

/// The USART.
pub enum Serial {}

// SAFETY: `start` takes the peripheral, and `clock::distribute` has switched its clock on.
unsafe impl Usart for Serial {
    const ADDRESS: usize = 0x4000_4800;
}

/// Switches it on; `clock` is the core's (Hz). The divider misses the rate by 0.5 % at 100 MHz.
pub fn start(_usart: USART3, clock: u32) {
    usart::start::<Serial>(if clock == FULL { clock / PERIPHERAL_DIVISOR } else { clock });
}
