//! Others on the same splits: `host-tests/rivals/identify.py`, in a virtual environment of its own.
//!
//! Each split is written to a folder of its own, a file for each log with the columns `u`, `y` and `trains` (1 or 0). The script answers
//! with one JSON object: for each split the held-out errors of its models by name, of the span of what trains. Where Python or what it needs is
//! missing nothing is judged, and a note tells why.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::Split;
use crate::io::figure::Figure;
use crate::io::file::BadInput;
use crate::io::log::write_columns;
use crate::verify::Measured;
use crate::verify::bounds::figure_as;

const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../host-tests/rivals/identify.py");
/// Exit code of the script where something that it needs is missing.
const SKIPPED: i32 = 3;
const ROW: &str = "identify.operator.over_rival";

/// Held-out errors of the models, by split and name.
type Errors = BTreeMap<String, BTreeMap<String, f64>>;

/// The rivals' errors, and ours over that of the best of each split.
pub(super) fn measure(splits: &[Split], ours: &[f64]) -> Result<Measured, BadInput> {
    let folder = tempfile::tempdir().map_err(BadInput::message)?;
    for split in splits {
        write(split, &folder.path().join(&split.name))?;
    }
    let errors = match run(folder.path())? {
        Ok(errors) => errors,
        Err(why) => return Ok(Measured::skipped(format!("{ROW}: skipped: {why}"))),
    };
    Ok(judge(splits.iter().map(|split| split.name.as_str()).zip(ours.iter().copied()), &errors).into())
}

fn judge<'a>(ours: impl Iterator<Item = (&'a str, f64)>, errors: &Errors) -> Vec<Figure> {
    let mut figures = Vec::new();
    for (name, ours) in ours {
        let rivals = errors.get(name);
        // A split that the rivals did not answer is not won.
        let best = rivals.into_iter().flatten().map(|(_, error)| *error).min_by(f64::total_cmp);
        figures.push(figure_as(format!("{name}.over_rival"), ROW, ours / best.unwrap_or(f64::NAN)));
        let reported =
            |(rival, error): (&String, &f64)| Figure::reported(format!("{name}.rival.{rival}"), *error, "1");
        figures.extend(rivals.into_iter().flatten().map(reported));
    }
    figures
}

fn write(split: &Split, folder: &Path) -> Result<(), BadInput> {
    std::fs::create_dir(folder).map_err(|error| BadInput::new(folder, error))?;
    let trained = split.trained.iter().map(|log| (log, split.options.training));
    let held_out = split.held_out.iter().map(|log| (log, 0.0));
    for (index, (log, fraction)) in trained.chain(held_out).enumerate() {
        let count = (log.input.len() as f64 * fraction) as usize;
        let trains: Vec<_> = (0..log.input.len()).map(|row| f64::from(u8::from(row < count))).collect();
        let columns: [(String, &[f64]); 3] =
            [("u".into(), &log.input), ("y".into(), &log.output), ("trains".into(), &trains)];
        write_columns(&folder.join(format!("{index:03}.csv")), &columns)?;
    }
    let signed = if split.options.signed { "signed" } else { "bounded" };
    std::fs::write(folder.join("weights"), signed).map_err(|error| BadInput::new(folder, error))
}

/// What the script answers, or why it was skipped.
fn run(folder: &Path) -> Result<Result<Errors, String>, BadInput> {
    let python = std::env::var_os("STRAINWAVE_PYTHON").map_or_else(|| "python3".into(), PathBuf::from);
    let answer = Command::new(&python).arg(SCRIPT).arg(folder).output();
    let done = match answer {
        Ok(done) => done,
        Err(error) => return Ok(Err(format!("{}: {error}", python.display()))),
    };
    let said = String::from_utf8_lossy(&done.stderr);
    let last = said.trim().lines().last().unwrap_or("no reason given").to_owned();
    match done.status.code() {
        Some(0) => serde_json::from_slice(&done.stdout)
            .map(Ok)
            .map_err(|error| BadInput::message(format_args!("{SCRIPT}: {error}"))),
        Some(SKIPPED) => Ok(Err(last)),
        _ => Err(BadInput::message(format_args!("{SCRIPT}: {last}"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ours_is_judged_beside_the_best_rival() {
        let of = |errors: &[(&str, f64)]| -> BTreeMap<String, f64> {
            errors.iter().map(|(name, error)| ((*name).to_owned(), *error)).collect()
        };
        let errors = Errors::from([("a".into(), of(&[("line", 0.4), ("nnls", 0.02)]))]);
        let holds = |ours| judge([("a", ours)].into_iter(), &errors)[0].holds;
        assert!(holds(0.02) && holds(0.01) && !holds(0.021) && !holds(f64::NAN));
        assert!(!judge([("b", 0.01)].into_iter(), &errors)[0].holds);
        assert_eq!(judge([("a", 0.01)].into_iter(), &errors)[1].name, "a.rival.line");
    }
}
