//! Legends: within the axes where the fewest points are, or at the right beside them.

use plotters::chart::SeriesLabelPosition;
use plotters::element::DynElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::canvas::{Area, Chart, Drawn, Frame, PANEL_HEIGHT, PIXEL, WIDTH, font};
use super::pen::{Colour, colours, stroke};
use super::{Panel, Series, Style};

/// Width of a legend beside the axes.
pub(super) const BESIDE: u32 = 220 * PIXEL;

/// Lengths of a curve's sample within the axes and beside them, where it shows a whole period of the dashes.
pub(super) const SHORT: i32 = 20 * PIXEL as i32;
const LONG: i32 = 36 * PIXEL as i32;

/// Middle of the first line of a legend beside the axes, the height of a line, and the space behind a sample.
const FIRST: i32 = 24 * PIXEL as i32;
const LINE: i32 = 20 * PIXEL as i32;
const GAP: i32 = 8 * PIXEL as i32;

/// Opacity of a band.
pub(super) const BAND: f64 = 0.25;

/// Sample of a curve that starts at a place.
pub(super) fn sample<DB: DrawingBackend>(
    style: Style,
    colour: Colour,
    (x, y): (i32, i32),
    length: i32,
) -> DynElement<'static, DB, (i32, i32)> {
    match style {
        Style::Points => Circle::new((x + length / 2, y), 3 * PIXEL, colour.rgb().filled()).into_dyn(),
        Style::Band => {
            let half = 5 * PIXEL as i32;
            Rectangle::new([(x, y - half), (x + length, y + half)], colour.rgb().mix(BAND).filled())
                .into_dyn()
        }
        _ => PathElement::new([(x, y), (x + length, y)], stroke(style, colour)).into_dyn(),
    }
}

/// Draws the legend of a panel at the right of its axes, one curve a line.
pub(super) fn beside<DB: DrawingBackend>(panel: &Panel, area: &Area<DB>) -> Drawn<DB> {
    let named = panel.series.iter().zip(colours(&panel.series)).filter(|(series, _)| !series.name.is_empty());
    for (line, (series, colour)) in named.enumerate() {
        let y = FIRST + LINE * line as i32;
        area.draw(&sample(series.style, colour, (0, y), LONG))?;
        let style = font(13).color(&BLACK).pos(Pos::new(HPos::Left, VPos::Center));
        area.draw(&Text::new(series.name.clone(), (LONG + GAP, y), style))?;
    }
    Ok(())
}

/// Draws the legend of a panel within its axes; none without names.
pub(super) fn within<'a, DB: DrawingBackend + 'a>(
    panel: &Panel,
    chart: &mut Chart<'a, DB>,
    frame: &Frame,
) -> Drawn<DB> {
    if panel.series.iter().all(|series| series.name.is_empty()) {
        return Ok(());
    }
    let points: Vec<_> = panel.series.iter().flat_map(Series::finite_points).collect();
    draw(chart, emptiest_place(&points, frame, fraction(panel)))
}

fn draw<'a, DB: DrawingBackend + 'a>(chart: &mut Chart<'a, DB>, position: SeriesLabelPosition) -> Drawn<DB> {
    chart
        .configure_series_labels()
        .position(position)
        .margin(8 * PIXEL)
        .legend_area_size(30 * PIXEL)
        .background_style(WHITE.mix(0.8))
        .border_style(BLACK.mix(0.3).stroke_width(PIXEL))
        .label_font(font(12))
        .draw()
}

/// About what fraction of its panel a legend covers, along and up.
fn fraction(panel: &Panel) -> (f64, f64) {
    let longest = panel.series.iter().map(|series| series.name.chars().count()).max().unwrap_or(0);
    let (width, height) = (50.0 + 6.0 * longest as f64, 10.0 + 14.0 * panel.series.len() as f64);
    // Less what stands around the axes.
    let axes = (f64::from(WIDTH / PIXEL) - 110.0, f64::from(PANEL_HEIGHT / PIXEL) - 60.0);
    ((width / axes.0).clamp(0.25, 0.9), (height / axes.1).clamp(0.25, 0.9))
}

/// The place at the left or right edge where a legend of this fraction covers the fewest points; the upper right of equals.
fn emptiest_place(points: &[(f64, f64)], frame: &Frame, (wide, high): (f64, f64)) -> SeriesLabelPosition {
    let places = [
        (SeriesLabelPosition::UpperRight, 1.0, 1.0),
        (SeriesLabelPosition::UpperLeft, 0.0, 1.0),
        (SeriesLabelPosition::LowerRight, 1.0, 0.0),
        (SeriesLabelPosition::LowerLeft, 0.0, 0.0),
        (SeriesLabelPosition::MiddleRight, 1.0, 0.5),
        (SeriesLabelPosition::MiddleLeft, 0.0, 0.5),
    ];
    let covers = |value: f64, (least, most): (f64, f64), fraction: f64, at: f64| {
        let from = at * (1.0 - fraction);
        (from..=from + fraction).contains(&((value - least) / (most - least)))
    };
    let crowd = |x: f64, y: f64| {
        let covered =
            |point: &&(f64, f64)| covers(point.0, frame.x, wide, x) && covers(point.1, frame.y, high, y);
        points.iter().filter(covered).count()
    };
    let best = places.into_iter().min_by_key(|(_, x, y)| crowd(*x, *y));
    best.map_or(SeriesLabelPosition::UpperRight, |(position, ..)| position)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_legend_stands_where_it_covers_least() {
        let frame = Frame {
            x: (0.0, 1.0),
            y: (0.0, 1.0),
            small: false,
            beside: false,
            column: 1e-3,
            describes: (true, true),
        };
        let place =
            |points: &[(f64, f64)], fraction| format!("{:?}", emptiest_place(points, &frame, fraction));
        assert_eq!(place(&[], (0.3, 0.3)), "UpperRight");
        assert_eq!(place(&[(0.9, 0.9)], (0.3, 0.3)), "UpperLeft");
        let lines = [(0.5, 0.05), (0.5, 0.95)];
        assert_eq!(place(&lines, (0.3, 0.3)), "UpperRight");
        assert_eq!(place(&lines, (0.6, 0.3)), "MiddleRight");
    }
}
