//! 168 MHz from the 8 MHz crystal (ST RM0090, 7.3.2 and 3.5.1).
//!
//! Through the registers: the HAL's `freeze` searches for PLL factors at run time and panics when it finds
//! none, and a panic that the linker can see keeps the image from linking. The HAL goes on assuming the
//! 16 MHz that the chip starts with; whoever gives it a frequency has to mind that.

use stm32f4xx_hal::pac::FLASH;
use stm32f4xx_hal::rcc::Rcc;
use strainwave_controller::Chip;
use strainwave_controller::clock::starts;
use strainwave_stm32::reset::Flags;
use strainwave_stm32::{IndependentWatchdog, Stm32, Tim2};

/// Core clock (Hz).
pub const FULL: u32 = 168_000_000;
/// Core clock without the crystal, and what the HAL assumes (Hz).
pub const INTERNAL: u32 = 16_000_000;
/// Divisor of the core clock for the timers of APB1 and all of APB2 at [`FULL`].
pub const PERIPHERAL_DIVISOR: u32 = 2;

/// The chip.
pub enum F405 {}

// SAFETY: the register is that of port B.
unsafe impl Chip for F405 {
    const CORE_CLOCK: u32 = FULL;
    // PB0.
    const RELEASE: (usize, u32) = (0x4002_0418, 1 << 16);
    type Timer = Tim2<Self>;
    type Watchdog = IndependentWatchdog<Self>;
}

// SAFETY: `board` gives TIM2 and the watchdog up, and nothing else has them; the register is that of the clock control.
unsafe impl Stm32 for F405 {
    const TIMER_CLOCK: u32 = FULL / PERIPHERAL_DIVISOR;
    const WATCHDOG: usize = 0x4000_3000;
    // CSR.
    const RESET_FLAGS: Flags =
        Flags { register: 0x4002_3874, by_itself: 1 << 28 | 1 << 29 | 1 << 30, clear: 1 << 24 };
}

/// 8 MHz / 4 = 2 MHz into the PLL, which ST recommends against jitter; * 168 = 336 MHz; / 2 = 168 MHz.
const PLL_IN: u8 = 4;
const PLL_TIMES: u16 = 168;
/// 336 MHz / 7 = 48 MHz, the most that the USB branch may get.
const PLL_USB: u8 = 7;

/// Flash wait states at 168 MHz and 2.7 to 3.6 V.
const WAIT_STATES: u8 = 5;

/// Runs the core from the crystal; its clock (Hz), [`INTERNAL`] when the crystal does not start.
pub fn start(rcc: &Rcc, flash: &FLASH) -> u32 {
    rcc.cr().modify(|_, w| w.hseon().on());
    if !starts(|| rcc.cr().read().hserdy().bit_is_set()) {
        return INTERNAL;
    }
    rcc.pllcfgr().modify(|_, w| {
        // SAFETY: the factors are within the ranges of the PLL: input 1..2 MHz, 100..432 MHz inside.
        unsafe {
            w.pllsrc().hse().pllm().bits(PLL_IN).plln().bits(PLL_TIMES).pllp().div2().pllq().bits(PLL_USB)
        }
    });
    rcc.cr().modify(|_, w| w.pllon().on());
    if !starts(|| rcc.cr().read().pllrdy().bit_is_set()) {
        return INTERNAL;
    }
    flash.acr().modify(|_, w| {
        // SAFETY: a valid number of wait states, set before the clock is raised.
        unsafe { w.latency().bits(WAIT_STATES).prften().set_bit().icen().set_bit().dcen().set_bit() }
    });
    // APB1 may run at 42 MHz and APB2 at 84 MHz at most.
    rcc.cfgr().modify(|_, w| w.hpre().div1().ppre1().div4().ppre2().div2());
    rcc.cfgr().modify(|_, w| w.sw().pll());
    while !rcc.cfgr().read().sws().is_pll() {}
    FULL
}
