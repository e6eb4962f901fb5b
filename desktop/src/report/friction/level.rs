//! Steady friction over speed.

use maud::{Markup, html};

use super::models::{Model, Models, Numbers};
use crate::report::plot::{Page, Panel, Series};
use crate::report::{figure, plot};

/// Speeds up to so many vs.
const FASTEST: f64 = 4.0;
const SPEEDS: i32 = 120;
/// Steps of up to a second in which a contact settles at a speed.
const SETTLING: usize = 100;
/// Way over which friction is averaged (eps): the bristles snap once.
const WAY: f64 = 2.0;
/// Steps in it.
const STEPS: usize = 400;
/// Curves that differ by less than this fraction of Fs are one.
const ALIKE: f64 = 5e-3;

pub(super) fn section(numbers: &Numbers, models: &Models) -> Markup {
    let speeds: Vec<_> = (1..=SPEEDS)
        .map(|k| FASTEST * numbers.stribeck_velocity * f64::from(k) / f64::from(SPEEDS))
        .collect();
    let mut panel = Panel::new("speed", "rad/s", "steady friction", "mN m");
    for (names, curve) in grouped(numbers, models, &speeds) {
        panel = panel.with(Series::line(
            names,
            &speeds,
            &curve.iter().map(|force| force * 1e3).collect::<Vec<_>>(),
        ));
    }
    html! {
        h3 { "Level over speed" }
        p {
            "Sliding steadily, the models are of few kinds: a level (Coulomb), a slope, or a level that falls with speed from "
            "Fs to Fc (Stribeck), to which the slope is added. What sets them apart is what they do before and around "
            "standstill, below."
        }
        (figure(&plot(&Page::new("").with(panel)), &html! {
            "Steady friction over speed; models whose curves lie within " (ALIKE * 100.0) " % of Fs share a line."
        }))
    }
}

/// One curve for all models that share it, with their names.
fn grouped(numbers: &Numbers, models: &Models, speeds: &[f64]) -> Vec<(String, Vec<f64>)> {
    let mut groups: Vec<(String, Vec<f64>)> = Vec::new();
    for model in &models.drawn {
        let curve: Vec<_> = speeds.iter().map(|speed| steady(numbers, model, *speed)).collect();
        let alike = |other: &[f64]| {
            curve.iter().zip(other).all(|(one, other)| (one - other).abs() <= ALIKE * numbers.static_level)
        };
        match groups.iter_mut().find(|(_, other)| alike(other)) {
            Some((names, _)) => *names += &format!(", {}", model.name),
            None => groups.push((model.name.into(), curve)),
        }
    }
    groups
}

/// Mean friction (N m) at a speed (rad/s) other than 0.
pub(super) fn steady(numbers: &Numbers, model: &Model, speed: f64) -> f64 {
    let mut contact = model.rest();
    for _ in 0..SETTLING {
        contact.step(speed, 1.0, 0.0);
    }
    let duration = WAY * numbers.presliding / speed.abs() / STEPS as f64;
    (0..STEPS).map(|_| contact.step(speed, duration, 0.0)).sum::<f64>() / STEPS as f64
}
