//! 150 MHz from the 12 MHz crystal, and what is out of reset (RP2350 datasheet, 7.5, 8.1, 8.2 and 8.6).
//!
//! The reference stays on the ring oscillator: the watchdog's ticks are from it, and go on where the crystal stops.

use rp235x_pac::{CLOCKS, PLL_SYS, RESETS, XOSC, resets};
use strainwave_controller::clock::starts;

/// Clock of the core and of all peripherals (Hz).
pub const FULL: u32 = 150_000_000;
/// Of the crystal (Hz).
const CRYSTAL: u32 = 12_000_000;

/// 12 MHz * 125 = 1500 MHz; / 5 / 2 = 150 MHz.
const PLL_TIMES: u16 = 125;
const PLL_OUT: (u8, u8) = (5, 2);
const _: () = assert!(CRYSTAL * PLL_TIMES as u32 / (PLL_OUT.0 * PLL_OUT.1) as u32 == FULL);

/// Time for the crystal to settle, in 256 of its periods: 6 ms.
const SETTLING: u16 = 282;

/// The selected sources, one bit each: of the reference the ring oscillator, of the system the reference and the PLL.
const REFERENCE_RING: u32 = 1 << 0;
const SYSTEM_REFERENCE: u32 = 1 << 0;
const SYSTEM_PLL: u32 = 1 << 1;

/// Runs the core from the crystal, and takes what the board uses out of reset; whether all of that came in time.
pub fn start(clocks: &CLOCKS, crystal: &XOSC, pll: &PLL_SYS, resets: &RESETS) -> bool {
    let reset = slows_down(clocks) && restart(resets);
    clocks.clk_peri_ctrl().write(|w| w.auxsrc().clk_sys().enable().set_bit());
    reset && oscillates(crystal) && locks(pll) && speeds_up(clocks)
}

/// To the ring oscillator. A debugger restarts the core alone: the PLL may be in use, and is about to be reset.
fn slows_down(clocks: &CLOCKS) -> bool {
    clocks.clk_ref_ctrl().modify(|_, w| w.src().rosc_clksrc_ph());
    let ring = starts(|| clocks.clk_ref_selected().read().bits() == REFERENCE_RING);
    clocks.clk_sys_ctrl().modify(|_, w| w.src().clk_ref());
    ring && starts(|| clocks.clk_sys_selected().read().bits() == SYSTEM_REFERENCE)
}

/// Resets what the board uses.
fn restart(resets: &RESETS) -> bool {
    resets.reset().modify(|_, w| used(w, true));
    resets.reset().modify(|_, w| used(w, false));
    starts(|| {
        let done = resets.reset_done().read();
        done.io_bank0().bit()
            && done.pads_bank0().bit()
            && done.pll_sys().bit()
            && done.pwm().bit()
            && done.spi0().bit()
            && done.uart0().bit()
    })
}

/// What the board uses, in reset or not.
fn used(w: &mut resets::reset::W, reset: bool) -> &mut resets::reset::W {
    w.io_bank0().bit(reset).pads_bank0().bit(reset).pll_sys().bit(reset);
    w.pwm().bit(reset).spi0().bit(reset).uart0().bit(reset)
}

fn oscillates(crystal: &XOSC) -> bool {
    // SAFETY: the field has 14 bits.
    crystal.startup().write(|w| unsafe { w.delay().bits(SETTLING) });
    crystal.ctrl().write(|w| w.freq_range()._1_15mhz().enable().enable());
    starts(|| crystal.status().read().stable().bit_is_set())
}

fn locks(pll: &PLL_SYS) -> bool {
    // SAFETY: the factors are within the ranges of the PLL: input above 5 MHz, 750..1600 MHz inside, divisors 1..7.
    unsafe {
        pll.cs().modify(|_, w| w.refdiv().bits(1));
        pll.fbdiv_int().write(|w| w.fbdiv_int().bits(PLL_TIMES));
    }
    pll.pwr().modify(|_, w| w.pd().clear_bit().vcopd().clear_bit());
    if !starts(|| pll.cs().read().lock().bit_is_set()) {
        return false;
    }
    // SAFETY: as above.
    pll.prim().write(|w| unsafe { w.postdiv1().bits(PLL_OUT.0).postdiv2().bits(PLL_OUT.1) });
    pll.pwr().modify(|_, w| w.postdivpd().clear_bit());
    true
}

fn speeds_up(clocks: &CLOCKS) -> bool {
    // The source behind the second switch first: that one alone switches without a glitch.
    clocks.clk_sys_ctrl().modify(|_, w| w.auxsrc().clksrc_pll_sys());
    clocks.clk_sys_ctrl().modify(|_, w| w.src().clksrc_clk_sys_aux());
    starts(|| clocks.clk_sys_selected().read().bits() == SYSTEM_PLL)
}
