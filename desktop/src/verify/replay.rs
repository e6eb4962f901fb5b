//! Measured joints that move: the output encoder predicted from the motor side, after a third of the motion.
//!
//! The observer is the firmware's f32 build on this machine; that the firmware's own bits are the same is
//! measured with `strainwave pil --replay`. What each prediction misses by is about the mean that it had in the part
//! learnt from; `spread` is about its own mean.

use std::path::Path;

use crate::identify::replay::Judgement;
use crate::identify::{LearntGear, learn_gear};
use crate::io::data;
use crate::io::figure::Figure;
use crate::io::file::BadInput;
use crate::io::gear_file::{GearFile, LARA8_MOVING};
use crate::io::log::MeasuredLog;
use crate::verify::Measured;
use crate::verify::bounds;

/// Fraction of the motor's path that is learnt from.
pub(super) const LEARNT: f64 = 1.0 / 3.0;
/// Logs, their joints, and whether the motor torque counts against the angle: the encoders of joints 1, 2 and 6 count against
/// the joint's angle, in whose direction the controller states torques.
pub(super) const LOGS: [(&str, &str, bool); 6] = [
    ("jog_j1", "j1", true),
    ("jog_j2_mass", "j2", true),
    ("jog_linear_mass", "j1", true),
    ("jog_linear_mass", "j2", true),
    ("jog_linear_mass", "j3", false),
    ("jog_linear_mass", "j6", true),
];

/// Every log's figures, and how many joints are predicted twice as well as by a rigid gear.
///
/// # Errors
/// Logs that are there and cannot be used.
pub fn measure() -> Result<Measured, BadInput> {
    let mut measured = Measured::default();
    let mut at_half = Vec::new();
    for (log, joint, reversed) in LOGS {
        let found = learnt(log, joint, reversed, LEARNT)?;
        let Some(judgement) = found.and_then(|found| found.judgement) else {
            measured.notes.push(format!("compensator.replay.{log}_{joint}: skipped: no data (lara8)"));
            continue;
        };
        measured.figures.extend(figures(&format!("compensator.replay.{log}_{joint}"), &judgement));
        at_half.push(judgement.ratio() <= 0.5);
    }
    if at_half.len() == LOGS.len() {
        let count = at_half.iter().filter(|half| **half).count();
        measured.figures.push(bounds::figure("compensator.replay.joints_at_half", count as f64));
    }
    Ok(measured)
}

/// From the first `training` of a log's path; `None` without the data.
pub(super) fn learnt(
    log: &str,
    joint: &str,
    reversed: bool,
    training: f64,
) -> Result<Option<LearntGear>, BadInput> {
    let Some(measured) = log_of(log, joint, reversed)? else { return Ok(None) };
    let named = |why| BadInput::message(format!("{log}.{joint}: {why}"));
    learn_gear(&shipped_gear(joint)?, &measured, training, |_| ()).map(Some).map_err(named)
}

/// The log of a joint; `None` without the data.
pub(super) fn log_of(log: &str, joint: &str, reversed: bool) -> Result<Option<MeasuredLog>, BadInput> {
    let path = data::find(&format!("lara8/joint/{log}.{joint}.csv"));
    path.map(|path| read(&path, reversed)).transpose()
}

/// The gear file of a measured joint that moves.
pub(super) fn shipped_gear(joint: &str) -> Result<GearFile, BadInput> {
    let (_, text) = LARA8_MOVING.iter().find(|gear| gear.0 == joint).expect("each joint has a gear file");
    GearFile::parse(Path::new(&format!("gears/lara8-{joint}.toml")), text.as_bytes())
}

/// A log whose motor torque counts in the direction of the angle.
pub(super) fn read(path: &Path, reversed: bool) -> Result<MeasuredLog, BadInput> {
    let measured = MeasuredLog::read(path)?;
    Ok(if reversed { measured.with_reversed_torque() } else { measured })
}

fn figures(name: &str, judgement: &Judgement) -> Vec<Figure> {
    vec![
        Figure::reported(format!("{name}.rms"), judgement.rms, "rad"),
        Figure::reported(format!("{name}.rigid.rms"), judgement.rigid_rms, "rad"),
        Figure::reported(format!("{name}.over_rigid"), judgement.ratio(), "1"),
        Figure::reported(format!("{name}.spread"), judgement.spread, "rad"),
        Figure::reported(format!("{name}.rigid.spread"), judgement.rigid_spread, "rad"),
    ]
}
