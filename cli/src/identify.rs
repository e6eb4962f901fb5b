//! `identify`: a gear file from measured logs.

use std::path::{Path, PathBuf};

use clap::Args;
use strainwave_desktop::design::buildable::buildable;
use strainwave_desktop::identify::joint::LEVELS;
use strainwave_desktop::identify::{
    GearLog, GearOptions, HELD_LOG, IdentifiedGear, LearntGear, MOVING_LOG, NotIdentified, OperatorOptions,
    Refusal, Smoothing, Verdict, identify_gear, learn_gear,
};
use strainwave_desktop::io::log::Jitter;
use strainwave_desktop::report::identification;
use strainwave_desktop::report::plot::{Page, Panel, Series};
use strainwave_desktop::{BadInput, Figure, GearFile};

use crate::figures::{Figures, FiguresArguments, tell};
use crate::files;
use crate::identification_page::{IdentificationPageArguments, Told};
use crate::identification_verdict::{complain_of, was_written};
use crate::logs::Reading;
use crate::progress::Progress;
use crate::{operator, pil_plots};

/// Fraction of a log that trains, when it is left out.
pub const TRAINING: f64 = 0.5;

/// Identify a gear from measured logs, of the held joint its hysteresis, of a moving one the rest, and write its gear file
///
/// A log has the columns t_s, theta_motor_rad, tau_motor_nm, theta_out_rad and tau_out_nm; SI units. Its torque must
/// reverse, its motor hold the joint: loops up to rated torque, with smaller ones between, show the most. Its time stamps are
/// resampled to their median interval. Identified are one factor on the stiffness line of the base gear, the offset and
/// the start state of each log, and where the torque of a log goes both ways the weights of the Preisach operator, torque
/// over torsion. The first part of each log trains; how smooth the weights are is chosen by cross-validation within it. Where a log does not
/// reach, the weights are those of the base gear. The rest is predicted, and so it is by the base gear: a gear file is not
/// written, and the exit code is 1, where it predicts worse than the base gear, where `strainwave check` would refuse it, or
/// where a parameter ends at the limit of its search.
///
/// With --operator it is the Preisach operator of any actuator, from logs with the columns u and y.
#[derive(Args)]
pub struct Arguments {
    /// Measured logs of one joint; - for the standard input
    #[arg(value_name = "LOG.csv", required = true)]
    logs: Vec<PathBuf>,
    /// Base gear: all that is not identified is taken from it
    #[arg(long, value_name = "G.toml", required_unless_present = "operator")]
    gear: Option<PathBuf>,
    /// Gear file to write, or with --operator the operator's, complete or not at all; - for the standard output
    #[arg(long, value_name = "OUT.toml")]
    output: PathBuf,
    /// Fraction of each log, from its start, that trains; 0.2 to 1
    #[arg(long, value_name = "FRACTION", default_value_t = TRAINING, allow_hyphen_values = true)]
    training: f64,
    /// The joint moves: learn friction and kinematic error instead, from one log
    ///
    /// Needed are t_s, theta_motor_rad and tau_motor_nm; without theta_out_rad the friction alone is learnt. The fraction that trains is that of the motor's path. What
    /// is learnt: the input friction by its own law, each parameter with its standard error and a verdict, orders of the kinematic error at the log's motor angle, the error
    /// of the output encoder's scale, and how far the observer trusts the motor torque. The stiffness stays the base
    /// gear's: a moving joint's log does not tell it from the load.
    #[arg(long, conflicts_with_all = ["levels", "smoothing"])]
    moving: bool,
    /// The logs are of any actuator, input u and output y in any units: identify its Preisach operator
    ///
    /// A column t_s may be there and counts for nothing. Identified are a line and weights on a triangle of L x L levels, which need
    /// not be symmetric, all of one sign: that with which the output lags its input, or leads it. A log may start in any
    /// state. Levels and smoothness are chosen by cross-validation on loops within what trains. The table
    /// tells the errors in % of the span beside those of a straight line; where that predicts better the file is not
    /// written, and the exit code is 1.
    #[arg(long, conflicts_with = "moving")]
    operator: bool,
    /// Of --operator, weights of either sign: loops that cross themselves, such as a butterfly
    #[arg(long, requires = "operator")]
    signed: bool,
    /// Of --operator, a log that does not train and is predicted; may be given several times
    #[arg(long, value_name = "LOG.csv", requires = "operator")]
    predict: Vec<PathBuf>,
    /// The motor torque counts against the motor angle
    #[arg(long, requires = "moving")]
    reversed_torque: bool,
    /// Write a gear file that would not be written, unless it could not be read again
    #[arg(long)]
    force: bool,
    /// Read logs that have other columns, too, without those
    #[arg(long)]
    ignore_extra: bool,
    /// Levels of the grid, 6, 8, 12 or 24, of --operator 2 to 64; chosen by cross-validation when left out
    #[arg(long, value_name = "L")]
    levels: Option<usize>,
    /// Factor of the smoothness, from 1e-12; chosen by cross-validation when left out
    ///
    /// Of the mean square of the torsion's residual over its span: 1 keeps the base gear's weights, below 1e-8 hardly
    /// any smoothness is left.
    #[arg(long, value_name = "FACTOR", allow_hyphen_values = true)]
    smoothing: Option<f64>,
    /// Draw the measured and the predicted loops to this file (SVG)
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
    #[command(flatten)]
    page: IdentificationPageArguments,
    #[command(flatten)]
    figures: FiguresArguments,
}

/// Least factor of the smoothness.
const LEAST_SMOOTHING: f64 = 1e-12;

/// Reads, identifies and writes.
pub fn run(arguments: &Arguments) -> Result<Figures, BadInput> {
    let json = arguments.figures.json.as_deref();
    let named = [
        ("--gear", arguments.gear.as_deref()),
        ("--output", Some(&arguments.output)),
        ("--plot", arguments.plot.as_deref()),
        ("--report", arguments.page.path()),
        ("--json", json),
    ];
    let logs = arguments.logs.iter().map(|log| ("LOG.csv", Some(log.as_path())));
    let predicted = arguments.predict.iter().map(|log| ("--predict", Some(log.as_path())));
    files::require_distinct(&logs.chain(predicted).chain(named).collect::<Vec<_>>())?;
    let (training, smoothing) = (training(arguments)?, smoothing(arguments)?);
    let path = match &arguments.gear {
        Some(_) if arguments.operator => {
            return Err(BadInput::message("--gear with --operator; allowed: one of the two"));
        }
        Some(path) => path,
        None => return operator(arguments, training, smoothing),
    };
    let options = GearOptions { training, levels: gear_levels(arguments)?, smoothing };
    let base = GearFile::read(path)?;
    if arguments.moving {
        return moving(arguments, path, &base);
    }
    let read = |path: &PathBuf| read(path, &base, &options, reading(arguments));
    let (logs, jitters): (Vec<_>, Vec<_>) =
        arguments.logs.iter().map(read).collect::<Result<Vec<_>, _>>()?.into_iter().unzip();
    for path in [Some(arguments.output.as_path()), arguments.plot.as_deref(), json] {
        files::require_writable(path)?;
    }
    arguments.page.require_writable()?;
    let mut progress = Progress::new(1000, "identifying");
    let found = identify_gear(&base, &logs, &options, |fraction| progress.set((fraction * 1e3) as u64))
        .map_err(BadInput::message)?;
    drop(progress);
    let held_out = found.held_out_rms.zip(found.base_held_out_rms);
    let refusal = Refusal::of(&found.gear, &found.limits(), held_out);
    let verdict = write(arguments, &found.gear, refusal, HELD_LOG)?;
    if let Some(path) = &arguments.plot {
        plot(&logs, &found).write(path)?;
    }
    let (described, not_identified) = (describe(&found), found.not_identified());
    described.iter().for_each(|line| tell(&arguments.output, format_args!("{line}")));
    not_identified.iter().for_each(|line| tell(&arguments.output, format_args!("{line}")));
    let jitters = jitters.iter().flat_map(Jitter::figures);
    let figures = jitters.chain([was_written(&verdict)]).chain(figures(&found)).collect::<Vec<_>>();
    let told =
        Told { described: described.as_deref(), ..told(arguments, &verdict, &not_identified, &figures) };
    arguments.page.write(&told, |outcome| identification::held(outcome, &base, &logs, &found))?;
    Ok(Figures::beside(&arguments.output, figures, &arguments.figures))
}

/// Learns from a moving joint's log.
fn moving(arguments: &Arguments, gear: &Path, base: &GearFile) -> Result<Figures, BadInput> {
    let [path] = arguments.logs.as_slice() else {
        let why = format_args!("--moving with {} logs; allowed: one", arguments.logs.len());
        return Err(BadInput::message(why));
    };
    buildable(base).map_err(|why| BadInput::new(gear, why))?;
    let log = reading(arguments).log(path, base)?;
    if arguments.plot.is_some() && log.output_position.is_none() {
        return Err(BadInput::new(path, "column theta_out_rad is missing; --plot shows it"));
    }
    for path in
        [Some(arguments.output.as_path()), arguments.plot.as_deref(), arguments.figures.json.as_deref()]
    {
        files::require_writable(path)?;
    }
    arguments.page.require_writable()?;
    let mut progress = Progress::new(1000, "learning");
    let found = learn_gear(base, &log, arguments.training, |fraction| progress.set((fraction * 1e3) as u64))
        .map_err(|why| BadInput::new(path, why))?;
    drop(progress);
    let held_out = found.judgement.zip(found.base_judgement).map(|(found, base)| (found.rms, base.rms));
    let refusal = Refusal::of(&found.gear, &found.friction.limits(), held_out);
    let verdict = write(arguments, &found.gear, refusal, MOVING_LOG)?;
    if let Some(path) = &arguments.plot {
        pil_plots::replay(&found.rows, Some(found.learnt)).write(path)?;
    }
    let learnt = found.friction.parameters.iter().map(ToString::to_string);
    learnt.chain(found.friction.beyond()).for_each(|line| tell(&arguments.output, format_args!("{line}")));
    let not_identified = found.not_identified();
    not_identified.iter().for_each(|line| tell(&arguments.output, format_args!("{line}")));
    let jitter = log.time.jitter().into_iter().flat_map(|jitter| jitter.figures());
    let figures = jitter.chain([was_written(&verdict)]).chain(moving_figures(&found)).collect::<Vec<_>>();
    let told = told(arguments, &verdict, &not_identified, &figures);
    arguments.page.write(&told, |outcome| identification::moving(outcome, base, &found))?;
    Ok(Figures::beside(&arguments.output, figures, &arguments.figures))
}

/// Writes the gear file, unless it is refused and not forced; one line tells why, and which log would help.
fn write(
    arguments: &Arguments,
    gear: &GearFile,
    refusal: Option<Refusal>,
    helps: &'static str,
) -> Result<Verdict, BadInput> {
    let forced = arguments.force && gear.check().is_ok();
    let verdict = Verdict::of(refusal.map(|why| why.to_string()), forced, helps);
    complain_of(&arguments.output, &verdict);
    if verdict.is_written() {
        gear.write(&arguments.output)?;
    }
    Ok(verdict)
}

fn told<'a>(
    arguments: &'a Arguments,
    verdict: &'a Verdict,
    not_identified: &'a [NotIdentified],
    figures: &'a [Figure],
) -> Told<'a> {
    let logs = arguments.logs.iter().map(PathBuf::as_path).collect();
    Told { logs, output: &arguments.output, verdict, described: None, not_identified, figures }
}

fn moving_figures(found: &LearntGear) -> Vec<Figure> {
    let mut figures = vec![
        Figure::reported("identify.training.time", found.learnt, "s"),
        Figure::reported("identify.training.turns", found.revolutions, "1"),
        Figure::reported("identify.friction_factor", found.friction.level, "1"),
        Figure::reported("identify.viscous_factor", found.friction.viscous, "1"),
        Figure::reported("identify.friction.residual", found.friction.residual, "N m"),
    ];
    let wander = found.gear.compensation.external_torque_wander;
    let of_output = [
        ("identify.training.rms", found.training_rms, "rad"),
        ("identify.external_torque_wander", wander, "N m/s^0.5"),
    ];
    figures.extend(
        of_output.into_iter().filter_map(|(name, value, unit)| Some(Figure::reported(name, value?, unit))),
    );
    for learnt in &found.friction.parameters {
        let (name, unit) = (format!("identify.friction.{}", learnt.parameter.key()), learnt.parameter.unit());
        figures.push(Figure::reported(name.clone(), learnt.value, unit));
        figures.push(Figure::reported(format!("{name}.standard_error"), learnt.deviation, unit));
    }
    for harmonic in found.gear.kinematic_error.flexspline.iter().filter(|_| found.errors) {
        let name = format!("identify.kinematic_error.order_{}", harmonic.order);
        figures.push(Figure::reported(name, harmonic.amplitude, "rad"));
    }
    if let Some(judgement) = &found.judgement {
        // What predicts worse than no model at all has failed.
        figures.push(Figure::bounded("identify.held_out.rms", judgement.rms, "rad", judgement.rigid_rms));
        figures.push(Figure::reported("identify.held_out.rigid.rms", judgement.rigid_rms, "rad"));
    }
    if let Some(base) = &found.base_judgement {
        figures.push(Figure::reported("identify.held_out.base.rms", base.rms, "rad"));
    }
    figures
}

fn operator(arguments: &Arguments, training: f64, smoothing: Smoothing) -> Result<Figures, BadInput> {
    let Arguments { levels, signed, .. } = *arguments;
    operator::run(&operator::Request {
        logs: &arguments.logs,
        predicted: &arguments.predict,
        output: &arguments.output,
        plot: arguments.plot.as_deref(),
        page: &arguments.page,
        options: OperatorOptions { training, levels, smoothing, signed },
        reading: reading(arguments),
        force: arguments.force,
        figures: &arguments.figures,
    })
}

fn refuse<T>(option: &str, value: f64, allowed: &str) -> Result<T, BadInput> {
    Err(BadInput::message(format_args!("{option} {value} is out of range; allowed: {allowed}")))
}

fn training(arguments: &Arguments) -> Result<f64, BadInput> {
    match arguments.training {
        fraction if (0.2..=1.0).contains(&fraction) => Ok(fraction),
        fraction => refuse("--training", fraction, "a number from 0.2 to 1"),
    }
}

fn gear_levels(arguments: &Arguments) -> Result<Option<usize>, BadInput> {
    match arguments.levels.filter(|levels| !LEVELS.contains(levels)) {
        Some(levels) => refuse("--levels", levels as f64, "6, 8, 12 or 24"),
        None => Ok(arguments.levels),
    }
}

fn smoothing(arguments: &Arguments) -> Result<Smoothing, BadInput> {
    match arguments.smoothing {
        None => Ok(Smoothing::Chosen),
        Some(factor) if (LEAST_SMOOTHING..=1e6).contains(&factor) => Ok(Smoothing::Given(factor)),
        Some(factor) => refuse("--smoothing", factor, "a number from 1e-12 to 1e6"),
    }
}

fn reading(arguments: &Arguments) -> Reading {
    let Arguments { ignore_extra, reversed_torque, .. } = *arguments;
    Reading { ignore_extra, reversed_torque }
}

/// A log that has what the torsion and its torque are.
fn read(
    path: &Path,
    gear: &GearFile,
    options: &GearOptions,
    reading: Reading,
) -> Result<(GearLog, Jitter), BadInput> {
    let log = reading.log(path, gear)?;
    let missing = match (&log.output_position, &log.output_torque) {
        (None, _) => Some("theta_out_rad"),
        (_, None) => Some("tau_out_nm"),
        _ => None,
    };
    if let Some(column) = missing {
        let why = format!("column {column} is missing; the torsion and the torque at the output are needed");
        return Err(BadInput::new(path, why));
    }
    let refuse = |why: strainwave_desktop::identify::Error| BadInput::new(path, why);
    let found = GearLog::of(&log, gear).and_then(|found| Some((found, log.time.jitter()?)));
    let (found, jitter) = found.ok_or_else(|| BadInput::new(path, "a single row; a log is needed"))?;
    found.training(options.training).map_err(refuse)?;
    Ok((found, jitter))
}

fn describe(found: &IdentifiedGear) -> Option<String> {
    found.table.as_ref().map(|table| {
        format!(
            "weights on {} levels, smoothness {:e}; the logs moved {:.0} % of the cells, in the others the weights tend to \
             the base gear's",
            table.levels,
            table.smoothing,
            100.0 * table.excitation.fraction()
        )
    })
}

fn figures(found: &IdentifiedGear) -> Vec<Figure> {
    let width = found.gear.hysteresis.width();
    let mut figures = vec![
        Figure::reported("identify.stiffness_factor", found.stiffness_factor, "1"),
        Figure::reported("identify.stiffness_deviation", found.stiffness_deviation, "1"),
        Figure::reported("identify.hysteresis.width", width, "rad"),
    ];
    if let Some(table) = &found.table {
        figures.extend([
            Figure::reported("identify.hysteresis.levels", table.levels as f64, "1"),
            Figure::reported("identify.hysteresis.smoothing", table.smoothing, "1"),
            Figure::reported("identify.hysteresis.excited", table.excitation.fraction(), "1"),
            Figure::reported("identify.validation.rms", table.validation_rms, "rad"),
        ]);
    }
    figures.push(Figure::reported("identify.training.rms", found.training_rms, "rad"));
    if let (Some(rms), Some(base)) = (found.held_out_rms, found.base_held_out_rms) {
        // What predicts worse than the gear that it came from has failed.
        figures.push(Figure::bounded("identify.held_out.rms", rms, "rad", base));
        figures.push(Figure::reported("identify.held_out.base.rms", base, "rad"));
    }
    figures
}

/// Torque over torsion and what is left, log by log.
fn plot(logs: &[GearLog], found: &IdentifiedGear) -> Page {
    let mut page = Page::new(format!("{}: identified hysteresis", found.gear.gear.name));
    for (log, predicted) in logs.iter().zip(&found.predicted) {
        let micro = |values: &[f64]| values.iter().map(|value| value * 1e6).collect::<Vec<_>>();
        let missed: Vec<_> = log.torsion.iter().zip(predicted).map(|(a, b)| (a - b) * 1e6).collect();
        page = page
            .with(
                Panel::new("torsion", "urad", "torque", "N m")
                    .with(Series::line("measured", &micro(&log.torsion), &log.torque))
                    .with(Series::line("identified", &micro(predicted), &log.torque)),
            )
            .with(
                Panel::new("time", "s", "measured - identified", "urad")
                    .with(Series::line("", &log.time, &missed)),
            );
    }
    page
}
