//! Plots of the estimates: error within the band of three declared standard deviations.

use strainwave_desktop::bench::closed_loop::Row;
use strainwave_desktop::report::plot::{Colour, Panel, Series};
use strainwave_desktop::verify::judge::estimates::{self, Estimated};

use super::column;

/// Estimates of motion, which the list of estimates has first; torques follow.
const OF_MOTION: usize = 3;

/// Errors of output, output velocity and torsion.
pub fn of_motion(rows: &[Row]) -> Vec<Panel> {
    estimates::ALL[..OF_MOTION].iter().map(|estimated| error(estimated, rows)).collect()
}

/// Errors of transmitted torque, friction and external torque.
pub fn of_torque(rows: &[Row]) -> Vec<Panel> {
    estimates::ALL[OF_MOTION..].iter().map(|estimated| error(estimated, rows)).collect()
}

fn error(estimated: &Estimated, rows: &[Row]) -> Panel {
    let errors: Vec<_> = rows.windows(2).map(|pair| estimated.error([&pair[0], &pair[1]])).collect();
    let rows = rows.get(1..).unwrap_or_default();
    let time = column(rows, |row| row.time);
    let [lower, upper] = [-3.0, 3.0].map(|scale| column(rows, |row| scale * estimated.deviation(row)));
    Panel::new("time", "s", "estimated - true", estimated.unit)
        .titled(estimated.name)
        .with(Series::band("3 standard deviations", &time, [&lower, &upper]).coloured(Colour::Orange))
        .with(Series::line("error", &time, &errors).coloured(Colour::Blue))
}
