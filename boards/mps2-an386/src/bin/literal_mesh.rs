//! The literal mesh on the emulated board, to be counted: wound up once, compared with its reduction. Wiring only.
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

use strainwave_app::literal_mesh::{AGREEMENT, wind_up};
use strainwave_app::{Error, JOINT};

#[cortex_m_rt::entry]
fn main() -> ! {
    uart::enable();
    match wind_up(&JOINT) {
        Ok(end) => {
            defmt::info!(
                "literal mesh {=f32} N m, reduced {=f32} N m, allowed: {=f32} of it apart",
                end.literal,
                end.reduced,
                AGREEMENT
            );
            if end.agrees() {
                fault::succeed();
            }
        }
        Err(Error::OutOfRange(name)) => defmt::error!("joint: {=str} is out of range", name),
    }
    fault::fail()
}

/// Where the application's panic handler goes; nothing else defines it.
#[unsafe(no_mangle)]
extern "C" fn strainwave_a_panic_is_reachable() -> ! {
    fault::fail_because(c"the literal mesh panicked\n")
}
