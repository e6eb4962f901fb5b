//! The tip's way in the x-y plane, beside where it should be.

use strainwave_desktop::report::plot::{Colour, Page, Panel, Series};
use strainwave_desktop::robot::RobotRun;
use strainwave_desktop::robot::run::RobotRow;

/// Titles of the runs: B1, and the compensator with either set of sensors.
const TITLES: [&str; 3] = ["B1", "compensated, motor encoders", "compensated, both encoders"];
/// Points of a curve.
const POINTS: usize = 600;
/// The largest error in the picture, in parts of the motion's size.
const SHARE: f64 = 0.25;

/// A small picture for each run, errors of all magnified alike.
pub fn picture(runs: &[RobotRun]) -> Page {
    let factor = magnification(runs);
    let heading = format!("way of the tip (demanded: dashed), its error {factor} times as large");
    let page = Page::small_multiples(heading, runs.len());
    TITLES.into_iter().zip(runs).fold(page, |page, (title, run)| page.with(panel(title, run, factor)))
}

/// A power of ten, or two or five of them.
fn magnification(runs: &[RobotRun]) -> f64 {
    let size = (0..2).map(|axis: usize| span(&runs[0], axis)).fold(0.0, f64::max);
    let error = runs.iter().map(RobotRun::largest).fold(f64::MIN_POSITIVE, f64::max);
    let most = (SHARE * size / error).max(1.0);
    let power = 10f64.powi(most.log10().floor() as i32);
    [5.0, 2.0, 1.0].into_iter().map(|digit| digit * power).find(|factor| *factor <= most).unwrap_or(1.0)
}

fn span(run: &RobotRun, axis: usize) -> f64 {
    let places = run.rows.iter().map(|row| row.demanded_tip[axis]);
    let (least, most) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    most - least
}

fn panel(title: &str, run: &RobotRun, factor: f64) -> Panel {
    let [from, to] = run.judged;
    let judged: Vec<_> = run.rows.iter().filter(|row| (from..=to).contains(&row.time)).collect();
    let rows: Vec<&RobotRow> = judged.iter().step_by(judged.len().div_ceil(POINTS).max(1)).copied().collect();
    let of = |place: &dyn Fn(&RobotRow) -> f64| rows.iter().map(|row| place(row)).collect::<Vec<_>>();
    let asked = [0, 1].map(|axis: usize| of(&|row| row.demanded_tip[axis]));
    let drawn = [0, 1].map(|axis: usize| {
        of(&|row| row.demanded_tip[axis] + factor * (row.tip[axis] - row.demanded_tip[axis]))
    });
    Panel::new("x", "m", "y", "m")
        .titled(title)
        .with(Series::line("", &drawn[0], &drawn[1]).coloured(Colour::Blue))
        .with(Series::dashed("", &asked[0], &asked[1]).coloured(Colour::Black))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of 1 m whose tip is off by so much.
    fn run(off: f64) -> RobotRun {
        let row = |time: f64, x: f64, y: f64| RobotRow {
            time,
            demanded_tip: [x, y, 0.0],
            tip: [x + off, y, 0.0],
            joints: Vec::new(),
        };
        let rows = vec![row(0.0, 0.0, 0.0), row(1.0, 1.0, 0.0), row(2.0, 1.0, 1.0), row(3.0, 0.0, 1.0)];
        RobotRun { rows, judged: [0.0, 3.0] }
    }

    #[test]
    fn the_largest_error_is_seen_and_stays_small() {
        assert_eq!(magnification(&[run(1e-4), run(2e-4)]), 1000.0);
        assert_eq!(magnification(&[run(1e-3)]), 200.0);
        assert_eq!(magnification(&[run(0.5)]), 1.0);
    }

    #[test]
    fn every_run_has_a_panel_under_one_title() {
        let svg = picture(&[run(1e-4), run(1e-5), run(1e-6)]).to_svg();
        assert!(svg.contains("its error 2000 times as large"), "{svg}");
        assert!(["B1", "motor encoders", "both encoders"].iter().all(|title| svg.contains(title)));
    }
}
