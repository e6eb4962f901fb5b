//! Motor torque over the motor's speed, beside the friction that the gears' models have at a steady speed.
//!
//! What accelerates the base gear's inertia is taken off the torque. The weight of the load is still in it, and what varies over
//! the angle, so the points scatter about the curve; friction is what they have in common.

use maud::{Markup, html};
use strainwave::compensator::schedule::CONTROL_PERIOD;

use crate::identify::LearntGear;
use crate::identify::replay::ReplayRow;
use crate::io::gear_file::GearFile;
use crate::report::friction::steady;
use crate::report::plot::{Colour, Page, Panel, Series};
use crate::report::{figure, plot};

/// Half of the time over which speeds and accelerations are taken (s).
const HALF_SPAN: f64 = 0.024;
/// Most points of the map.
const POINTS: usize = 1200;
/// Speeds of a curve to either side.
const SPEEDS: i32 = 60;

/// Speed (rad/s) and torque (N m) of some rows.
#[derive(Clone, Debug, Default, PartialEq)]
struct Points {
    speeds: Vec<f64>,
    torques: Vec<f64>,
}

pub(super) fn section(base: &GearFile, found: &LearntGear) -> Markup {
    let [trained, held_out] = points(base, &found.rows, found.learnt);
    let fastest =
        trained.speeds.iter().chain(&held_out.speeds).fold(0.0_f64, |most, speed| most.max(speed.abs()));
    let speeds: Vec<_> =
        (-SPEEDS..=SPEEDS).filter(|k| *k != 0).map(|k| fastest * f64::from(k) / f64::from(SPEEDS)).collect();
    let panel = Panel::new("motor speed", "rad/s", "motor torque", "N m")
        .with(Series::points("trained", &trained.speeds, &trained.torques).coloured(Colour::Orange))
        .with(Series::points("held out", &held_out.speeds, &held_out.torques).coloured(Colour::SkyBlue));
    let curve = |gear: &GearFile| steady(&gear.friction.input, &speeds).filter(|_| fastest > 0.0);
    let panel = match curve(base) {
        Some(friction) => {
            panel.with(Series::dashed("friction, base gear", &speeds, &friction).coloured(Colour::Vermilion))
        }
        None => panel,
    };
    let panel = match curve(&found.gear) {
        Some(friction) => {
            panel.with(Series::line("friction, identified", &speeds, &friction).coloured(Colour::Blue))
        }
        None => panel,
    };
    figure(
        &plot(&Page::slide("").with(panel)),
        &html! {
            "Motor torque, less what accelerates the base gear's inertia, over the motor's speed. The curves are the friction of the wave "
            "generator at a steady speed. Points off them are the weight of the load and what varies over the angle."
        },
    )
}

/// Those up to the time `learnt` (s), and the others.
fn points(base: &GearFile, rows: &[ReplayRow], learnt: f64) -> [Points; 2] {
    let r: f64 = base.gear.signed_ratio().value();
    let inertia = base.inertia.wave_generator + r * r * base.inertia.flexspline;
    let span = (HALF_SPAN / CONTROL_PERIOD) as usize;
    let mut parts = [Points::default(), Points::default()];
    for at in (span..rows.len().saturating_sub(span)).step_by(rows.len().div_ceil(POINTS).max(1)) {
        let [before, now, after] = [at - span, at, at + span].map(|row| rows[row].motor);
        let acceleration = (after - 2.0 * now + before) / (HALF_SPAN * HALF_SPAN);
        let part = &mut parts[usize::from(rows[at].time > learnt)];
        part.speeds.push((after - before) / (2.0 * HALF_SPAN));
        part.torques.push(rows[at].motor_torque - inertia * acceleration);
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rotor that is accelerated evenly against a constant friction.
    #[test]
    fn the_points_are_what_is_left_of_the_torque_at_its_speed() {
        let gear = GearFile::default_gear();
        let r: f64 = gear.gear.signed_ratio().value();
        let inertia = gear.inertia.wave_generator + r * r * gear.inertia.flexspline;
        let row = |k: u32| {
            let time = f64::from(k) * CONTROL_PERIOD;
            ReplayRow {
                time,
                motor: 20.0 * time * time,
                motor_torque: 0.1 + 40.0 * inertia,
                ..ReplayRow::default()
            }
        };
        let rows: Vec<_> = (0..10_000).map(row).collect();
        let [trained, rest] = points(&gear, &rows, 0.5);
        assert!(trained.torques.iter().chain(&rest.torques).all(|torque| (torque - 0.1).abs() < 1e-6));
        let fastest = |points: &Points| points.speeds.iter().copied().fold(0.0, f64::max);
        assert!((fastest(&trained) - 20.0).abs() < 0.5 && (fastest(&rest) - 40.0).abs() < 1.5);
        let count = trained.speeds.len() + rest.speeds.len();
        assert!((POINTS / 2..=POINTS).contains(&count), "{count}");
    }
}
