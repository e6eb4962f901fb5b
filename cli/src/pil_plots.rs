//! Plots of a run.

use std::f64::consts::TAU;

use strainwave::compensator::adapt::parameters::Factors;
use strainwave_desktop::GearFile;
use strainwave_desktop::bench::closed_loop::{Row, Run};
use strainwave_desktop::bench::scenario::Scenario;
use strainwave_desktop::identify::replay::ReplayRow;
use strainwave_desktop::report::plot::{Page, Panel, Series};
use strainwave_desktop::verify::judge::estimates::{self, Estimated};
use strainwave_desktop::verify::judge::{Judge, error, spectrum};
use strainwave_emulator::pil::ScenarioRun;

/// Control periods from one drawn row of a replay to the next.
const EVERY: usize = 10;

/// Points of a curve in the picture for a page of text.
const POINTS: usize = 1000;

/// Highest frequency of a spectrum (Hz): some times that of the torsion mode.
const HIGHEST: f64 = 200.0;

fn column<T>(rows: &[T], figure: impl Fn(&T) -> f64) -> Vec<f64> {
    rows.iter().map(figure).collect()
}

/// The runs of every controller with its name for people, the compensator's last.
fn controllers(run: &ScenarioRun) -> impl Iterator<Item = (String, &Run)> {
    let baselines = run.baselines.iter().map(|(name, run)| (name.to_uppercase(), run));
    baselines.chain([("compensated".to_owned(), &run.target.run)])
}

/// Output, error, torque and estimates over time, and the spectrum of what rings after a move; for the loop torque over
/// torsion too.
pub fn scenario(run: &ScenarioRun, gear: &GearFile) -> Page {
    let (scenario, rows) = (run.trial.scenario, &run.target.run.trace);
    let time = column(rows, |row| row.time);
    let of_all = |panel: Panel, figure: &dyn Fn(&Row) -> f64| {
        controllers(run).fold(panel, |panel, (name, run)| {
            panel.with(Series::line(name, &time, &column(&run.trace, figure)))
        })
    };
    let over_time = |name, unit| Panel::new("time", "s", name, unit);
    let output = over_time("output", "rad")
        .with(Series::dashed("asked", &time, &column(rows, |row| row.demand.position)))
        .with(Series::line("compensated", &time, &column(rows, |row| row.output)));
    let torque = of_all(over_time("motor torque", "N m"), &|row| row.answer.motor_torque.into());
    let fed_forward = column(rows, |row| row.answer.feed_forward_torque.into());
    let name = &gear.gear.name;
    let title =
        format!("{name} {}: {}, plant {}", run.trial.name(), scenario.title(), run.trial.conditions.seed);
    let page = Page::new(title)
        .with(output)
        .with(of_all(over_time("output error", "urad"), &|row| error(row) * 1e6))
        .with(torque.with(Series::dashed("fed forward", &time, &fed_forward)))
        .with(of_all(over_time("torsion", "urad"), &|row| row.torsion * 1e6));
    let page = page.with(factors(rows, &time)).with(external_torque(rows, &time));
    let page = estimates::ALL.iter().fold(page, |page, of| page.with(estimate_error(of, rows, &time)));
    let page = ringing(run).into_iter().fold(page, Page::with);
    if scenario == Scenario::S6 { page.with(torque_over_torsion(rows)) } else { page }
}

/// The output error with the cascade alone and with the compensator, small enough for a page of text.
pub fn comparison(run: &ScenarioRun) -> Page {
    let of = |of: &Run| -> [Vec<f64>; 2] {
        let rows: Vec<_> = of.trace.iter().step_by(of.trace.len().div_ceil(POINTS)).copied().collect();
        [column(&rows, |row| row.time), column(&rows, |row| error(row) * 1e6)]
    };
    let panel = Panel::new("time", "s", "output error", "urad");
    let shown = |name: &String| name == "B0" || name == "compensated";
    Page::new("").with(controllers(run).filter(|(name, _)| shown(name)).fold(panel, |panel, (name, run)| {
        let [time, error] = of(run);
        let name = if name == "B0" { "cascade alone".to_owned() } else { name };
        panel.with(Series::line(name, &time, &error))
    }))
}

/// Error of an estimate, with the band of three of its declared standard deviations.
fn estimate_error(estimated: &Estimated, rows: &[Row], time: &[f64]) -> Panel {
    let scaled = |scale: f64| rows.iter().skip(1).map(move |row| scale * estimated.deviation(row)).collect();
    let [upper, lower]: [Vec<f64>; 2] = [3.0, -3.0].map(scaled);
    let error: Vec<_> = rows.windows(2).map(|pair| estimated.error([&pair[0], &pair[1]])).collect();
    let time = time.get(1..).unwrap_or_default();
    Panel::new("time", "s", "estimated - true", estimated.unit)
        .titled(estimated.name)
        .with(Series::line("error", time, &error))
        .with(Series::dashed("3 deviations", time, &upper))
        .with(Series::dashed("", time, &lower))
}

/// A name and the factor of it.
type Named = (&'static str, fn(&Factors<f32>) -> f32);

/// The factors that the compensator has learnt of the joint.
fn factors(rows: &[Row], time: &[f64]) -> Panel {
    let learnt: [Named; 6] = [
        ("load inertia", |factors| factors.inertia),
        ("friction at the wave generator", |factors| factors.input_friction),
        ("friction at the output", |factors| factors.output_friction),
        ("compliance", |factors| factors.compliance),
        ("presliding, share of order 2", |factors| factors.presliding),
        ("presliding, stiffness", |factors| factors.presliding_stiffness),
    ];
    learnt.into_iter().fold(Panel::new("time", "s", "learnt factor", "1"), |panel, (name, of)| {
        panel.with(Series::line(name, time, &column(rows, |row| of(&row.answer.factors).into())))
    })
}

/// Estimated external torque and load.
fn external_torque(rows: &[Row], time: &[f64]) -> Panel {
    let estimated = column(rows, |row| row.answer.estimate.external_torque.into());
    Panel::new("time", "s", "external torque", "N m")
        .with(Series::line("estimate", time, &estimated))
        .with(Series::dashed("plant", time, &column(rows, |row| row.demand.load)))
}

/// Spectrum of the torsion's vibration over the last rest of a scenario that has one.
fn ringing(run: &ScenarioRun) -> Option<Panel> {
    let panel = Panel::new("frequency", "Hz", "vibration of the torsion at rest", "urad");
    controllers(run)
        .map(|(name, of)| {
            let vibration = Judge::new(run.trial.scenario, &run.plant, &of.trace).last_vibration()?;
            let (frequency, amplitude): (Vec<_>, Vec<_>) =
                spectrum(&vibration, HIGHEST).into_iter().map(|(f, a)| (f, a * 1e6)).unzip();
            Some(Series::line(name, &frequency, &amplitude))
        })
        .try_fold(panel, |panel, series| Some(panel.with(series?)))
}

fn torque_over_torsion(rows: &[Row]) -> Panel {
    let torsion = column(rows, |row| row.torsion * 1e6);
    Panel::new("torsion", "urad", "torque", "N m").with(Series::line(
        "plant",
        &torsion,
        &column(rows, |row| row.transmitted),
    ))
}

/// Measured and predicted output and what is left, over time and over the motor's angle, the means over the rows up to
/// `learnt` (s) removed.
pub fn replay(rows: &[ReplayRow], learnt: Option<f64>) -> Page {
    // A pixel holds many control periods.
    let rows: Vec<_> = rows.iter().step_by(EVERY).copied().collect();
    let (time, turns) = (column(&rows, |row| row.time), column(&rows, |row| row.motor / TAU));
    let taught = rows.partition_point(|row| row.time <= learnt.unwrap_or(f64::INFINITY)).max(1);
    let against = |figure: fn(&ReplayRow) -> f64| {
        let difference = column(&rows, |row| (figure(row) - row.measured) * 1e6);
        let mean = difference[..taught].iter().sum::<f64>() / taught as f64;
        difference.into_iter().map(|d| d - mean).collect::<Vec<_>>()
    };
    let [observer, rigid] = [against(|row| row.predicted), against(|row| row.rigid)];
    let output = Panel::new("time", "s", "output", "rad")
        .with(Series::line("measured", &time, &column(&rows, |row| row.measured)))
        .with(Series::line("predicted", &time, &column(&rows, |row| row.predicted)))
        .with(Series::dashed("rigid gear", &time, &column(&rows, |row| row.rigid)));
    let error = |panel: Panel, x: &[f64]| {
        panel.with(Series::line("observer", x, &observer)).with(Series::dashed("rigid gear", x, &rigid))
    };
    let over_time = error(Panel::new("time", "s", "predicted - measured", "urad"), &time);
    let over_motor = error(Panel::new("motor", "turn", "predicted - measured", "urad"), &turns);
    let title = match learnt {
        Some(learnt) => format!("Replay of a measured log through the observer, learnt up to {learnt:.2} s"),
        None => "Replay of a measured log through the observer".into(),
    };
    Page::new(title).with(output).with(over_time).with(over_motor)
}
