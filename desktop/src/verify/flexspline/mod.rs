//! The flexspline: mesh against catalogue, what a free shell keeps, real time against the reference.

mod catalogue;
mod conserved;
mod gear;
mod mode;
pub mod oracle;
mod real_time;
mod ripple;
pub mod speed;
mod stiffness;
mod strain;

use super::Measured;
use crate::file::BadInput;
use crate::gear_file::GearFile;

/// Every figure but those of the clock, see [`speed`].
pub(super) fn measure() -> Result<Measured, BadInput> {
    let gear = GearFile::default_gear();
    let built = [stiffness::measure, conserved::measure, strain::measure, mode::measure, ripple::measure];
    let run = [gear::measure, real_time::measure];
    let mut measured = Measured::from(oracle::measure());
    for measure in built {
        measured.add(measure(&gear).map_err(BadInput::message)?.into());
    }
    for measure in run {
        measured.add(measure(&gear).map_err(BadInput::message)?.into());
    }
    measured.add(catalogue::measure(&gear)?);
    Ok(measured)
}
