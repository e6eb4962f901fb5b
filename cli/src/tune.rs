//! `tune`: the baselines of a gear, each by the same search with the same objective.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use strainwave_desktop::bench::baseline::{BaselineGains, Kind};
use strainwave_desktop::io::gear_file::Baselines;
use strainwave_desktop::tune::search::{self, Training, Tuned};
use strainwave_desktop::verify::baselines;
use strainwave_desktop::{BadInput, Figure, GearFile};

use crate::figures::{Figures, FiguresArguments, say};
use crate::files;
use crate::progress::Progress;

/// Seeds that gains may be chosen on.
const TRAINING: RangeInclusive<u64> = 1..=999;
/// Fewest evaluations of a search.
const LEAST_BUDGET: u64 = 30;

/// Tune the baselines of a gear, all by one search with one objective, and write their gains into the gear file
///
/// B0 is the motor-side cascade, B1 has a rigid joint's feed-forward too, B2 the stored kinematic error and the wind-up
/// in advance, B3 the output's error fed back. The objective is the geometric mean over S1..S5 of residual vibration,
/// output error, ripple, peak and steady deviation on plants that the controller does not know, doubled by every run
/// that shakes, saturates or diverges. No figure may be paid for by another: what one loses against the untuned baseline
/// counts in full.
#[derive(Args)]
pub struct Arguments {
    /// Gear file of the joint
    #[arg(value_name = "GEAR.toml")]
    gear: PathBuf,
    /// Only this baseline; may be given more than once
    #[arg(long, value_name = "b0|b1|b2|b3", value_parser = kind_parser())]
    only: Vec<Kind>,
    /// Seeds of the training plants, within 1..999
    #[arg(long, value_name = "FIRST..LAST", default_value = "901..906", value_parser = seeds)]
    seeds: RangeInclusive<u64>,
    /// Instead of plants of the file's joint: so many joints with this gear, of other loads and encoders, box and noise
    /// drawn; the gains are transferred to each load by rule
    #[arg(long, value_name = "COUNT", conflicts_with = "seeds", value_parser = clap::value_parser!(u64).range(1..=400))]
    joints: Option<u64>,
    /// Evaluations of the objective for each baseline
    #[arg(long, value_name = "EVALUATIONS", default_value_t = search::BUDGET, value_parser = clap::value_parser!(u64).range(LEAST_BUDGET..=100_000))]
    budget: u64,
    /// Write the gear file again, to this file, with the gains as its [baselines]; it may be GEAR.toml itself
    #[arg(long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Tune nothing: run each baseline with the gains of the gear file on so many plants, from seed 1 on
    #[arg(long, value_name = "PLANTS", conflicts_with_all = ["budget", "output", "only", "seeds", "joints"])]
    report: Option<u64>,
    #[command(flatten)]
    figures: FiguresArguments,
}

fn kind_parser() -> impl TypedValueParser<Value = Kind> {
    PossibleValuesParser::new(Kind::ALL.map(Kind::name))
        .try_map(|name| Kind::ALL.into_iter().find(|kind| kind.name() == name).ok_or("no such baseline"))
}

fn seeds(text: &str) -> Result<RangeInclusive<u64>, String> {
    let allowed = || format!("allowed: FIRST..LAST within {}..{}", TRAINING.start(), TRAINING.end());
    let (first, last) = text.split_once("..").ok_or_else(allowed)?;
    let seed = |text: &str| text.parse().ok().filter(|seed| TRAINING.contains(seed)).ok_or_else(allowed);
    let (first, last) = (seed(first)?, seed(last)?);
    if first > last { Err(allowed()) } else { Ok(first..=last) }
}

/// Searches, prints and writes.
pub fn run(arguments: &Arguments) -> Result<Figures, BadInput> {
    let json = arguments.figures.json.as_deref();
    files::require_distinct(&[("GEAR.toml", Some(&arguments.gear)), ("--json", json)])?;
    files::require_distinct(&[("--output", arguments.output.as_deref()), ("--json", json)])?;
    let (file, text) = GearFile::read_with_text(&arguments.gear)?;
    let file = file.without_belt(&arguments.gear)?;
    file.require_firmware_friction().map_err(|why| BadInput::new(&arguments.gear, why))?;
    for path in [arguments.output.as_deref(), json] {
        files::require_writable(path)?;
    }
    if let Some(plants) = arguments.report {
        let mut progress = Progress::new(1000, "baselines");
        let measured = baselines::measure(&file, plants, |fraction| progress.set((fraction * 1e3) as u64))
            .map_err(BadInput::message)?;
        drop(progress);
        return Ok(Figures::new(measured.figures, &arguments.figures));
    }
    let (mut kept, mut figures) = (Baselines::default(), Vec::new());
    for kind in
        Kind::ALL.into_iter().filter(|kind| arguments.only.is_empty() || arguments.only.contains(kind))
    {
        let found = tune(arguments, &file, kind)?;
        kept.set(kind, &found.after.0);
        figures.extend(of(&found));
        if let Some(path) = &arguments.output {
            kept.keep_in(&text, path)?;
        }
    }
    Ok(Figures::new(figures, &arguments.figures))
}

fn tune(arguments: &Arguments, file: &GearFile, kind: Kind) -> Result<Tuned, BadInput> {
    let mut progress = Progress::new(1000, kind.name());
    let training =
        arguments.joints.map_or_else(|| Training::Plants(arguments.seeds.clone()), Training::Joints);
    let found = search::tune(file, kind, &training, arguments.budget, |fraction| {
        progress.set((fraction * 1e3) as u64)
    })
    .map_err(BadInput::message)?;
    drop(progress);
    say(format_args!("{}: {}", kind.name(), describe(kind, &found.after.0)));
    Ok(found)
}

/// The gains in one line.
fn describe(kind: Kind, gains: &BaselineGains) -> String {
    let gain =
        |gain: &strainwave_desktop::bench::baseline::Gain| format!("{} {:.4}", gain.key, (gain.get)(gains));
    kind.gains().map(gain).collect::<Vec<_>>().join(", ")
}

fn of(found: &Tuned) -> Vec<Figure> {
    let name = |what: &str| format!("tune.{}.{what}", found.kind.name());
    let (before, after) = (found.before.1, found.after.1);
    vec![
        Figure::reported(name("mean_before"), before.mean, "rad"),
        Figure::reported(name("bad_before"), before.bad as f64, "1"),
        Figure::reported(name("mean_after"), after.mean, "rad"),
        Figure::reported(name("bad_after"), after.bad as f64, "1"),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_are_training_seeds() {
        assert_eq!(seeds("901..906"), Ok(search::SEEDS));
        for wrong in ["0..3", "5..1000", "7..6", "5", "a..b", ""] {
            assert!(seeds(wrong).unwrap_err().contains("1..999"), "{wrong}");
        }
    }
}
