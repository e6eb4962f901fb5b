//! 170 MHz from the 24 MHz crystal (ST RM0440, 6.1.5, 3.3.3 and 7.2).
//!
//! Through the registers: the HAL's `freeze` panics where it finds no PLL factors, and a panic that the linker can see keeps the image
//! from linking. The HAL goes on assuming the 16 MHz that the chip starts with: nothing here asks it for a frequency.

use stm32g4xx_hal::pac::{FLASH, PWR};
use stm32g4xx_hal::rcc::Rcc;
use strainwave_controller::Chip;
use strainwave_controller::clock::starts;
use strainwave_stm32::reset::Flags;
use strainwave_stm32::{IndependentWatchdog, Stm32, Tim2};

/// Clock of the core, of all peripherals and timers (Hz).
pub const FULL: u32 = 170_000_000;
/// Without the crystal (Hz).
pub const INTERNAL: u32 = 16_000_000;

/// The chip.
pub enum G474 {}

// SAFETY: the register is that of port B.
unsafe impl Chip for G474 {
    const CORE_CLOCK: u32 = FULL;
    // PB0.
    const RELEASE: (usize, u32) = (0x4800_0418, 1 << 16);
    type Timer = Tim2<Self>;
    type Watchdog = IndependentWatchdog<Self>;
}

// SAFETY: `board` gives TIM2 and the watchdog up, and nothing else has them; the register is that of the clock control.
unsafe impl Stm32 for G474 {
    const TIMER_CLOCK: u32 = FULL;
    const WATCHDOG: usize = 0x4000_3000;
    // CSR.
    const RESET_FLAGS: Flags =
        Flags { register: 0x4002_1094, by_itself: 1 << 28 | 1 << 29 | 1 << 30, clear: 1 << 23 };
}

/// 24 MHz / 6 = 4 MHz; * 85 = 340 MHz; / 2 = 170 MHz.
const PLL_TIMES: u8 = 85;

/// Cycles of the core that take longer than 1 us at 85 MHz.
const MICROSECOND: u32 = 100;

/// Runs the core from the crystal; its clock (Hz), [`INTERNAL`] when the crystal does not start.
pub fn start(rcc: &Rcc, flash: &FLASH, power: &PWR) -> u32 {
    rcc.cr().modify(|_, w| w.hseon().set_bit());
    if !starts(|| rcc.cr().read().hserdy().bit_is_set()) {
        return INTERNAL;
    }
    rcc.pllcfgr().modify(|_, w| {
        // SAFETY: the factor is within the range of the PLL: input 2.66..16 MHz, 96..344 MHz inside.
        unsafe { w.pllsrc().hse().pllm().div6().plln().bits(PLL_TIMES).pllr().div2().pllren().set_bit() }
    });
    rcc.cr().modify(|_, w| w.pllon().set_bit());
    if !starts(|| rcc.cr().read().pllrdy().bit_is_set()) {
        return INTERNAL;
    }
    // Above 150 MHz the regulator has to boost, and above 80 MHz the clock rises in two steps, a microsecond apart.
    rcc.apb1enr1().modify(|_, w| w.pwren().set_bit());
    // A peripheral answers two cycles after its clock is on.
    let _ = rcc.apb1enr1().read();
    power.cr5().modify(|_, w| w.r1mode().clear_bit());
    flash.acr().modify(|_, w| w.latency().wait4().prften().set_bit().icen().set_bit().dcen().set_bit());
    while !flash.acr().read().latency().is_wait4() {}
    rcc.cfgr().modify(|_, w| w.hpre().div2().ppre1().div1().ppre2().div1());
    rcc.cfgr().modify(|_, w| w.sw().pll());
    while !rcc.cfgr().read().sws().is_pll() {}
    cortex_m::asm::delay(MICROSECOND);
    rcc.cfgr().modify(|_, w| w.hpre().div1());
    FULL
}
