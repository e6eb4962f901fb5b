//! TIM2: the control interrupt, 10 kHz from the 84 MHz that APB1 gives its timers (ST RM0090, chapter 18).

use crate::clock::{FULL, PERIPHERAL_DIVISOR};
use cortex_m::peripheral::NVIC;
use stm32f4xx_hal::pac::{Interrupt, TIM2, tim2};
use strainwave_app::control::RATE;

/// Timer cycles in a control period: exact.
const PERIOD: u32 = FULL / PERIPHERAL_DIVISOR / RATE;
const _: () = assert!(PERIOD * RATE * PERIPHERAL_DIVISOR == FULL);

/// Starts the interrupt, at the highest priority.
pub fn start(timer: &TIM2, interrupts: &mut NVIC) {
    // SAFETY: the auto-reload register takes any value.
    timer.arr().write(|w| unsafe { w.bits(PERIOD - 1) });
    timer.dier().write(|w| w.uie().enabled());
    // SAFETY: no critical section relies on priorities, and what the interrupt uses is in place.
    unsafe {
        interrupts.set_priority(Interrupt::TIM2, 0);
        NVIC::unmask(Interrupt::TIM2);
    }
    timer.cr1().write(|w| w.cen().enabled());
}

/// Clears the interrupt that is being served.
pub fn acknowledge() {
    registers().sr().modify(|_, w| w.uif().clear_bit());
}

/// The next interrupt is already waiting.
pub fn waiting() -> bool {
    registers().sr().read().uif().bit_is_set()
}

fn registers() -> &'static tim2::RegisterBlock {
    // SAFETY: once `start` has unmasked the interrupt, only its handler uses the timer.
    unsafe { &*TIM2::ptr() }
}
