//! Fig. 6: the relay, and the Preisach plane with the gear's weights.

use maud::{Markup, html};
use strainwave::Error;
use strainwave::friction::FrictionParams;
use strainwave::gear::GearParams;
use strainwave::hysteresis::table::TABLE_LEVELS;

use crate::io::figure::number;
use crate::report::figure;
use crate::report::paper::{Item, beside};
use crate::verify::Measured;

/// Side of the plane, and of a cell (pixels).
const SIDE: usize = 360;
const CELL: usize = SIDE / TABLE_LEVELS;
/// Room for the axes' names.
const MARGIN: usize = 24;

/// How far both forms of the operator are apart, as measured in this run.
fn agreement(measured: &Measured) -> String {
    let name = format!("hysteresis.{TABLE_LEVELS}.staircase_against_relays");
    let found = measured.figures.iter().find(|figure| figure.name == name);
    found.map_or_else(
        || "compared below".into(),
        |figure| format!("which differs from the sum by at most {} {}", number(figure.value), figure.unit),
    )
}

pub(super) fn section<P: FrictionParams<f64>>(
    params: &GearParams<f64, P>,
    measured: &Measured,
) -> Result<Markup, Error> {
    let (half_range, weights) = params.hysteresis_weights::<TABLE_LEVELS>()?;
    // On the diagonal half a cell lies in the plane: its density is twice its weight.
    let density = |i: usize, j: usize| weights.at(i, j) * if i == j { 2.0 } else { 1.0 };
    let cells: Vec<_> = (0..TABLE_LEVELS).flat_map(|i| (0..=i).map(move |j| (i, j))).collect();
    let largest = cells.iter().map(|(i, j)| density(*i, *j)).fold(0.0, f64::max);
    let shade = |i: usize, j: usize| if largest > 0.0 { density(i, j) / largest } else { 0.0 };
    Ok(html! {
        h3 { "Relay and weights" }
        (beside(
            Item::Fig6,
            &html! {
                (figure(&relay(), &html! {
                    "Left: a relay. It switches up where the input passes alpha and down where it passes beta."
                }))
                (figure(&plane(&cells, shade), &html! {
                    "Right: the weights of all relays over the plane beta to the right, alpha upwards, " (TABLE_LEVELS)
                    " levels over ±" (format!("{:.2}", half_range * 1e3)) " mrad; full colour is "
                    (format!("{:.3}", largest)) " N m a cell, the sum " (format!("{:.2}", weights.total())) " N m."
                }))
            },
            &html! {
                (cells.len()) " weights, none negative. The sum of eq. (9) is the reference; in real time the same operator is a staircase of turning points "
                "with one table, " (agreement(measured)) "."
            },
            &html! {
                "The paper's “intrinsic disadvantage”, that the function is not differentiable, is that of relays that jump. Here the weight of a cell is "
                "spread evenly over it: the torque is continuous, and has a slope everywhere but at turning points."
            },
        ))
    })
}

fn plane(cells: &[(usize, usize)], shade: impl Fn(usize, usize) -> f64) -> Markup {
    let size = SIDE + 2 * MARGIN;
    let diagonal = format!("M{MARGIN} {}L{} {MARGIN}", SIDE + MARGIN, SIDE + MARGIN);
    html! {
        svg width=(size) height=(size) viewBox=(format!("0 0 {size} {size}")) role="img" aria-label="Weights" {
            @for (i, j) in cells {
                rect.weight x=(MARGIN + j * CELL) y=(MARGIN + SIDE - (i + 1) * CELL) width=(CELL) height=(CELL)
                    fill-opacity=(format!("{:.3}", shade(*i, *j))) {}
            }
            rect.outline x=(MARGIN) y=(MARGIN) width=(SIDE) height=(SIDE) {}
            path.guide d=(diagonal) {}
            text x=(MARGIN + SIDE) y=(size - 6) text-anchor="end" font-size="13" { "beta" }
            text x=(MARGIN) y=(MARGIN - 8) font-size="13" { "alpha" }
        }
    }
}

fn relay() -> Markup {
    html! {
        svg width="360" height="180" viewBox="0 0 360 180" role="img" aria-label="A relay" {
            path.guide d="M20 90H340M180 15V165" {}
            path.link.stretch d="M30 140H250V40H330" {}
            path.link.shear d="M330 36H110V136H30" {}
            path.link.stretch d="M245 95L250 85L255 95" {}
            path.link.shear d="M105 85L110 95L115 85" {}
            text x="256" y="106" font-size="13" { "alpha" }
            text x="104" y="106" text-anchor="end" font-size="13" { "beta" }
            text x="186" y="30" font-size="13" { "1" }
            text x="174" y="155" text-anchor="end" font-size="13" { "-1" }
            text x="335" y="106" text-anchor="end" font-size="13" { "u" }
        }
    }
}
