//! What the predictions miss over frequency, and over the orders of a revolution.

use maud::{Markup, html};

use super::fit::Fit;
use crate::report::plot::{Colour, Page, Panel, Series};
use crate::report::{figure, plot};
use crate::verify::judge::{affordable, spectrum};

/// Products that a spectrum may take: some tenths of a second.
const PRODUCTS: f64 = 4e7;
/// Means of a residual over a revolution.
const BINS: f64 = 64.0;
/// Highest order that is drawn.
const HIGHEST_ORDER: f64 = 16.0;

/// Fraction of the rows' frequency up to which a spectrum is slow: a tenth of all that they show.
const SLOW: f64 = 0.05;

/// Frequencies, and the amplitudes there.
type Lines = (Vec<f64>, Vec<f64>);

/// Axes of a spectrum.
pub(super) struct Axes {
    /// What the values are apart in, such as "frequency", and the inverse of its unit.
    pub along: (&'static str, &'static str),
    /// Unit of the errors.
    pub unit: &'static str,
    /// What predicts without what was identified.
    pub base: &'static str,
}

/// Of the errors of a fit, whose rows are `interval` apart: the slow tenth of the frequencies, and all.
pub(super) fn slow_and_whole(axes: &Axes, fit: &Fit, interval: f64) -> [Panel; 2] {
    let [base, identified] = fit.errors();
    [SLOW / interval, f64::INFINITY]
        .map(|highest| panel(axes, [&base, &identified], interval, highest).titled(fit.log))
}

/// Errors without and with what was identified, `interval` apart, up to the frequency `highest` where that is affordable.
pub(super) fn panel(axes: &Axes, errors: [&[f64]; 2], interval: f64, highest: f64) -> Panel {
    drawn(axes, errors.map(|values| lines(values, interval, highest)))
}

/// The same over the orders of a revolution, from errors at angles (turns), those orders marked that were identified; `None` of less
/// than a turn.
pub(super) fn over_orders(axes: &Axes, turns: &[f64], errors: [&[f64]; 2], orders: &[u32]) -> Option<Panel> {
    let even = [over_angle(turns, errors[0])?, over_angle(turns, errors[1])?];
    let both = even.map(|values| lines(&values, 1.0 / BINS, HIGHEST_ORDER));
    let highest = both.iter().flat_map(|(_, amplitudes)| amplitudes).copied().fold(0.0, f64::max);
    Some(orders.iter().enumerate().fold(drawn(axes, both), |panel, (place, order)| {
        let name = if place == 0 { named(orders) } else { String::new() };
        let mark = [f64::from(*order); 2];
        panel.with(Series::dotted(name, &mark, &[0.0, highest]).coloured(Colour::Green))
    }))
}

/// Frequencies and amplitudes of values less their mean.
fn lines(values: &[f64], interval: f64, highest: f64) -> Lines {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    let centred: Vec<_> = values.iter().map(|value| value - mean).collect();
    let highest = affordable(values.len(), interval, PRODUCTS).min(highest);
    spectrum(&centred, interval, highest).into_iter().unzip()
}

fn drawn(axes: &Axes, [(x, before), (also_x, after)]: [Lines; 2]) -> Panel {
    Panel::new(axes.along.0, axes.along.1, "amplitude", axes.unit)
        .with(Series::dashed(axes.base, &x, &before).coloured(Colour::Vermilion))
        .with(Series::line("identified", &also_x, &after).coloured(Colour::Blue))
}

fn named(orders: &[u32]) -> String {
    let list: Vec<_> = orders.iter().map(u32::to_string).collect();
    format!("orders {}", list.join(", "))
}

/// Means of values at angles (turns) over equal parts of a turn, from the least angle to the greatest; where a part has none, that of the
/// part before.
fn over_angle(turns: &[f64], values: &[f64]) -> Option<Vec<f64>> {
    let least = turns.iter().copied().fold(f64::INFINITY, f64::min);
    let most = turns.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    // Not so of an empty list either.
    if (most - least).partial_cmp(&1.0).is_none_or(std::cmp::Ordering::is_lt) {
        return None;
    }
    let mut bins = vec![(0.0, 0_u32); ((most - least) * BINS) as usize + 1];
    for (turn, value) in turns.iter().zip(values) {
        let (sum, count) = &mut bins[((turn - least) * BINS) as usize];
        (*sum, *count) = (*sum + value, *count + 1);
    }
    let mut last = 0.0;
    let mean = |(sum, count): (f64, u32)| {
        last = if count > 0 { sum / f64::from(count) } else { last };
        last
    };
    Some(bins.into_iter().map(mean).collect())
}

/// A picture of spectra under each other.
pub(super) fn section(panels: Vec<Panel>, caption: &str) -> Markup {
    let page = panels.into_iter().fold(Page::slide(""), Page::with);
    html! { (figure(&plot(&page), &html! { (caption) })) }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    const AXES: Axes = Axes { along: ("order", "1/turn"), unit: "urad", base: "base gear" };

    /// There and back over four turns, with an order 3 that is a function of the angle.
    #[test]
    fn an_order_is_found_at_its_place_however_the_angle_goes() {
        let turns: Vec<f64> = (0..8000).map(|k| 4.0 - (f64::from(k) / 1000.0 - 4.0).abs()).collect();
        let values: Vec<f64> = turns.iter().map(|turn| 30.0 * (3.0 * TAU * turn).sin()).collect();
        let even = over_angle(&turns, &values).unwrap();
        assert!((even.len() as f64 - 4.0 * BINS).abs() <= 1.0);
        let lines = spectrum(&even, 1.0 / BINS, HIGHEST_ORDER);
        let (order, amplitude) = lines.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        assert!((order - 3.0).abs() < 0.05 && (amplitude / 30.0 - 1.0).abs() < 0.05, "{order} {amplitude}");
    }

    #[test]
    fn orders_are_named_and_less_than_a_turn_has_none() {
        let turns: Vec<f64> = (0..500).map(|k| f64::from(k) / 100.0).collect();
        let drawn = over_orders(&AXES, &turns, [&turns, &turns], &[2, 4]).unwrap();
        let svg = Page::new("").with(drawn).to_svg();
        assert!(svg.contains("\norders 2, 4\n") && svg.contains("order [1/turn]"), "{svg}");
        let short: Vec<f64> = turns.iter().map(|turn| 0.1 * turn).collect();
        assert!(over_orders(&AXES, &short, [&short, &short], &[2]).is_none());
        assert!(over_orders(&AXES, &[], [&[], &[]], &[2]).is_none());
    }
}
