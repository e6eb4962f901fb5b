//! Heat map of a covariance: which parameters the logs do not tell apart.

use maud::{Markup, html};

use crate::identify::Covariance;
use crate::report::figure;

/// Correlation from which on two parameters are not told apart.
pub(super) const ALIKE: f64 = 0.9;
/// Opacity of a correlation of 1: its number stays legible.
const FULL: f64 = 0.75;
/// Side of a cell, and with its number in it (pixels).
const CELL: usize = 18;
const NUMBERED: usize = 44;
/// Most parameters whose cells have their numbers.
const MOST_NUMBERED: usize = 8;
/// Width of a letter, and room for the columns' numbers (pixels).
const LETTER: usize = 7;
const TOP: usize = 20;

/// The heat map; nothing of fewer than two parameters.
pub(super) fn section(covariance: &Covariance, caption: &str) -> Markup {
    let names = covariance.names();
    if names.len() < 2 {
        return html! {};
    }
    figure(
        &map(covariance),
        &html! {
            (caption) " Blue: they rise together, orange: one rises as the other falls; full colour is a correlation of 1 or -1. "
            "Parameters with a correlation near either are known only together."
        },
    )
}

fn map(covariance: &Covariance) -> Markup {
    let names = covariance.names();
    let numbered = names.len() <= MOST_NUMBERED;
    let cell = if numbered { NUMBERED } else { CELL };
    let left = LETTER * (4 + names.iter().map(|name| name.chars().count()).max().unwrap_or(0));
    let (width, height) = (left + cell * names.len() + 1, TOP + cell * names.len() + 1);
    let middle = |place: usize| place * cell + cell / 2;
    html! {
        svg width=(width) height=(height) viewBox=(format!("0 0 {width} {height}")) role="img" aria-label="Correlations" {
            @for (row, name) in names.iter().enumerate() {
                text x=(left - 6) y=(TOP + middle(row) + 4) text-anchor="end" font-size="12" { (row + 1) " " (name) }
                text x=(left + middle(row)) y=(TOP - 6) text-anchor="middle" font-size="11" { (row + 1) }
                @for (column, other) in names.iter().enumerate() {
                    @let correlation = covariance.correlation(row, column);
                    rect class=(if correlation < 0.0 { "against" } else { "weight" })
                        x=(left + column * cell) y=(TOP + row * cell) width=(cell) height=(cell)
                        fill-opacity=(format!("{:.2}", FULL * correlation.abs())) {
                        title { (name) ", " (other) ": " (format!("{correlation:.2}")) }
                    }
                    @if numbered {
                        text x=(left + middle(column)) y=(TOP + middle(row) + 4) text-anchor="middle" font-size="12" {
                            (format!("{correlation:.2}"))
                        }
                    }
                }
            }
            rect.outline x=(left) y=(TOP) width=(cell * names.len()) height=(cell * names.len()) {}
        }
    }
}

/// Pairs that are not told apart, a sentence each.
pub(super) fn alike(covariance: &Covariance) -> Vec<String> {
    let told = |(a, b, correlation): (&str, &str, f64)| {
        format!("{a} and {b} are known only together: their correlation is {correlation:.2}.")
    };
    covariance.alike(ALIKE).map(told).collect()
}
