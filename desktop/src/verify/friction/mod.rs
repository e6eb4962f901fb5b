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
use crate::file::BadInput;

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

/// The largest of some distances; NaN, which `f64::max` would pass over, counts as larger than any.
fn largest(distances: impl IntoIterator<Item = f64>) -> f64 {
    distances.into_iter().max_by(f64::total_cmp).unwrap_or(f64::NAN)
}
