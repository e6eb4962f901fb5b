//! Frame of the programs of this board that are counted, and never flashed.
//!
//! An image of its own, so that nothing of it is in the control's. It may panic, and then says so.

mod fault;
mod logger;
mod no_interrupts;
mod register;
mod uart;

use strainwave_app::Error;

/// Runs a program that tells whether what it found holds; the image ends as it does.
pub fn run(program: impl FnOnce() -> Result<bool, Error>) -> ! {
    uart::enable();
    match program() {
        Ok(true) => fault::succeed(),
        Ok(false) => fault::fail(),
        Err(Error::OutOfRange(name)) => defmt::error!("parameter {=str} is out of range", name),
    }
    fault::fail()
}

/// Target of the application's panic handler; nothing else defines it.
#[unsafe(no_mangle)]
extern "C" fn strainwave_a_panic_is_reachable() -> ! {
    fault::fail_because(c"the counted program panicked\n")
}
