//! 400 MHz from the 8 MHz that the board's ST-LINK gives (ST RM0433, 4.3, 6.6 and 8.5).

use stm32h7::stm32h743v::{FLASH, PWR, RCC};
use strainwave_controller::Chip;
use strainwave_controller::clock::starts;
use strainwave_stm32::reset::Flags;
use strainwave_stm32::{IndependentWatchdog, Stm32, Tim2};

/// Clock of the core (Hz).
pub const FULL: u32 = 400_000_000;
/// Without the ST-LINK's (Hz).
pub const INTERNAL: u32 = 64_000_000;
/// Divisor of the core's clock for the peripherals at [`FULL`]: once for their buses, once for each of these.
pub const PERIPHERAL_DIVISOR: u32 = 4;
/// Clock that SPI1 divides (Hz).
pub const SPI: u32 = 100_000_000;

/// The chip.
pub enum H743 {}

// SAFETY: the register is that of port B.
unsafe impl Chip for H743 {
    const CORE_CLOCK: u32 = FULL;
    // PB1.
    const RELEASE: (usize, u32) = (0x5802_0418, 1 << 17);
    type Timer = Tim2<Self>;
    type Watchdog = IndependentWatchdog<Self>;
}

// SAFETY: `board` gives TIM2 and the watchdog up, and nothing else has them; the register is that of the clock control.
unsafe impl Stm32 for H743 {
    // Twice that of its bus.
    const TIMER_CLOCK: u32 = FULL / PERIPHERAL_DIVISOR * 2;
    const WATCHDOG: usize = 0x5800_4800;
    // RSR.
    const RESET_FLAGS: Flags =
        Flags { register: 0x5802_44d0, by_itself: 1 << 24 | 1 << 26 | 1 << 28, clear: 1 << 16 };
}

/// 8 MHz / 2 = 4 MHz; * 200 = 800 MHz; / 2 = 400 MHz for the core, / 8 = 100 MHz for SPI1.
const PLL_IN: u8 = 2;
const PLL_TIMES: u16 = 200;
const PLL_SPI: u8 = 8;

/// The most that the regulator gives: above 300 MHz.
const SCALE_1: u8 = 0b11;
/// Flash wait states and delay of its signals at 200 MHz of its bus.
const WAIT_STATES: u8 = 2;
const SIGNAL_DELAY: u8 = 0b10;

/// Runs the core from the ST-LINK's clock; the core's (Hz), [`INTERNAL`] when there is none.
pub fn start(rcc: &RCC, flash: &FLASH, power: &PWR) -> u32 {
    if !powered(power) || !locked(rcc) {
        return INTERNAL;
    }
    // SAFETY: a valid number of wait states and delay, set before the clock is raised.
    flash.acr().modify(|_, w| unsafe { w.latency().bits(WAIT_STATES).wrhighfreq().bits(SIGNAL_DELAY) });
    while flash.acr().read().latency().bits() != WAIT_STATES {}
    // The buses may run at 200 MHz, the peripherals on them at 100 MHz at most.
    rcc.d1cfgr().modify(|_, w| w.d1cpre().div1().hpre().div2().d1ppre().div2());
    rcc.d2cfgr().modify(|_, w| w.d2ppre1().div2().d2ppre2().div2());
    rcc.d3cfgr().modify(|_, w| w.d3ppre().div2());
    rcc.cfgr().modify(|_, w| w.sw().pll1());
    while !rcc.cfgr().read().sws().is_pll1() {}
    FULL
}

/// Hands the clocks out to the peripherals that the board uses.
pub fn distribute(rcc: &RCC) {
    rcc.ahb4enr().modify(|_, w| w.gpioaen().enabled().gpioben().enabled().gpioden().enabled());
    rcc.apb1lenr().modify(|_, w| w.tim2en().enabled().usart3en().enabled().dac12en().enabled());
    rcc.apb2enr().modify(|_, w| w.spi1en().enabled());
    // A peripheral answers two cycles after its clock is on.
    let _ = rcc.apb2enr().read();
}

/// Has the linear regulator give what the full clock needs.
fn powered(power: &PWR) -> bool {
    // Its choice is taken once after power-on, and nothing else works before; a later one changes nothing.
    power.cr3().modify(|_, w| w.scuen().clear_bit().ldoen().set_bit().bypass().clear_bit());
    if !starts(|| power.csr1().read().actvosrdy().bit_is_set()) {
        return false;
    }
    // SAFETY: one of the scales.
    power.d3cr().modify(|_, w| unsafe { w.vos().bits(SCALE_1) });
    starts(|| power.d3cr().read().vosrdy().bit_is_set())
}

/// Locks the PLL to the ST-LINK's clock.
fn locked(rcc: &RCC) -> bool {
    rcc.cr().modify(|_, w| w.hsebyp().bypassed());
    rcc.cr().modify(|_, w| w.hseon().on());
    if !starts(|| rcc.cr().read().hserdy().bit_is_set()) {
        return false;
    }
    rcc.pllckselr().modify(|_, w| w.pllsrc().hse().divm1().set(PLL_IN));
    rcc.pllcfgr().modify(|_, w| {
        w.pll1rge().range4().pll1vcosel().wide_vco().pll1fracen().reset();
        w.divp1en().enabled().divq1en().enabled()
    });
    rcc.pll1divr().modify(|_, w| {
        // SAFETY: the factor is within the range of the PLL: input 2..16 MHz, 192..836 MHz inside.
        unsafe { w.divn1().bits(PLL_TIMES - 1) }.divp1().div2().divq1().set(PLL_SPI - 1)
    });
    rcc.cr().modify(|_, w| w.pll1on().on());
    starts(|| rcc.cr().read().pll1rdy().bit_is_set())
}
