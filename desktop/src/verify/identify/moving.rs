//! Measured joints that move: the remainder of each motion after its first third, by the learnt gear where it would be written,
//! else by the gear that it started from.

use crate::identify::Refusal;
use crate::io::file::BadInput;
use crate::verify::Measured;
use crate::verify::bounds::figure_as;
use crate::verify::replay::{LEARNT, LOGS, learnt};

pub(super) fn measure() -> Result<Measured, BadInput> {
    let mut measured = Measured::default();
    for (log, joint, reversed) in LOGS {
        let name = format!("identify.moving.{log}_{joint}");
        let Some(found) = learnt(log, joint, reversed, LEARNT)? else {
            measured.notes.push(format!("{name}: skipped: no data (lara8)"));
            continue;
        };
        let (Some(judgement), Some(base)) = (found.judgement, found.base_judgement) else { continue };
        let refusal = Refusal::of(&found.gear, &found.friction.limits(), Some((judgement.rms, base.rms)));
        let kept = if refusal.is_some() { base } else { judgement };
        measured.notes.extend(refusal.map(|why| format!("{name}: not written: {why}")));
        let row = "identify.moving.over_rigid";
        measured.figures.push(figure_as(format!("{name}.over_rigid"), row, kept.ratio()));
    }
    Ok(measured)
}
