//! Measured joints that move: the remainder of each motion after its first third, by the learnt gear where it would be written,
//! else by the gear that it started from.
//!
//! Beside it what bounds this: the regression of the output with a free factor on the torsion, from the first third, and from the
//! judged remainder itself. Where the latter alone is good, noise and encoders do not forbid it, and the first third does not
//! show it.

use crate::identify::moving::{Regression, observe_log, without_errors};
use crate::identify::replay::Judgement;
use crate::identify::{Error, LearntGear, Refusal};
use crate::io::figure::Figure;
use crate::io::file::BadInput;
use crate::io::log::MeasuredLog;
use crate::verify::Measured;
use crate::verify::bounds::figure_as;
use crate::verify::replay::{LEARNT, LOGS, learnt, log_of};

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
        measured.figures.push(Figure::reported(format!("{name}.untrained.over_rigid"), base.ratio(), "1"));
        if let Some(log) = log_of(log, joint, reversed)? {
            measured.figures.extend(bounding(&name, &found, &log).map_err(BadInput::message)?);
        }
    }
    Ok(measured)
}

/// What regressions of the output say of what could be reached.
fn bounding(name: &str, found: &LearntGear, log: &MeasuredLog) -> Result<[Figure; 4], Error> {
    let gear = without_errors(&found.gear);
    let rows = observe_log(&gear, log)?;
    let (first, rest) = rows.split_at(rows.partition_point(|row| row.time <= found.learnt));
    let [of_first, of_rest] = [first, rest].map(|rows| Regression::of(&gear, rows));
    let (of_first, of_rest) = (of_first?, of_rest?);
    let judged = Judgement::of(&of_first.predicted(&rows), found.learnt);
    let itself = Judgement::of(&of_rest.predicted(rest), found.learnt);
    let of = |what: &str, value: f64| Figure::reported(format!("{name}.{what}"), value, "1");
    Ok([
        of("regression.over_rigid", judged.ratio()),
        of("regression.itself.over_rigid", itself.spread / judged.rigid_rms),
        of("regression.torsion", of_first.torsion()),
        of("regression.torsion.standard_error", of_first.deviation),
    ])
}
