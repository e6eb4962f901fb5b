//! Plots of a run: one page a question.

mod controller;
mod estimates;
mod learnt;
mod replay;
mod spectrum;

use strainwave_desktop::GearFile;
use strainwave_desktop::bench::closed_loop::{Row, Run};
use strainwave_desktop::bench::scenario::Scenario;
use strainwave_desktop::report::plot::{Colour, Page, Panel, Series};
use strainwave_desktop::verify::judge::error;
use strainwave_emulator::pil::TrialRun;

use controller::{Controller, compensator, controllers};
pub use replay::replay;

/// Points of a curve in the picture for a page of text.
const POINTS: usize = 1000;

fn column<T>(rows: &[T], figure: impl Fn(&T) -> f64) -> Vec<f64> {
    rows.iter().map(figure).collect()
}

/// Pages of a run by the names of their questions; what a motion has nothing of is left out.
pub fn trial(run: &TrialRun<'_>, gear: &GearFile) -> Vec<(&'static str, Page)> {
    let rows = &run.target.run.trace;
    let questions = [
        ("tracking", "tracking error", tracking(run)),
        ("torsion", "torsion", torsion(run)),
        ("torque", "torque", torque(run)),
        ("estimates-motion", "estimated motion", estimates::of_motion(rows)),
        ("estimates-torque", "estimated torque", estimates::of_torque(rows)),
        ("learnt", "learnt factors", learnt::panels(rows)),
        ("spectrum", "spectrum of the vibration", spectrum::panels(run)),
    ];
    let trial = format!("{} {}, plant {}", gear.gear.name, run.trial.name(), run.trial.conditions.seed);
    let page = |title: &str, panels: Vec<Panel>| {
        panels.into_iter().fold(Page::slide(format!("{trial}: {title}")), Page::with)
    };
    let drawn = questions.into_iter().filter(|(.., panels)| !panels.is_empty());
    drawn.map(|(name, title, panels)| (name, page(title, panels))).collect()
}

/// Axes over time.
fn over_time(name: &str, unit: &str) -> Panel {
    Panel::new("time", "s", name, unit)
}

/// A curve of every controller.
fn of_all(run: &TrialRun<'_>, panel: Panel, figure: &dyn Fn(&Row) -> f64) -> Panel {
    controllers(run).fold(panel, |panel, (controller, of)| {
        let time = column(&of.trace, |row| row.time);
        panel.with(controller.series(&time, &column(&of.trace, figure)))
    })
}

fn tracking(run: &TrialRun<'_>) -> Vec<Panel> {
    let rows = &run.target.run.trace;
    let (time, commanded) = (column(rows, |row| row.time), column(rows, |row| row.demand.position));
    let output = over_time("output", "rad")
        .with(compensator(run).series(&time, &column(rows, |row| row.output)))
        .with(Series::dashed("commanded", &time, &commanded).coloured(Colour::Black));
    vec![output, of_all(run, over_time("output error", "urad"), &|row| error(row) * 1e6)]
}

/// Torsion over time; for the loop torque over torsion too.
fn torsion(run: &TrialRun<'_>) -> Vec<Panel> {
    let panel = of_all(run, over_time("torsion", "urad"), &|row| row.torsion * 1e6);
    let torque_loop = (run.trial.motion.scenario() == Some(Scenario::S6))
        .then(|| torque_over_torsion(&run.target.run.trace));
    [Some(panel), torque_loop].into_iter().flatten().collect()
}

fn torque_over_torsion(rows: &[Row]) -> Panel {
    let torsion = column(rows, |row| row.torsion * 1e6);
    Panel::new("torsion", "urad", "torque", "N m").with(Series::line(
        "plant",
        &torsion,
        &column(rows, |row| row.transmitted),
    ))
}

/// Motor torque of every controller, and the external torque beside its estimate.
fn torque(run: &TrialRun<'_>) -> Vec<Panel> {
    let rows = &run.target.run.trace;
    let time = column(rows, |row| row.time);
    let fed_forward = column(rows, |row| row.answer.feed_forward_torque.into());
    let motor = of_all(run, over_time("motor torque", "N m"), &|row| row.answer.motor_torque.into())
        .with(Series::dashed("fed forward", &time, &fed_forward).coloured(Colour::Black));
    let estimated = column(rows, |row| row.answer.estimate.external_torque.into());
    let external = over_time("external torque", "N m")
        .with(Series::line("estimate", &time, &estimated).coloured(Colour::Blue))
        .with(Series::dashed("plant", &time, &column(rows, |row| row.demand.load)).coloured(Colour::Black));
    vec![motor, external]
}

/// Output error with the cascade alone and with the compensator, small enough for a page of text.
pub fn comparison(run: &TrialRun<'_>) -> Page {
    let panel = controllers(run)
        .filter(|(controller, _)| matches!(controller, Controller::Baseline(0) | Controller::Compensator(_)))
        .fold(over_time("output error", "urad"), |panel, (controller, of)| {
            panel.with(thinned_error(controller, of))
        });
    Page::new("").with(panel)
}

fn thinned_error(controller: Controller, of: &Run) -> Series {
    let rows: Vec<_> = of.trace.iter().step_by(of.trace.len().div_ceil(POINTS)).copied().collect();
    controller.series(&column(&rows, |row| row.time), &column(&rows, |row| error(row) * 1e6))
}
