//! A page drawn with `plotters` on its SVG backend.

use plotters::prelude::*;

use super::canvas::{Area, Chart, Drawn, Frame, PANEL_HEIGHT, PIXEL, WIDTH, font};
use super::decimate::thin;
use super::legend::{self, BAND, SHORT};
use super::pen::{Colour, colours, stroke, with_dashes};
use super::{Layout, Page, Panel, Series, Style};

const TITLE_HEIGHT: u32 = 36 * PIXEL;
const SMALL_HEIGHT: u32 = 190 * PIXEL;

/// Height of the panels of a slide together, 16:9 with their title, and the least of one.
const SLIDE_HEIGHT: u32 = 470 * PIXEL;
const LEAST_HEIGHT: u32 = 190 * PIXEL;

/// Curves on a page that are drawn with a point for every pixel; of more, each has fewer.
const FINE_CURVES: f64 = 8.0;

pub(super) fn svg(page: &Page) -> String {
    let height = title_height(page) + panel_height(page) * rows(page) as u32;
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, (WIDTH, height)).into_drawing_area();
        draw_page(page, &area).expect("drawing into memory meets no file system");
    }
    // The size to show it at; the view box keeps the drawing's own units.
    let drawn = format!("width=\"{WIDTH}\" height=\"{height}\"");
    let size = format!("width=\"{}\" height=\"{}\"", WIDTH / PIXEL, height / PIXEL);
    // Rounded, a sharp corner of a broad line is no spike.
    let shown = format!("{size} stroke-linejoin=\"round\"");
    with_dashes(&text.replacen(&drawn, &shown, 1))
}

fn panel_height(page: &Page) -> u32 {
    match page.layout {
        Layout::Column => PANEL_HEIGHT,
        Layout::Multiples(_) => SMALL_HEIGHT,
        Layout::Slide => (SLIDE_HEIGHT / rows(page) as u32).max(LEAST_HEIGHT),
    }
}

/// At least one, so that an empty page has a size.
fn rows(page: &Page) -> usize {
    page.panels.len().div_ceil(page.columns()).max(1)
}

/// A page without a title has no room for one.
fn title_height(page: &Page) -> u32 {
    if page.title.is_empty() { 0 } else { TITLE_HEIGHT }
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
    for (index, area) in below.split_evenly((rows(page), page.columns())).iter().enumerate() {
        if let Some(panel) = page.panels.get(index) {
            draw_panel(panel, area, &frame(page, index))?;
        }
    }
    area.present()
}

fn frame(page: &Page, index: usize) -> Frame {
    let small = matches!(page.layout, Layout::Multiples(_));
    let beside = page.layout == Layout::Slide;
    let shared = if small { &page.panels[..] } else { &page.panels[index..=index] };
    let points = || shared.iter().flat_map(|panel| &panel.series).flat_map(Series::finite_points);
    let x = range(points().map(|point| point.0), 0.0);
    let width = if beside { WIDTH - legend::BESIDE } else { WIDTH / page.columns() as u32 } / PIXEL;
    Frame {
        x,
        column: (x.1 - x.0) / f64::from(width) * coarseness(page),
        y: range(points().map(|point| point.1), 0.05),
        small,
        beside,
        describes: (
            !small || index + page.columns() >= page.panels.len(),
            index.is_multiple_of(page.columns()),
        ),
    }
}

/// Pixels within which a curve is thinned: more on a slide of many curves, so that its file stays small.
fn coarseness(page: &Page) -> f64 {
    let curves =
        page.panels.iter().flat_map(|panel| &panel.series).map(|series| series.style.curves()).sum::<f64>();
    if page.layout == Layout::Slide { (curves / FINE_CURVES).max(1.0) } else { 1.0 }
}

fn draw_panel<DB: DrawingBackend>(panel: &Panel, area: &Area<DB>, frame: &Frame) -> Drawn<DB> {
    let (x, y) = (frame.x, frame.y);
    let (width, _) = area.dim_in_pixel();
    let parts = frame.beside.then(|| area.split_horizontally(width - legend::BESIDE));
    let mut builder = ChartBuilder::on(parts.as_ref().map_or(area, |(left, _)| left));
    builder.margin(frame.size(10, 4) * PIXEL).margin_right(frame.size(20, 10) * PIXEL);
    builder.x_label_area_size(frame.size(40, 36) * PIXEL).y_label_area_size(frame.size(80, 56) * PIXEL);
    if !panel.title.is_empty() {
        builder.caption(&panel.title, font(frame.size(15, 13)));
    }
    let mut chart = builder.build_cartesian_2d(x.0..x.1, y.0..y.1)?;
    draw_axes(panel, &mut chart, frame)?;
    for (series, colour) in panel.series.iter().zip(colours(&panel.series)) {
        draw_series(series, colour, &mut chart, frame)?;
    }
    match parts {
        Some((_, right)) => legend::beside(panel, &right),
        None => legend::within(panel, &mut chart, frame),
    }
}

fn draw_axes<'a, DB: DrawingBackend + 'a>(
    panel: &Panel,
    chart: &mut Chart<'a, DB>,
    frame: &Frame,
) -> Drawn<DB> {
    let described = |text: &str, here: bool| if here { text.to_owned() } else { String::new() };
    chart
        .configure_mesh()
        .x_desc(described(&panel.x, frame.describes.0))
        .y_desc(described(&panel.y, frame.describes.1))
        .x_labels(frame.size(10, 5) as usize)
        .y_labels(frame.size(7, 5) as usize)
        .x_label_formatter(&|value| tick(*value, frame.x))
        .y_label_formatter(&|value| tick(*value, frame.y))
        .set_all_tick_mark_size(5 * PIXEL)
        .axis_style(BLACK.stroke_width(PIXEL))
        .bold_line_style(BLACK.mix(0.15).stroke_width(PIXEL))
        .light_line_style(TRANSPARENT)
        .axis_desc_style(font(frame.size(14, 12)))
        .label_style(font(frame.size(12, 11)))
        .draw()
}

fn draw_series<'a, DB: DrawingBackend + 'a>(
    series: &Series,
    colour: Colour,
    chart: &mut Chart<'a, DB>,
    frame: &Frame,
) -> Drawn<DB> {
    let thinned = thin(series.finite_points(), frame.column);
    let filled = colour.rgb().filled();
    let style = series.style;
    let drawn = match style {
        Style::Points => {
            chart.draw_series(thinned.into_iter().map(|point| Circle::new(point, 3 * PIXEL, filled)))?
        }
        Style::Band => {
            let fill = colour.rgb().mix(BAND).filled();
            chart.draw_series([Polygon::new(thinned, fill)])?
        }
        _ => chart.draw_series(LineSeries::new(thinned, stroke(style, colour)))?,
    };
    if !frame.beside && !series.name.is_empty() {
        drawn.label(&series.name).legend(move |place| legend::sample(style, colour, place, SHORT));
    }
    Ok(())
}

/// From lowest to highest, widened by a fraction of the span; a span of 0 by one part of the value.
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
