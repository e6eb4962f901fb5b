//! Identification: what is predicted of measured logs and motions that did not train.
//!
//! | file | |
//! | --- | --- |
//! | `held` | stiffness of a held joint from parts of its log |
//! | `operator` | operators from some loops of an actuator, which predict others; scipy beside them |
//! | `friction` | synthetic joints: parameters of the input friction, beside a static law |
//! | `moving` | the remainder of a measured motion after its first third |
//! | `pairs` | one log of a measured joint trains, another is predicted |
//!
//! Splits are by log or by time, never by sample. A file that `strainwave identify` would not write counts as the gear file
//! that it started from.

pub mod friction;
pub mod held;
mod moving;
mod operator;
pub mod pairs;

use std::ops::Range;

use crate::io::file::BadInput;
use crate::verify::Measured;

/// Every figure, of these synthetic joints, with `rivals` those of others too; `progress` is called with the fraction done.
///
/// # Errors
/// Logs that are there and cannot be used.
pub fn measure(
    rivals: bool,
    joints: Range<u64>,
    mut progress: impl FnMut(f64),
) -> Result<Measured, BadInput> {
    let mut measured = held::measure()?;
    progress(0.1);
    measured.add(moving::measure()?);
    progress(0.2);
    measured.add(pairs::measure()?);
    progress(0.3);
    measured.add(friction::measure(joints, |fraction| progress(0.3 + 0.5 * fraction))?);
    measured.add(operator::measure(rivals, |fraction| progress(0.8 + 0.2 * fraction))?);
    Ok(measured)
}
