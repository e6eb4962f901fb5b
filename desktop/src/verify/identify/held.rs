//! A measured joint that is held: its stiffness must not depend on how much of the log trains.

use crate::identify::{GearLog, GearOptions, IdentifiedGear, identify_gear};
use crate::io::data;
use crate::io::file::BadInput;
use crate::io::gear_file::{GearFile, LARA8_J5};
use crate::io::log::MeasuredLog;
use crate::verify::bounds::figure;
use crate::verify::{Measured, largest};

/// The one log with the torque at the output.
pub(super) const LOG: &str = "lara8/joint/jog_j2_mass.j5.csv";
/// Fractions of the log that train, the last being all of it.
const TRAINING: [f64; 8] = [0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0];

/// Every figure.
///
/// # Errors
/// Logs that are there and cannot be used.
pub fn measure() -> Result<Measured, BadInput> {
    let found = TRAINING.map(identified).into_iter().collect::<Result<Option<Vec<_>>, _>>()?;
    let Some([parts @ .., whole]) = found.as_deref() else {
        return Ok(Measured::skipped(format!("identify.held.*: skipped: no data ({LOG})")));
    };
    let difference = |part: &IdentifiedGear| part.stiffness_factor / whole.stiffness_factor - 1.0;
    Ok(vec![
        figure("identify.held.stiffness", largest(parts.iter().map(difference))),
        figure("identify.held.in_sample", whole.training_rms),
    ]
    .into())
}

/// From the first `training` of the log; `None` without the data.
fn identified(training: f64) -> Result<Option<IdentifiedGear>, BadInput> {
    let Some((gear, log)) = log()? else { return Ok(None) };
    let options = GearOptions { training, ..GearOptions::default() };
    identify_gear(&gear, &[log], &options, |_| ()).map(Some).map_err(BadInput::message)
}

/// The joint's gear file and its log; `None` without the data.
pub(super) fn log() -> Result<Option<(GearFile, GearLog)>, BadInput> {
    let Some(path) = data::find(LOG) else { return Ok(None) };
    let gear = GearFile::parse("gears/lara8-j5.toml".as_ref(), LARA8_J5.as_bytes())?;
    let log = GearLog::of(&MeasuredLog::read(&path)?, &gear)
        .ok_or_else(|| BadInput::new(&path, "the output's angle or torque is missing"))?;
    Ok(Some((gear, log)))
}
