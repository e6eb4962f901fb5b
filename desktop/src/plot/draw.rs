//! A page drawn with `plotters` on its SVG backend.

use plotters::chart::SeriesLabelPosition;
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::element::DashedPathElement;
use plotters::prelude::*;

use super::decimate::thin;
use super::{Page, Panel, Series, Style};

/// `plotters` rounds to whole units: a quarter of a pixel each keeps slanted lines smooth.
const PIXEL: u32 = 4;
const WIDTH: u32 = 900 * PIXEL;
const TITLE_HEIGHT: u32 = 36 * PIXEL;
const PANEL_HEIGHT: u32 = 300 * PIXEL;

/// Lengths of a dash and of the space behind it.
const DASH: (u32, u32) = (6 * PIXEL, 4 * PIXEL);

/// Length of a line's sample in the legend.
const KEY: i32 = 20 * PIXEL as i32;

/// Okabe and Ito's colours, told apart with any colour vision and in grey print.
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(0, 0, 0),
];

type Area<DB> = DrawingArea<DB, Shift>;
type Drawn<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;
type Chart<'a, DB> = ChartContext<'a, DB, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

pub(super) fn svg(page: &Page) -> String {
    let height = title_height(page) + PANEL_HEIGHT * page.panels.len().max(1) as u32;
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, (WIDTH, height)).into_drawing_area();
        draw_page(page, &area).expect("drawing into memory meets no file system");
    }
    // The size to show it at; the view box keeps the drawing's own units.
    let drawn = format!("width=\"{WIDTH}\" height=\"{height}\"");
    text.replacen(&drawn, &format!("width=\"{}\" height=\"{}\"", WIDTH / PIXEL, height / PIXEL), 1)
}

/// A page without a title has no room for one.
fn title_height(page: &Page) -> u32 {
    if page.title.is_empty() { 0 } else { TITLE_HEIGHT }
}

/// The viewer's sans-serif, `size` in pixels.
fn font(size: u32) -> FontDesc<'static> {
    ("sans-serif", size * PIXEL).into_font()
}

fn draw_page<DB: DrawingBackend>(page: &Page, area: &Area<DB>) -> Drawn<DB> {
    area.fill(&WHITE)?;
    let title_height = title_height(page);
    let (top, below) = area.split_vertically(title_height);
    let style = font(20).color(&BLACK);
    let centre = plotters::style::text_anchor::Pos::new(
        plotters::style::text_anchor::HPos::Center,
        plotters::style::text_anchor::VPos::Center,
    );
    top.draw(&Text::new(page.title.clone(), (WIDTH as i32 / 2, title_height as i32 / 2), style.pos(centre)))?;
    for (panel, area) in page.panels.iter().zip(below.split_evenly((page.panels.len().max(1), 1))) {
        draw_panel(panel, &area)?;
    }
    area.present()
}

fn draw_panel<DB: DrawingBackend>(panel: &Panel, area: &Area<DB>) -> Drawn<DB> {
    let points = || panel.series.iter().flat_map(Series::finite_points);
    let x = range(points().map(|point| point.0), 0.0);
    let y = range(points().map(|point| point.1), 0.05);
    let mut builder = ChartBuilder::on(area);
    builder.margin(10 * PIXEL).margin_right(20 * PIXEL);
    builder.x_label_area_size(40 * PIXEL).y_label_area_size(80 * PIXEL);
    if !panel.title.is_empty() {
        builder.caption(&panel.title, font(15));
    }
    let mut chart = builder.build_cartesian_2d(x.0..x.1, y.0..y.1)?;
    draw_axes(panel, &mut chart, x, y)?;
    for (index, series) in panel.series.iter().enumerate() {
        draw_series(
            series,
            COLOURS[index % COLOURS.len()],
            &mut chart,
            (x.1 - x.0) / f64::from(WIDTH / PIXEL),
        )?;
    }
    if panel.series.iter().any(|series| !series.name.is_empty()) {
        let points: Vec<_> = points().collect();
        draw_legend(&mut chart, emptiest_corner(&points, x, y))?;
    }
    Ok(())
}

fn draw_axes<'a, DB: DrawingBackend + 'a>(
    panel: &Panel,
    chart: &mut Chart<'a, DB>,
    x: (f64, f64),
    y: (f64, f64),
) -> Drawn<DB> {
    chart
        .configure_mesh()
        .x_desc(&panel.x)
        .y_desc(&panel.y)
        .x_labels(10)
        .y_labels(7)
        .x_label_formatter(&|value| tick(*value, x))
        .y_label_formatter(&|value| tick(*value, y))
        .set_all_tick_mark_size(5 * PIXEL)
        .axis_style(BLACK.stroke_width(PIXEL))
        .bold_line_style(BLACK.mix(0.15).stroke_width(PIXEL))
        .light_line_style(TRANSPARENT)
        .axis_desc_style(font(14))
        .label_style(font(12))
        .draw()
}

fn draw_series<'a, DB: DrawingBackend + 'a>(
    series: &Series,
    colour: RGBColor,
    chart: &mut Chart<'a, DB>,
    column: f64,
) -> Drawn<DB> {
    let style = colour.stroke_width(3 * PIXEL / 2);
    let thinned = thin(series.finite_points(), column);
    let drawn = match series.style {
        Style::Line => chart.draw_series(LineSeries::new(thinned, style))?,
        Style::Dashed => chart.draw_series(DashedLineSeries::new(thinned, DASH.0, DASH.1, style))?,
        Style::Points => chart
            .draw_series(thinned.into_iter().map(|point| Circle::new(point, 3 * PIXEL, colour.filled())))?,
    };
    if series.name.is_empty() {
        return Ok(());
    }
    let sample = series.style;
    drawn.label(&series.name).legend(move |(x, y)| {
        let ends = [(x, y), (x + KEY, y)];
        match sample {
            Style::Line => PathElement::new(ends, style).into_dyn(),
            Style::Dashed => DashedPathElement::new(ends, DASH.0, DASH.1, style).into_dyn(),
            Style::Points => Circle::new((x + KEY / 2, y), 3 * PIXEL, colour.filled()).into_dyn(),
        }
    });
    Ok(())
}

fn draw_legend<'a, DB: DrawingBackend + 'a>(
    chart: &mut Chart<'a, DB>,
    position: SeriesLabelPosition,
) -> Drawn<DB> {
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

/// The corner, a quarter of the panel each way, with the fewest points; the upper right of equals.
fn emptiest_corner(points: &[(f64, f64)], x: (f64, f64), y: (f64, f64)) -> SeriesLabelPosition {
    let corners = [
        (SeriesLabelPosition::UpperRight, true, true),
        (SeriesLabelPosition::UpperLeft, false, true),
        (SeriesLabelPosition::LowerRight, true, false),
        (SeriesLabelPosition::LowerLeft, false, false),
    ];
    let within = |value: f64, (least, most): (f64, f64), high: bool| {
        let share = (value - least) / (most - least);
        if high { share > 0.75 } else { share < 0.25 }
    };
    let crowd = |right: bool, top: bool| {
        points.iter().filter(|point| within(point.0, x, right) && within(point.1, y, top)).count()
    };
    let best = corners.into_iter().min_by_key(|(_, right, top)| crowd(*right, *top));
    best.map_or(SeriesLabelPosition::UpperRight, |(position, ..)| position)
}

/// From lowest to highest, widened by a share of the span; a span of 0 by one part of the value.
fn range(values: impl Iterator<Item = f64>, margin: f64) -> (f64, f64) {
    let (least, most) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), v| (least.min(v), most.max(v)));
    if least > most {
        return (0.0, 1.0);
    }
    // Below a span of 1e-12 of the value the axis has no room for different tick labels.
    let least_span = least.abs().max(most.abs()).max(1e-30) * 1e-12;
    let span = most - least;
    if span <= least_span {
        let around = if most == 0.0 { 1.0 } else { most.abs() * 0.5 };
        (least - around, most + around)
    } else {
        (least - margin * span, most + margin * span)
    }
}

/// A tick's number with as many digits as the axis needs, in powers of ten far from 1.
fn tick(value: f64, (least, most): (f64, f64)) -> String {
    let span = most - least;
    let value = if value.abs() < 1e-9 * span { 0.0 } else { value };
    let size = least.abs().max(most.abs());
    if (1e-2..1e5).contains(&size) {
        let decimals = (2.0 - (span / 5.0).log10().floor()).clamp(0.0, 9.0) as usize;
        trim(&format!("{value:.decimals$}"))
    } else {
        let digits = ((size / span).log10().ceil() + 2.0).clamp(1.0, 9.0) as usize;
        let text = format!("{value:.digits$e}");
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        let mantissa = trim(mantissa);
        if mantissa == "0" { mantissa } else { format!("{mantissa}e{exponent}") }
    }
}

fn trim(number: &str) -> String {
    if number.contains('.') {
        number.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        number.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_have_the_digits_that_tell_them_apart() {
        assert_eq!(tick(0.3, (0.0, 1.0)), "0.3");
        assert_eq!(tick(1e-20, (-1.0, 1.0)), "0");
        assert_eq!(tick(-50.0, (-67.0, 67.0)), "-50");
        assert_eq!(tick(2.5e-4, (-1e-3, 1e-3)), "2.5e-4");
        assert_eq!(tick(31_000.5, (31_000.0, 31_001.0)), "31000.5");
        assert_eq!(tick(0.0, (-1e-3, 1e-3)), "0");
    }

    #[test]
    fn a_range_always_has_a_width() {
        assert_eq!(range([].into_iter(), 0.1), (0.0, 1.0));
        assert_eq!(range([2.0].into_iter(), 0.1), (1.0, 3.0));
        assert_eq!(range([0.0, 0.0].into_iter(), 0.1), (-1.0, 1.0));
        assert_eq!(range([0.0, 10.0].into_iter(), 0.1), (-1.0, 11.0));
    }
}
