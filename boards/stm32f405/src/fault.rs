//! When something is wrong: the drive off, then nothing, until the watchdog or the operator resets the chip.

use cortex_m_rt::exception;
use stm32f4xx_hal::pac::GPIOB;

/// Ends the image with the drive off.
pub fn halt() -> ! {
    // SAFETY: a write to the set-and-reset register takes PB0 low, whoever owns the port.
    unsafe { (*GPIOB::ptr()).bsrr().write(|w| w.br0().reset()) };
    loop {
        cortex_m::asm::wfi();
    }
}

#[exception(trampoline = false)]
unsafe fn HardFault() -> ! {
    halt()
}

#[exception]
unsafe fn DefaultHandler(_number: i16) {
    halt()
}
