//! Friction: exact steps, what others compute for the same systems, work, precision, and measured gears.

mod closed_form;
mod laws;
pub mod load;
pub mod lugre;
pub mod order_p;
mod precision;
pub mod ripple;
mod work;

use super::Measured;
use crate::io::file::BadInput;

/// Every figure.
pub(super) fn measure() -> Result<Measured, BadInput> {
    let figures = [
        closed_form::measure(),
        order_p::measure(),
        laws::measure(),
        lugre::measure(),
        work::measure(),
        precision::measure(),
    ];
    let mut measured = Measured::from(figures.concat());
    measured.add(load::measure()?);
    measured.add(ripple::measure()?);
    Ok(measured)
}
