//! The flexspline: mesh against catalogue, what a free shell keeps, real time against the reference.

mod bends;
mod conserved;
mod gear;
mod mode;
pub mod oracle;
mod real_time;
mod ripple;
mod stiffness;
mod strain;

use super::Measured;
use crate::io::file::BadInput;
use crate::io::gear_file::GearFile;
use crate::plant::divergence::RunError;

/// Every figure.
pub(super) fn measure() -> Result<Measured, BadInput> {
    let gear = GearFile::default_gear();
    let figures = [
        stiffness::measure(&gear).map_err(RunError::from),
        conserved::measure(&gear).map_err(RunError::from),
        Ok(oracle::measure()),
        strain::measure(&gear).map_err(RunError::from),
        gear::measure(&gear),
        real_time::measure(&gear),
        mode::measure(&gear).map_err(RunError::from),
        ripple::measure(&gear).map_err(RunError::from),
        bends::measure(&gear),
    ];
    let figures = figures.into_iter().collect::<Result<Vec<_>, _>>().map_err(BadInput::message)?;
    Ok(Measured::from(figures.concat()))
}
