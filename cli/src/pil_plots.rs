//! What a control engineer wants to see of a run.

use std::f64::consts::TAU;

use strainwave_desktop::GearFile;
use strainwave_desktop::closed_loop::{Row, Run};
use strainwave_desktop::plot::{Page, Panel, Series};
use strainwave_desktop::scenario::Scenario;
use strainwave_desktop::replay::ReplayRow;
use strainwave_emulator::pil::ScenarioRun;

/// Control periods from one drawn row of a replay to the next.
const EVERY: usize = 10;

fn column<T>(rows: &[T], figure: impl Fn(&T) -> f64) -> Vec<f64> {
    rows.iter().map(figure).collect()
}

/// Output, error, torque and estimates over time; for the loop torque over torsion too.
pub fn scenario(run: &ScenarioRun, gear: &GearFile) -> Page {
    let rows = &run.compensated.trace;
    let time = column(rows, |row| row.time);
    let error = |run: &Run| column(&run.trace, |row| (row.output - row.demand.position) * 1e6);
    let position = Panel::new("time", "s", "output", "rad")
        .with(Series::dashed("asked", &time, &column(rows, |row| row.demand.position)))
        .with(Series::line("compensated", &time, &column(rows, |row| row.output)));
    let errors = Panel::new("time", "s", "output error", "urad")
        .with(Series::line("B0", &time, &error(&run.b0)))
        .with(Series::line("B1", &time, &error(&run.b1)))
        .with(Series::line("compensated", &time, &error(&run.compensated)));
    let torque = Panel::new("time", "s", "motor torque", "N m")
        .with(Series::line("command", &time, &column(rows, |row| row.answer.motor_torque.into())))
        .with(Series::line(
            "feed-forward",
            &time,
            &column(rows, |row| row.answer.feed_forward_torque.into()),
        ));
    let torsion = Panel::new("time", "s", "torsion", "urad")
        .with(Series::line("plant", &time, &column(rows, |row| row.torsion * 1e6)))
        .with(Series::dashed(
            "estimate",
            &time,
            &column(rows, |row| f64::from(row.answer.estimate.torsion) * 1e6),
        ));
    let external = Panel::new("time", "s", "external torque", "N m")
        .with(Series::line(
            "estimate",
            &time,
            &column(rows, |row| row.answer.estimate.external_torque.into()),
        ))
        .with(Series::dashed("plant", &time, &column(rows, |row| row.demand.load)));
    let title = format!("{} {}: {}", gear.gear.name, run.scenario.name(), run.scenario.title());
    let page = Page::new(title).with(position).with(errors).with(torque).with(torsion).with(external);
    if run.scenario == Scenario::S6 { page.with(torque_over_torsion(rows)) } else { page }
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
