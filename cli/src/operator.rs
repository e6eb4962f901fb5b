//! `identify --operator`: the Preisach operator of any actuator from its input and output.

use std::path::{Path, PathBuf};

use strainwave_desktop::identify::operator::{Errors, LEVELS};
use strainwave_desktop::identify::{
    IdentifiedOperator, OPERATOR_LOG, Operator, OperatorOptions, Verdict, identify_operator,
};
use strainwave_desktop::io::log::InputOutput;
use strainwave_desktop::report::identification;
use strainwave_desktop::report::plot::{Page, Panel, Series};
use strainwave_desktop::{BadInput, Figure};

use crate::figures::{Figures, FiguresArguments, columns, tell};
use crate::files;
use crate::identification_page::{IdentificationPageArguments, Told};
use crate::identification_verdict::{complain_of, was_written};
use crate::logs::Reading;
use crate::progress::Progress;

/// What is asked for.
pub struct Request<'a> {
    pub logs: &'a [PathBuf],
    /// Logs that do not train.
    pub predicted: &'a [PathBuf],
    pub output: &'a Path,
    pub plot: Option<&'a Path>,
    pub page: &'a IdentificationPageArguments,
    pub options: OperatorOptions,
    pub reading: Reading,
    /// The file is written even where a straight line predicts better.
    pub force: bool,
    pub figures: &'a FiguresArguments,
}

/// Reads, identifies and writes.
pub fn run(request: &Request) -> Result<Figures, BadInput> {
    if let Some(levels) = request.options.levels.filter(|levels| !LEVELS.contains(levels)) {
        let (least, most) = (LEVELS.start(), LEVELS.end());
        let why = format_args!("--levels {levels} is out of range; allowed: {least} to {most}");
        return Err(BadInput::message(why));
    }
    let refuse = |path: &Path, why| BadInput::new(path, why);
    let read = |path: &PathBuf| request.reading.input_output(path);
    let trained = request.logs.iter().map(read).collect::<Result<Vec<_>, _>>()?;
    for (path, log) in request.logs.iter().zip(&trained) {
        log.training(request.options.training).map_err(|why| refuse(path, why))?;
    }
    let held_out = request.predicted.iter().map(read).collect::<Result<Vec<_>, _>>()?;
    for path in [Some(request.output), request.plot, request.figures.json.as_deref()] {
        files::require_writable(path)?;
    }
    request.page.require_writable()?;
    let mut progress = Progress::new(1000, "identifying");
    let fraction = |fraction: f64| progress.set((fraction * 1e3) as u64);
    let found = identify_operator(&trained, &held_out, &request.options, fraction)
        .map_err(|why| refuse(&request.logs[0], why))?;
    drop(progress);
    let verdict = write(request, &found)?;
    if let Some(path) = request.plot {
        plot(&trained, &held_out, &found).write(path)?;
    }
    let described = describe(&found);
    tell(request.output, format_args!("{described}\n{}", table(&found)));
    let figures = std::iter::once(was_written(&verdict)).chain(figures(&found)).collect::<Vec<_>>();
    let told = Told {
        logs: request.logs.iter().chain(request.predicted).map(PathBuf::as_path).collect(),
        output: request.output,
        verdict: &verdict,
        described: Some(&described),
        not_identified: &[],
        figures: &figures,
    };
    request.page.write(&told, |outcome| identification::operator(outcome, &trained, &held_out, &found))?;
    Ok(Figures::beside(request.output, figures, request.figures))
}

/// Writes the operator, unless a straight line predicts better and it is not forced.
fn write(request: &Request, found: &IdentifiedOperator) -> Result<Verdict, BadInput> {
    let judged = found.held_out.unwrap_or(found.training);
    let is_worse = judged.rms.partial_cmp(&judged.line_rms).is_none_or(std::cmp::Ordering::is_gt);
    let [rms, line] = [judged.rms, judged.line_rms].map(percent);
    let against = format!("it predicts to {rms} % of the span, a straight line to {line} %");
    let verdict = Verdict::of(is_worse.then_some(against), request.force, OPERATOR_LOG);
    complain_of(request.output, &verdict);
    if verdict.is_written() {
        found.operator.write(request.output)?;
    }
    Ok(verdict)
}

fn percent(fraction: f64) -> String {
    format!("{:.3}", 100.0 * fraction)
}

fn describe(found: &IdentifiedOperator) -> String {
    let grid = found.operator.grid();
    let even = if found.along_diagonal { "along the diagonal" } else { "in all directions" };
    format!(
        "weights on {} levels over inputs from {} to {}, smoothness {:e} {even}; relays: {}",
        grid.levels,
        grid.low,
        grid.high,
        found.smoothing,
        orientation(&found.operator)
    )
}

/// What the signs of the weights say.
fn orientation(operator: &Operator) -> &'static str {
    let any = |sign: f64| operator.weights().iter().any(|weight| weight * sign > 0.0);
    match (any(1.0), any(-1.0)) {
        (true, true) => "of both signs",
        (true, false) => "the output lags its input",
        (false, true) => "the output leads its input",
        (false, false) => "none, a straight line",
    }
}

/// Errors of operator and straight line, in % of the span.
fn table(found: &IdentifiedOperator) -> String {
    let header = ["error, % of span", "rows", "rms", "max", "line rms", "line max"].map(String::from);
    let row = |name: &str, errors: Errors| {
        let numbers = [errors.rms, errors.max, errors.line_rms, errors.line_max].map(percent);
        [vec![name.to_owned(), errors.rows.to_string()], numbers.to_vec()].concat()
    };
    let held_out = found.held_out.map(|errors| row("held out", errors));
    columns(
        &[header.to_vec(), row("training", found.training)].into_iter().chain(held_out).collect::<Vec<_>>(),
    )
}

/// Errors as fractions of the span of what trains.
fn figures(found: &IdentifiedOperator) -> Vec<Figure> {
    let reported = |name: &str, value| Figure::reported(format!("identify.operator.{name}"), value, "1");
    let mut figures = vec![
        reported("levels", found.operator.grid().levels as f64),
        reported("smoothing", found.smoothing),
        reported("validation.rms", found.validation_rms),
        reported("training.rms", found.training.rms),
        reported("training.max", found.training.max),
        reported("training.line.rms", found.training.line_rms),
        reported("training.line.max", found.training.line_max),
    ];
    if let Some(errors) = found.held_out {
        // What predicts worse than a straight line has failed.
        let rms = Figure::bounded("identify.operator.held_out.rms", errors.rms, "1", errors.line_rms);
        figures.extend([
            rms,
            reported("held_out.max", errors.max),
            reported("held_out.line.rms", errors.line_rms),
            reported("held_out.line.max", errors.line_max),
        ]);
    }
    figures
}

/// Output over input and what is left, log by log.
fn plot(trained: &[InputOutput], held_out: &[InputOutput], found: &IdentifiedOperator) -> Page {
    let titles = [vec!["training"; trained.len()], vec!["held out"; held_out.len()]].concat();
    let logs = trained.iter().chain(held_out).zip(&found.predicted).zip(titles);
    logs.fold(Page::new("Identified operator"), |page, ((log, predicted), title)| {
        let missed: Vec<_> =
            log.output.iter().zip(predicted).map(|(y, p)| 100.0 * (p - y) / found.span).collect();
        page.with(
            Panel::new("u", "", "y", "")
                .titled(title)
                .with(Series::broad("measured", &log.input, &log.output))
                .with(Series::line("identified", &log.input, predicted)),
        )
        .with(
            Panel::new("u", "", "identified - measured", "% of span")
                .with(Series::line("", &log.input, &missed)),
        )
    })
}
