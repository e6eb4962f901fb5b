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
const SMALL_HEIGHT: u32 = 190 * PIXEL;

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

/// Frame of a panel on its page.
struct Frame {
    x: (f64, f64),
    y: (f64, f64),
    /// One of several side by side.
    small: bool,
    /// Width of a pixel along the x axis.
    pixel: f64,
    /// Labels along the axes.
    describes: (bool, bool),
}

impl Frame {
    /// The size of large writing, or of small.
    fn size(&self, large: u32, small: u32) -> u32 {
        if self.small { small } else { large }
    }
}

pub(super) fn svg(page: &Page) -> String {
    let panel_height = if page.columns > 1 { SMALL_HEIGHT } else { PANEL_HEIGHT };
    let height = title_height(page) + panel_height * rows(page) as u32;
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, (WIDTH, height)).into_drawing_area();
        draw_page(page, &area).expect("drawing into memory meets no file system");
    }
    // The size to show it at; the view box keeps the drawing's own units.
    let drawn = format!("width=\"{WIDTH}\" height=\"{height}\"");
    text.replacen(&drawn, &format!("width=\"{}\" height=\"{}\"", WIDTH / PIXEL, height / PIXEL), 1)
}

/// At least one, so that an empty page has a size.
fn rows(page: &Page) -> usize {
    page.panels.len().div_ceil(page.columns).max(1)
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
    for (index, area) in below.split_evenly((rows(page), page.columns)).iter().enumerate() {
        if let Some(panel) = page.panels.get(index) {
            draw_panel(panel, area, &frame(page, index))?;
        }
    }
    area.present()
}

fn frame(page: &Page, index: usize) -> Frame {
    let small = page.columns > 1;
    let shared = if small { &page.panels[..] } else { &page.panels[index..=index] };
    let points = || shared.iter().flat_map(|panel| &panel.series).flat_map(Series::finite_points);
    let x = range(points().map(|point| point.0), 0.0);
    Frame {
        x,
        pixel: (x.1 - x.0) * page.columns as f64 / f64::from(WIDTH / PIXEL),
        y: range(points().map(|point| point.1), 0.05),
        small,
        describes: (!small || index + page.columns >= page.panels.len(), index.is_multiple_of(page.columns)),
    }
}

fn draw_panel<DB: DrawingBackend>(panel: &Panel, area: &Area<DB>, frame: &Frame) -> Drawn<DB> {
    let points = || panel.series.iter().flat_map(Series::finite_points);
    let (x, y) = (frame.x, frame.y);
    let mut builder = ChartBuilder::on(area);
    builder.margin(frame.size(10, 4) * PIXEL).margin_right(frame.size(20, 10) * PIXEL);
    builder.x_label_area_size(frame.size(40, 36) * PIXEL).y_label_area_size(frame.size(80, 56) * PIXEL);
    if !panel.title.is_empty() {
        builder.caption(&panel.title, font(frame.size(15, 13)));
    }
    let mut chart = builder.build_cartesian_2d(x.0..x.1, y.0..y.1)?;
    draw_axes(panel, &mut chart, frame)?;
    for (series, colour) in panel.series.iter().zip(colours(&panel.series)) {
        draw_series(series, colour, &mut chart, frame.pixel)?;
    }
    if panel.series.iter().any(|series| !series.name.is_empty()) {
        let points: Vec<_> = points().collect();
        draw_legend(&mut chart, emptiest_place(&points, frame, legend_share(panel)))?;
    }
    Ok(())
}

/// One each; a curve without a name goes with the last that has one, as the other edge of a band does.
fn colours(series: &[Series]) -> impl Iterator<Item = RGBColor> {
    (0..series.len()).map(|index| {
        let named = series[..=index].iter().rposition(|series| !series.name.is_empty());
        COLOURS[named.unwrap_or(index) % COLOURS.len()]
    })
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

/// About what share of its panel a legend covers, along and up.
fn legend_share(panel: &Panel) -> (f64, f64) {
    let longest = panel.series.iter().map(|series| series.name.chars().count()).max().unwrap_or(0);
    let (width, height) = (50.0 + 6.0 * longest as f64, 10.0 + 14.0 * panel.series.len() as f64);
    // Less what stands around the axes.
    let axes = (f64::from(WIDTH / PIXEL) - 110.0, f64::from(PANEL_HEIGHT / PIXEL) - 60.0);
    ((width / axes.0).clamp(0.25, 0.9), (height / axes.1).clamp(0.25, 0.9))
}

/// The place at the left or right edge where a legend of this share covers the fewest points; the upper right of equals.
fn emptiest_place(points: &[(f64, f64)], frame: &Frame, (wide, high): (f64, f64)) -> SeriesLabelPosition {
    let places = [
        (SeriesLabelPosition::UpperRight, 1.0, 1.0),
        (SeriesLabelPosition::UpperLeft, 0.0, 1.0),
        (SeriesLabelPosition::LowerRight, 1.0, 0.0),
        (SeriesLabelPosition::LowerLeft, 0.0, 0.0),
        (SeriesLabelPosition::MiddleRight, 1.0, 0.5),
        (SeriesLabelPosition::MiddleLeft, 0.0, 0.5),
    ];
    let covers = |value: f64, (least, most): (f64, f64), share: f64, at: f64| {
        let from = at * (1.0 - share);
        (from..=from + share).contains(&((value - least) / (most - least)))
    };
    let crowd = |x: f64, y: f64| {
        let covered =
            |point: &&(f64, f64)| covers(point.0, frame.x, wide, x) && covers(point.1, frame.y, high, y);
        points.iter().filter(covered).count()
    };
    let best = places.into_iter().min_by_key(|(_, x, y)| crowd(*x, *y));
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
    fn a_curve_without_a_name_goes_with_the_one_before() {
        let of = |names: &[&str]| -> Vec<_> {
            let series: Vec<_> = names.iter().map(|name| Series::line(*name, &[], &[])).collect();
            colours(&series)
                .map(|colour| COLOURS.iter().position(|known| *known == colour).unwrap())
                .collect()
        };
        assert_eq!(of(&["error", "band", "", "last"]), [0, 1, 1, 3]);
        assert_eq!(of(&["", ""]), [0, 1]);
    }

    #[test]
    fn a_legend_stands_where_it_covers_least() {
        let frame =
            Frame { x: (0.0, 1.0), y: (0.0, 1.0), small: false, pixel: 1e-3, describes: (true, true) };
        let place = |points: &[(f64, f64)], share| format!("{:?}", emptiest_place(points, &frame, share));
        assert_eq!(place(&[], (0.3, 0.3)), "UpperRight");
        assert_eq!(place(&[(0.9, 0.9)], (0.3, 0.3)), "UpperLeft");
        let lines = [(0.5, 0.05), (0.5, 0.95)];
        assert_eq!(place(&lines, (0.3, 0.3)), "UpperRight");
        assert_eq!(place(&lines, (0.6, 0.3)), "MiddleRight");
    }

    #[test]
    fn a_range_always_has_a_width() {
        assert_eq!(range([].into_iter(), 0.1), (0.0, 1.0));
        assert_eq!(range([2.0].into_iter(), 0.1), (1.0, 3.0));
        assert_eq!(range([0.0, 0.0].into_iter(), 0.1), (-1.0, 1.0));
        assert_eq!(range([0.0, 10.0].into_iter(), 0.1), (-1.0, 11.0));
    }
}
