//! Hysteresis: two realisations of one operator, its laws, its inverse, and the default gear's loop.

mod continuity;
mod default_gear;
mod energy;
mod history;
mod identification;
mod inverse;
mod laws;
mod memory;
mod relays;

use super::Measured;
use crate::io::file::BadInput;

/// Every figure.
pub(super) fn measure() -> Result<Measured, BadInput> {
    let figures = [
        relays::measure(),
        laws::measure(),
        continuity::measure(),
        inverse::measure(),
        energy::measure(),
        memory::measure(),
        default_gear::measure(),
    ];
    let mut measured = Measured::from(figures.concat());
    measured.add(identification::measure()?);
    Ok(measured)
}
