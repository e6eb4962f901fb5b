//! SysTick: the control interrupt, 10 kHz.

use cortex_m::peripheral::syst::RegisterBlock;
use cortex_m::peripheral::{NVIC, SCB, SYST};
use strainwave_app::control::RATE;
use strainwave_controller::Timer;

use crate::clock::FULL;

/// Its cycles in a control period: exact.
const PERIOD: u32 = FULL / RATE;
const _: () = assert!(FULL.is_multiple_of(RATE), "the clock is no multiple of the control rate");

/// Counts, by the core's clock, and interrupts.
const COUNT: u32 = 0b111;

/// The core's timer.
pub enum SysTick {}

impl Timer for SysTick {
    // Its priority is the highest out of reset.
    fn start(_interrupts: &mut NVIC) {
        // SAFETY: nothing else uses the timer, and what the interrupt uses is in place.
        unsafe {
            registers().rvr.write(PERIOD - 1);
            registers().cvr.write(0);
            registers().csr.write(COUNT);
        }
    }

    // The interrupt is no longer pending once it is served.
    fn acknowledge() {}

    fn waiting() -> bool {
        SCB::is_pendst_pending()
    }
}

fn registers() -> &'static RegisterBlock {
    // SAFETY: every Cortex-M33 has them there.
    unsafe { &*SYST::PTR }
}
