//! Frame of the programs that are counted, and never flashed.
//!
//! An image of its own, so that nothing of it is in the control's. It may panic, and then says so.

use crate::{Machine, fault, uart};
use strainwave_app::Error;

/// Runs a program that tells whether what it found holds; the image ends as it does.
pub fn run<M: Machine>(program: impl FnOnce() -> Result<bool, Error>) -> ! {
    uart::enable::<M>();
    match program() {
        Ok(true) => fault::succeed(),
        Ok(false) => fault::fail(),
        Err(Error::OutOfRange(name)) => defmt::error!("parameter {=str} is out of range", name),
    }
    fault::fail()
}
