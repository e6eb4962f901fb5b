//! Plots of a measured log that went through the observer.

use std::f64::consts::TAU;

use strainwave_desktop::identify::replay::ReplayRow;
use strainwave_desktop::report::plot::{Colour, Page, Panel, Series};

use super::column;

/// Control periods from one drawn row to the next.
const EVERY: usize = 10;

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
        .with(Series::broad("measured", &time, &column(&rows, |row| row.measured)).coloured(Colour::SkyBlue))
        .with(of_rigid_gear(&time, &column(&rows, |row| row.rigid)))
        .with(of_observer(&time, &column(&rows, |row| row.predicted)));
    let error =
        |panel: Panel, x: &[f64]| panel.with(of_rigid_gear(x, &rigid)).with(of_observer(x, &observer));
    let over_time = error(Panel::new("time", "s", "predicted - measured", "urad"), &time);
    let over_motor = error(Panel::new("motor", "turn", "predicted - measured", "urad"), &turns);
    let title = match learnt {
        Some(learnt) => format!("Replay of a measured log through the observer, learnt up to {learnt:.2} s"),
        None => "Replay of a measured log through the observer".into(),
    };
    Page::slide(title).with(output).with(over_time).with(over_motor)
}

fn of_rigid_gear(x: &[f64], y: &[f64]) -> Series {
    Series::dashed("rigid gear", x, y).coloured(Colour::Vermilion)
}

fn of_observer(x: &[f64], y: &[f64]) -> Series {
    Series::line("observer", x, y).coloured(Colour::Blue)
}
