//! The histories that cost the hysteresis most on the emulated board, to be counted. Wiring only.
//!
//! An image of its own, so that nothing of it is in the control's. This one may panic, and then says so.
#![no_std]
#![no_main]

#[path = "../fault.rs"]
mod fault;
#[path = "../logger.rs"]
mod logger;
#[path = "../no_interrupts.rs"]
mod no_interrupts;
#[path = "../register.rs"]
mod register;
#[path = "../uart.rs"]
mod uart;

use strainwave_app::Error;
use strainwave_app::worst_case::{AGREEMENT, drive};

#[cortex_m_rt::entry]
fn main() -> ! {
    uart::enable();
    match drive() {
        Ok(worst) => {
            defmt::info!("inverse {=f32} off, allowed: {=f32}", worst, AGREEMENT);
            if worst <= AGREEMENT {
                fault::succeed();
            }
        }
        Err(Error::OutOfRange(name)) => defmt::error!("hysteresis: {=str} is out of range", name),
    }
    fault::fail()
}

/// Where the application's panic handler goes; nothing else defines it.
#[unsafe(no_mangle)]
extern "C" fn strainwave_a_panic_is_reachable() -> ! {
    fault::fail_because(c"the worst case panicked\n")
}
