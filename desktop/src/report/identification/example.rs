//! The report's chapter of identification: the example logs, fitted in this run.
//!
//! The logs are those of `examples/logs`, of an invented joint. Where the folder is not beside the program's source the
//! chapter says so.

use std::path::{Path, PathBuf};

use maud::{Markup, html};

use super::{Outcome, held, moving};
use crate::identify::{
    GearLog, GearOptions, HELD_LOG, MOVING_LOG, Refusal, Verdict, identify_gear, learn_gear,
};
use crate::io::figure::Figure;
use crate::io::file::BadInput;
use crate::io::gear_file::GearFile;
use crate::io::log::{Extra, MeasuredLog};
use crate::report::{Chapter, figure_table};
use crate::verify::Measured;

/// Folder of the logs.
const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/logs");
/// Gear file that the identification starts from, and the logs.
const FILES: [&str; 3] = ["my-joint.toml", "held.csv", "moving.csv"];

pub(in crate::report) fn chapter(progress: &mut dyn FnMut(f64)) -> Result<Chapter, BadInput> {
    of_folder(Path::new(FOLDER), progress)
}

fn of_folder(folder: &Path, progress: &mut dyn FnMut(f64)) -> Result<Chapter, BadInput> {
    let missing: Vec<_> = FILES.into_iter().filter(|name| !folder.join(name).is_file()).collect();
    let (body, measured) = if missing.is_empty() {
        identified(FILES.map(|name| folder.join(name)), progress)?
    } else {
        let why = format!("Not identified: {} of examples/logs is not there.", missing.join(", "));
        (html! { p { (why) } }, Measured::default())
    };
    Ok(Chapter { id: "identification", title: "Identification from logs", body, measured })
}

fn identified(
    [gear, held_log, moving_log]: [PathBuf; 3],
    progress: &mut dyn FnMut(f64),
) -> Result<(Markup, Measured), BadInput> {
    let base = GearFile::read(&gear)?;
    let (held, mut figures) = of_held(&base, &held_log, &mut |fraction| progress(0.5 * fraction))?;
    let (moving, more) = of_moving(&base, &moving_log, &mut |fraction| progress(0.5 + 0.5 * fraction))?;
    figures.extend(more);
    let measured = Measured::from(figures);
    let body = html! {
        p {
            "The logs of " code { "examples/logs" } ", of an invented joint that is softer by a tenth than its gear file says, has twice the hysteresis, half as much "
            "friction again and a kinematic error of its own. The first half of each log trains, the rest is predicted. "
            code { "strainwave identify LOG.csv --report FILE.html" } " writes a whole page of each."
        }
        h3 { "Held: stiffness and hysteresis" } (held)
        h3 { "Moving: friction and kinematic error" } (moving)
        h3 { "Figures" }
        (figure_table(&measured))
    };
    Ok((body, measured))
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// What both kinds of logs come to, beside the base gear: errors over what was held out.
fn judged(kind: &str, [trained, held_out, base]: [Option<f64>; 3]) -> Vec<Figure> {
    let figure = |what: &str, value| Figure::reported(format!("report.identify.{kind}.{what}"), value, "rad");
    let all = [("training", trained), ("held_out", held_out), ("base", base)];
    all.into_iter().filter_map(|(what, value)| Some(figure(what, value?))).collect()
}

fn of_held(
    base: &GearFile,
    path: &Path,
    progress: &mut dyn FnMut(f64),
) -> Result<(Markup, Vec<Figure>), BadInput> {
    let refuse = |why: &str| BadInput::new(path, why);
    let (log, _) = MeasuredLog::read_with(path, Extra::Refused)?;
    let logs = [GearLog::of(&log, base).ok_or_else(|| refuse("no log of a held joint"))?];
    let found = identify_gear(base, &logs, &GearOptions::default(), progress)
        .map_err(|why| BadInput::new(path, why))?;
    let held_out = found.held_out_rms.zip(found.base_held_out_rms);
    let refusal = Refusal::of(&found.gear, &found.limits(), held_out).map(|why| why.to_string());
    let mut figures = judged("held", [Some(found.training_rms), found.held_out_rms, found.base_held_out_rms]);
    figures.push(Figure::reported("report.identify.held.stiffness_factor", found.stiffness_factor, "1"));
    let outcome = Outcome {
        logs: &[name(path)],
        output: "",
        verdict: &Verdict::of(refusal, false, HELD_LOG),
        described: None,
        not_identified: &[],
        figures: &[],
    };
    Ok((held::summary(&outcome, base, &logs, &found), figures))
}

fn of_moving(
    base: &GearFile,
    path: &Path,
    progress: &mut dyn FnMut(f64),
) -> Result<(Markup, Vec<Figure>), BadInput> {
    let (log, _) = MeasuredLog::read_with(path, Extra::Refused)?;
    let training = GearOptions::default().training;
    let found = learn_gear(base, &log, training, progress).map_err(|why| BadInput::new(path, why))?;
    let [judgement, before] =
        [&found.judgement, &found.base_judgement].map(|judgement| judgement.as_ref().map(|found| found.rms));
    let held_out = judgement.zip(before);
    let refusal = Refusal::of(&found.gear, &found.friction.limits(), held_out).map(|why| why.to_string());
    let verdict = Verdict::of(refusal, false, MOVING_LOG);
    let figures = judged("moving", [found.training_rms, judgement, before]);
    let body = html! {
        @if verdict != Verdict::Written { p { "Its gear file would be " (verdict) "." } }
        (moving::summary(&name(path), base, &found))
    };
    Ok((body, figures))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logs_that_are_not_there_are_named() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("held.csv"), "").unwrap();
        let chapter = of_folder(folder.path(), &mut |_| ()).unwrap();
        let expected = "<p>Not identified: my-joint.toml, moving.csv of examples/logs is not there.</p>";
        assert_eq!(chapter.body.into_string(), expected);
        assert!(chapter.measured.figures.is_empty());
    }
}
