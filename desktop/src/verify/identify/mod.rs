//! Identification: what is predicted of measured logs and motions that did not train.
//!
//! | file | |
//! | --- | --- |
//! | `held` | stiffness of a held joint from parts of its log |
//! | `moving` | the remainder of a measured motion after its first third |
//! | `pairs` | one log of a measured joint trains, another is predicted |
//!
//! Splits are by log or by time, never by sample. A file that `strainwave identify` would not write counts as the gear file
//! that it started from.

mod held;
mod moving;
mod pairs;

use crate::io::file::BadInput;
use crate::verify::Measured;

/// Every figure; `progress` is called with the fraction done.
///
/// # Errors
/// Logs that are there and cannot be used.
pub fn measure(mut progress: impl FnMut(f64)) -> Result<Measured, BadInput> {
    let mut measured = held::measure()?;
    progress(0.1);
    measured.add(moving::measure()?);
    progress(0.4);
    measured.add(pairs::measure()?);
    Ok(measured)
}
