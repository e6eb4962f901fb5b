//! Force over displacement in presliding: reversals that grow.

use maud::{Markup, html};

use super::models::{Model, Models, Numbers};
use super::{COLUMNS, panel};
use crate::report::plot::{Page, Panel};
use crate::report::{figure, plot};

/// Reversal points of the motion (eps).
const REVERSALS: [f64; 4] = [0.3, 0.7, 1.5, 3.0];
/// Steps in eps.
const STEPS: f64 = 200.0;
/// Speed over vs: slow, but above Karnopp's dead band.
const SPEED: f64 = 5e-3;

pub(super) fn section(numbers: &Numbers, models: &Models) -> Markup {
    let axes = || Panel::new("displacement", "mrad", "friction", "mN m");
    let largest = 1e3 * REVERSALS[REVERSALS.len() - 1] * numbers.presliding;
    // Either way, joined beyond the last reversal.
    let levels = [numbers.coulomb, numbers.static_level]
        .map(|level| vec![(-largest, -level), (largest, -level), (largest, level), (-largest, level)]);
    let page = models.drawn.iter().fold(Page::small_multiples("", COLUMNS), |page, model| {
        let (way, force) = run(numbers, model);
        page.with(panel(axes(), model.name, [&way, &force], &levels))
    });
    html! {
        h3 { "Presliding: reversals that grow" }
        p {
            "Slowly to and fro by " (REVERSALS.map(|reversal| reversal.to_string()).join(", ")) " eps. A model without memory jumps at "
            "each reversal; one with presliding draws loops, whose area is what it loses. What static friction holds at a "
            "standstill is not seen: this motion never stands."
        }
        (figure(&plot(&page), &html! {
            "Friction over displacement, at " (SPEED) " vs. Dashed: Fc (orange) and Fs (green), either way."
        }))
    }
}

/// Displacement (mrad) and friction (N m).
fn run(numbers: &Numbers, model: &Model) -> (Vec<f64>, Vec<f64>) {
    let step = numbers.presliding / STEPS;
    let speed = SPEED * numbers.stribeck_velocity;
    let mut contact = model.rest();
    let (mut ways, mut forces) = (vec![0.0], vec![0.0]);
    let mut at = 0i32;
    for end in REVERSALS.into_iter().flat_map(|reversal| [reversal, -reversal]).chain([0.0]) {
        let end = (end * STEPS).round() as i32;
        while at != end {
            let direction = (end - at).signum();
            at += direction;
            ways.push(1e3 * f64::from(at) * step);
            forces.push(contact.step(f64::from(direction) * speed, step / speed, 0.0));
        }
    }
    (ways, forces)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::gear_file::GearFile;

    /// The motion ends where it began; in between it reached every reversal.
    #[test]
    fn the_loops_lose_work_within_the_levels() {
        let numbers = Numbers::of(&GearFile::default_gear().friction.input);
        for model in Models::build(&numbers).drawn {
            let (ways, forces) = run(&numbers, &model);
            let largest = ways.iter().copied().fold(0.0, f64::max);
            assert!((largest - 3e3 * numbers.presliding).abs() < 1e-9 && ways[ways.len() - 1] == 0.0);
            let work: f64 =
                ways.windows(2).zip(&forces[1..]).map(|(way, force)| force * (way[1] - way[0])).sum();
            let (name, level) = (model.name, numbers.static_level);
            assert!(work > 0.0 && work < 30.0 * 1e3 * numbers.presliding * level, "{name}: {work}");
            assert!(forces.iter().all(|force| force.abs() < 1.3 * level), "{name}");
        }
    }
}
