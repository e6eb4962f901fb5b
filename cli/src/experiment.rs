//! `experiment`: the motion that shows the parameters of a moving joint best.

use std::path::PathBuf;

use clap::{Args, value_parser};
use strainwave_desktop::design::buildable::buildable;
use strainwave_desktop::experiment::{self, MOST_PARTS, Plan, StandardErrors};
use strainwave_desktop::io::log::write_columns;
use strainwave_desktop::{BadInput, Figure, GearFile};

use crate::figures::{Figures, FiguresArguments, columns, tell};
use crate::files;
use crate::progress::Progress;

/// Write the motion of a joint that shows its parameters best, within its limits
///
/// For a log of `identify --moving`: friction, inertia, weight and kinematic error. The motion is made of parts of 8 s: slow
/// triangles of growing amplitude, several speeds both ways, a chirp, a swing of a pendulum in several sizes, none twice, chosen so that the determinant of the Fisher
/// information is largest. Its columns are those that `pil --trajectory` reads: t_s, theta_rad, the latter counting from
/// where the joint stands. The table shows the standard error of each parameter before, with the plan, and with the best
/// motion of each kind alone over the same time.
#[derive(Args)]
pub struct Arguments {
    /// Gear file
    #[arg(value_name = "GEAR.toml")]
    gear: PathBuf,
    /// Motion to write (CSV), complete or not at all; - for the standard output
    #[arg(long, value_name = "PLAN.csv")]
    output: PathBuf,
    /// Farthest that the output may move either way of where it stands (rad), 0.001 to 1000; 0.5 when left out
    #[arg(long, value_name = "RAD", allow_hyphen_values = true, default_value_t = 0.5)]
    range: f64,
    /// Number of its parts of 8 s, 1 to 5
    #[arg(long, value_name = "COUNT", allow_hyphen_values = true, default_value_t = 5,
          value_parser = value_parser!(u32).range(1..=MOST_PARTS as i64))]
    parts: u32,
    #[command(flatten)]
    figures: FiguresArguments,
}

/// Least and most of `--range` (rad).
const RANGE: [f64; 2] = [0.001, 1000.0];

/// Chooses and writes.
pub fn run(arguments: &Arguments) -> Result<Figures, BadInput> {
    let json = arguments.figures.json.as_deref();
    files::require_distinct(&[
        ("GEAR.toml", Some(&arguments.gear)),
        ("--output", Some(&arguments.output)),
        ("--json", json),
    ])?;
    let gear = GearFile::read(&arguments.gear)?;
    buildable(&gear).map_err(|why| BadInput::new(&arguments.gear, why))?;
    let range = arguments.range;
    if !(RANGE[0]..=RANGE[1]).contains(&range) {
        let why = format_args!("--range {range} is out of range; allowed: a number from 0.001 to 1000 rad");
        return Err(BadInput::message(why));
    }
    files::require_writable(Some(&arguments.output))?;
    files::require_writable(json)?;
    let mut progress = Progress::new(1000, "sensitivities");
    let plan = experiment::plan(&gear, range, arguments.parts as usize, |fraction| {
        progress.set((fraction * 1e3) as u64);
    })
    .map_err(|why| BadInput::new(&arguments.gear, why))?;
    drop(progress);
    let stamps = plan.stamps();
    write_columns(&arguments.output, &[("t_s".into(), &stamps), ("theta_rad".into(), &plan.position)])?;
    let seconds = experiment::duration(plan.parts.len());
    tell(
        &arguments.output,
        format_args!("{seconds} s in {} parts of {} s:", plan.parts.len(), experiment::duration(1)),
    );
    plan.parts.iter().for_each(|part| tell(&arguments.output, format_args!("    {part}")));
    tell(&arguments.output, format_args!("{}", columns(&table(&plan))));
    Ok(Figures::silent(figures(&plan), &arguments.figures))
}

/// Each motion's errors, by the motion's name.
fn motions(plan: &Plan) -> impl Iterator<Item = (&'static str, &StandardErrors)> {
    [("plan", &plan.errors)].into_iter().chain(plan.plain.iter().map(|(name, errors)| (*name, errors)))
}

/// Standard errors for people: a row each parameter.
fn table(plan: &Plan) -> Vec<Vec<String>> {
    let names = motions(plan).map(|(name, _)| name.to_owned());
    let header = ["standard error", "unit", "before"].map(String::from).into_iter().chain(names).collect();
    let mut rows = vec![header];
    for (place, (parameter, before)) in plan.priors.iter().enumerate() {
        let start = [parameter.name(), parameter.unit().into(), format!("{before:.3e}")];
        let errors = motions(plan).map(|(_, motion)| format!("{:.3e}", motion.errors[place].1));
        rows.push(start.into_iter().chain(errors).collect());
    }
    let determinants = motions(plan).map(|(_, motion)| format!("{:.2}", motion.log_determinant));
    let start = ["log det of the information", "1", "0.00"].map(String::from);
    rows.push(start.into_iter().chain(determinants).collect());
    rows
}

fn figures(plan: &Plan) -> Vec<Figure> {
    let figure = |(name, motion): (&'static str, &StandardErrors)| {
        let errors = motion.errors.iter().map(move |(parameter, error)| {
            Figure::reported(format!("experiment.{name}.{}", parameter.name()), *error, parameter.unit())
        });
        let determinant =
            Figure::reported(format!("experiment.{name}.log_determinant"), motion.log_determinant, "1");
        errors.chain([determinant]).collect::<Vec<_>>()
    };
    motions(plan).flat_map(figure).collect()
}
