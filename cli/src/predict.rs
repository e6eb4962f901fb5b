//! `predict`: a measured log predicted blind.

use std::convert::Infallible;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::Args;
use strainwave_desktop::design::buildable::buildable;
use strainwave_desktop::io::log::write_columns;
use strainwave_desktop::predict::{Deviation, Prediction, Quantity, predict};
use strainwave_desktop::report::plot::{Page, Panel, Series};
use strainwave_desktop::{BadInput, Figure, GearFile};

use crate::figures::{Figures, FiguresArguments, columns, tell};
use crate::files;
use crate::logs::Reading;
use crate::progress::Progress;

/// Predict a measured log blind with the real-time model of a gear file, beside a rigid joint
///
/// Predicted are the output angle from motor angle and torque by the firmware's observer, the motor torque from the motion, and
/// where the output torque is measured the torsion from it. An angle has an arbitrary zero: a prediction starts with the
/// measured angle of the first row. For each quantity that the log has, the table tells the error as it is, its constant
/// offset, and its shape, what is left without the offset, beside those of a rigid joint with the inertia, Coulomb and viscous
/// friction of the file. Without tau_out_nm nothing but inertia and friction is taken to load the output: gravity is then
/// an error of the motor torque. A shape that is worse than the rigid joint's misses its bound.
#[derive(Args)]
pub struct Arguments {
    /// Measured log; - for the standard input
    #[arg(value_name = "LOG.csv")]
    log: PathBuf,
    /// Gear file
    #[arg(long, value_name = "G.toml")]
    gear: PathBuf,
    /// Measured and predicted columns, a row for each of the log, complete or not at all; - for the standard output
    #[arg(long, value_name = "OUT.csv")]
    output: PathBuf,
    /// State of the gear in the first row: `first`, at rest there, or warmed up by a log of the joint that was recorded just before
    #[arg(long, value_name = "first|BEFORE.csv", default_value = "first")]
    start: Start,
    /// The log's motor torque counts against its motor angle
    #[arg(long)]
    reversed_torque: bool,
    /// Read logs that have other columns, too, without those
    #[arg(long)]
    ignore_extra: bool,
    /// Draw measurements, predictions and errors to this file (SVG)
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
    #[command(flatten)]
    figures: FiguresArguments,
}

#[derive(Clone)]
enum Start {
    First,
    After(PathBuf),
}

impl FromStr for Start {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(if text == "first" { Self::First } else { Self::After(text.into()) })
    }
}

impl Start {
    fn path(&self) -> Option<&Path> {
        match self {
            Self::First => None,
            Self::After(path) => Some(path),
        }
    }
}

/// Reads, predicts and writes.
pub fn run(arguments: &Arguments) -> Result<Figures, BadInput> {
    let (json, before) = (arguments.figures.json.as_deref(), arguments.start.path());
    files::require_distinct(&[
        ("LOG.csv", Some(&arguments.log)),
        ("--start", before),
        ("--gear", Some(&arguments.gear)),
        ("--output", Some(&arguments.output)),
        ("--plot", arguments.plot.as_deref()),
        ("--json", json),
    ])?;
    let gear = GearFile::read(&arguments.gear)?;
    buildable(&gear).map_err(|why| BadInput::new(&arguments.gear, why))?;
    let Arguments { ignore_extra, reversed_torque, .. } = *arguments;
    let read = |path| Reading { ignore_extra, reversed_torque }.log(path, &gear);
    let (log, warming) = (read(&arguments.log)?, before.map(read).transpose()?);
    for path in [Some(arguments.output.as_path()), arguments.plot.as_deref(), json] {
        files::require_writable(path)?;
    }
    let mut progress = Progress::new(1000, "predicting");
    let found = predict(&gear, &log, warming.as_ref(), |fraction| progress.set((fraction * 1e3) as u64))
        .map_err(|why| BadInput::new(before.unwrap_or(&arguments.gear), why))?;
    drop(progress);
    write_columns(&arguments.output, &found.columns())?;
    if let Some(path) = &arguments.plot {
        plot(&found).write(path)?;
    }
    tell(&arguments.output, format_args!("{}", table(&found)));
    Ok(Figures::silent(figures(&found), &arguments.figures))
}

/// What was measured, with the errors of the model and of the rigid joint.
fn judged(found: &Prediction) -> impl Iterator<Item = (&Quantity, [Deviation; 2])> {
    found.quantities.iter().filter_map(|quantity| Some((quantity, quantity.deviations()?)))
}

fn table(found: &Prediction) -> String {
    let header = ["error", "unit", "rms", "max", "offset", "shape rms", "shape max"].map(String::from);
    let mut rows = vec![header.to_vec()];
    for (quantity, deviations) in judged(found) {
        for (model, of) in ["", " of a rigid joint"].into_iter().zip(deviations) {
            let numbers =
                [of.rms, of.max, of.offset, of.shape_rms, of.shape_max].map(|value| format!("{value:.3e}"));
            let name = format!("{}{model}", quantity.name);
            rows.push([vec![name, quantity.unit.to_owned()], numbers.to_vec()].concat());
        }
    }
    columns(&rows)
}

fn figures(found: &Prediction) -> Vec<Figure> {
    let of = |(quantity, [model, rigid]): (&Quantity, [Deviation; 2])| {
        let reported = |what: &str, value| {
            Figure::reported(format!("predict.{}.{what}", quantity.name), value, quantity.unit)
        };
        let shape = format!("predict.{}.shape.rms", quantity.name);
        vec![
            reported("rms", model.rms),
            reported("max", model.max),
            reported("offset", model.offset),
            // A model that predicts worse than none has failed.
            Figure::bounded(shape, model.shape_rms, quantity.unit, rigid.shape_rms),
            reported("shape.max", model.shape_max),
            reported("rigid.rms", rigid.rms),
            reported("rigid.max", rigid.max),
            reported("rigid.offset", rigid.offset),
            reported("rigid.shape.rms", rigid.shape_rms),
            reported("rigid.shape.max", rigid.shape_max),
        ]
    };
    judged(found).flat_map(of).collect()
}

/// Errors of the angles, and the motor torque itself.
fn plot(found: &Prediction) -> Page {
    let page = Page::slide("Blind prediction of a measured log");
    judged(found).fold(page, |page, (quantity, _)| page.with(panel(&found.time, quantity)))
}

fn panel(time: &[f64], quantity: &Quantity) -> Panel {
    let time: Vec<_> = time.iter().map(|stamp| stamp - time[0]).collect();
    let Some(measured) = &quantity.measured else {
        return Panel::new("time", "s", quantity.name, quantity.unit);
    };
    if quantity.unit == "rad" {
        let error = |of: &[f64]| of.iter().zip(measured).map(|(p, m)| (p - m) * 1e6).collect::<Vec<_>>();
        let name = format!("{}: predicted - measured", quantity.name);
        return Panel::new("time", "s", &name, "urad")
            .with(Series::dashed("rigid joint", &time, &error(&quantity.rigid)))
            .with(Series::line("model", &time, &error(&quantity.predicted)));
    }
    Panel::new("time", "s", &quantity.name.replace('_', " "), quantity.unit)
        .with(Series::broad("measured", &time, measured))
        .with(Series::dashed("rigid joint", &time, &quantity.rigid))
        .with(Series::line("model", &time, &quantity.predicted))
}
