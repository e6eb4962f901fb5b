//! The scenarios' chapter: every controller in S1 to S6 on one plant, and the arm of S7.
//!
//! The runs are made once ([`trials`]); the picture plays the compensated ones.

mod arm;
mod trials;

use maud::{Markup, html};

use super::controller::Controller;
use super::plot::{Page, Panel, Series};
use super::{Chapter, figure, figure_table, plot, table};
use crate::bench::closed_loop::{Row, Run};
use crate::bench::scenario::Scenario;
use crate::io::figure::{Figure, number};
use crate::io::file::BadInput;
use crate::verify::Measured;
use crate::verify::judge::error;
pub(super) use trials::{Trial, Trials};

/// Points of a curve.
const POINTS: usize = 1500;

pub(super) fn chapter(trials: &Trials, progress: &mut dyn FnMut(f64)) -> Result<Chapter, BadInput> {
    let (arm, arm_figures) = arm::section(progress)?;
    let measured = Measured::from([trials.figures(), arm_figures].concat());
    let body = html! {
        p {
            "Each scenario on one plant, drawn with seed " (trials::SEED) ": friction, stiffness and inertia differ from what the "
            "controllers know by up to 20, 10 and 30 %. Its mesh is condensed, the controllers are those of the host. B0 to B3 start from "
            "rest, as tuned for this gear; the compensators have worked 10 s before. " code { "strainwave pil" } " runs the same on "
            "the reference mesh with the firmware in the emulator, and " code { "strainwave verify compensator" } " judges 20 plants."
        }
        @match &trials.left_out {
            Some(why) => { p { "S1 to S6 were not run: " (why) "." } }
            None => { @for scenario in Scenario::ALL { (section(trials, scenario)) } }
        }
        (arm)
        h3 { "Figures" }
        p { "Measured now; only reported." }
        (figure_table(&measured))
    };
    Ok(Chapter { id: "scenarios", title: "Scenarios S1 to S7", body, measured })
}

fn section(trials: &Trials, scenario: Scenario) -> Markup {
    let found: Vec<_> = trials.of(scenario).collect();
    let name = scenario.name().to_uppercase();
    html! {
        h3 id=(scenario.name()) { (name) ": " (scenario.title()) }
        @if scenario == Scenario::S6 {
            (figure(&plot(&torque_loop(&found)), &html! {
                "Torque through the gear over its torsion, the wave generator held: it shows the plant, whatever the controller."
            }))
        } @else {
            (figure(&plot(&errors(&found)), &html! {
                "Output less demanded position: above with the motor encoder alone, below B0 again beside those that read the output encoder. "
                "Counted from " (scenario.judged_from()) " s on."
            }))
            (rows(&found))
        }
    }
}

/// Errors of every controller, with those of its metrics over B0's.
fn rows(found: &[&Trial]) -> Markup {
    let reference = found[0];
    let row = |trial: &&Trial| {
        let metrics = trial.metrics.iter().zip(&reference.metrics);
        let told = metrics.map(|(metric, of_b0)| {
            format!(
                "{} {} {} ({} of B0)",
                metric.name,
                number(metric.shown()),
                metric.shown_unit(),
                number(metric.value / of_b0.value)
            )
        });
        [
            trial.controller.title().into(),
            number(trial.run.rms * 1e6),
            number(trial.run.max * 1e6),
            told.collect::<Vec<_>>().join("; "),
        ]
    };
    table(
        ["controller", "error, rms (urad)", "largest (urad)", "judged by"],
        &found.iter().map(row).collect::<Vec<_>>(),
    )
}

fn thinned(run: &Run) -> Vec<&Row> {
    run.trace.iter().step_by(run.trace.len().div_ceil(POINTS).max(1)).collect()
}

fn curve(trial: &Trial) -> Series {
    let rows = thinned(&trial.run);
    let of = |figure: &dyn Fn(&Row) -> f64| rows.iter().map(|row| figure(row)).collect::<Vec<_>>();
    trial.controller.series(&of(&|row| row.time), &of(&|row| error(row) * 1e6))
}

/// A panel for each set of sensors; B0 in both.
fn errors(found: &[&Trial]) -> Page {
    let panel = |title: &str, drawn: &dyn Fn(Controller) -> bool| {
        let panel = Panel::new("time", "s", "output error", "urad").titled(title);
        found
            .iter()
            .filter(|trial| drawn(trial.controller))
            .fold(panel, |panel, trial| panel.with(curve(trial)))
    };
    Page::slide("")
        .with(panel("motor encoder", &|controller| !controller.reads_output()))
        .with(panel("both encoders", &|controller| {
            controller.reads_output() || controller == Controller::Baseline(0)
        }))
}

fn torque_loop(found: &[&Trial]) -> Page {
    let rows = thinned(&found[0].run);
    let torsion: Vec<_> = rows.iter().map(|row| row.torsion * 1e3).collect();
    let torque: Vec<_> = rows.iter().map(|row| row.transmitted).collect();
    Page::new("")
        .with(Panel::new("torsion", "mrad", "torque", "N m").with(Series::line("", &torsion, &torque)))
}

impl Trials {
    /// Errors and metrics by scenario and controller.
    fn figures(&self) -> Vec<Figure> {
        let of = |trial: &Trial| {
            let name =
                |what: &str| format!("report.{}.{}.{what}", trial.scenario.name(), trial.controller.name());
            let metrics = trial.metrics.iter().filter(|metric| metric.name != "error");
            let metrics =
                metrics.map(|metric| Figure::reported(name(metric.name), metric.value, metric.unit));
            let errors = [("error", trial.run.rms), ("error_max", trial.run.max)];
            let errors = errors.map(|(what, value)| Figure::reported(name(what), value, "rad"));
            errors.into_iter().chain(metrics).collect::<Vec<_>>()
        };
        let judged = Scenario::ALL.into_iter().filter(|scenario| !scenario.blocked());
        judged.flat_map(|scenario| self.of(scenario).flat_map(of).collect::<Vec<_>>()).collect()
    }
}
