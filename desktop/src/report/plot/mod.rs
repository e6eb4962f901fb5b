//! Pictures of curves: panels one under the other, small ones side by side on the same axes, or a slide, in one SVG file.
//!
//! Text is SVG text in the viewer's sans-serif font: no font file is needed to draw. Curves are
//! thinned to the picture's resolution by lowest and highest point, so a file stays small and a
//! spike of one sample stays visible.
//!
//! ```
//! use strainwave_desktop::report::plot::{Page, Panel, Series};
//! let time: Vec<f64> = (0..1000).map(|k| f64::from(k) * 1e-3).collect();
//! let torsion: Vec<f64> = time.iter().map(|t| 1e-3 * (20.0 * t).sin()).collect();
//! let panel = Panel::new("time", "s", "torsion", "rad").with(Series::line("model", &time, &torsion));
//! let svg = Page::new("Wind-up").with(panel).to_svg();
//! assert!(svg.starts_with("<svg") && svg.contains("torsion [rad]"));
//! ```

mod canvas;
mod decimate;
mod draw;
mod legend;
mod pen;

use std::path::Path;

use crate::io::file::{self, BadInput};
pub use pen::Colour;

/// Larger numbers (and NaN) are no physical quantity, and the span of two of them can overflow.
const LARGEST: f64 = 1e100;

/// A picture: a title and panels.
#[derive(Clone, Debug)]
pub struct Page {
    title: String,
    layout: Layout,
    panels: Vec<Panel>,
}

/// Arrangement of the panels of a page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Layout {
    /// One under the other.
    Column,
    /// So many small ones side by side.
    Multiples(usize),
    /// One under the other in the shape of a slide, legends beside the axes.
    Slide,
}

/// One pair of axes with its curves.
#[derive(Clone, Debug)]
pub struct Panel {
    title: String,
    x: String,
    y: String,
    series: Vec<Series>,
}

/// One curve.
#[derive(Clone, Debug)]
pub struct Series {
    name: String,
    points: Vec<(f64, f64)>,
    style: Style,
    colour: Option<Colour>,
}

/// Style of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Style {
    Line,
    Broad,
    Dashed,
    Dotted,
    DashDotted,
    Points,
    Band,
}

impl Style {
    /// Curves that it takes to draw it: two around a band.
    fn curves(self) -> f64 {
        if self == Self::Band { 2.0 } else { 1.0 }
    }
}

impl Series {
    fn new(name: impl Into<String>, x: &[f64], y: &[f64], style: Style) -> Self {
        let points = x.iter().copied().zip(y.iter().copied()).collect();
        Self { name: name.into(), points, style, colour: None }
    }

    /// A line through the points; those that are not finite are left out.
    pub fn line(name: impl Into<String>, x: &[f64], y: &[f64]) -> Self {
        Self::new(name, x, y, Style::Line)
    }

    /// A dashed line: a reference, a setpoint, a bound.
    pub fn dashed(name: impl Into<String>, x: &[f64], y: &[f64]) -> Self {
        Self::new(name, x, y, Style::Dashed)
    }

    /// A broad line, on which another stays visible that runs along it.
    pub fn broad(name: impl Into<String>, x: &[f64], y: &[f64]) -> Self {
        Self::new(name, x, y, Style::Broad)
    }

    /// A dotted line.
    pub fn dotted(name: impl Into<String>, x: &[f64], y: &[f64]) -> Self {
        Self::new(name, x, y, Style::Dotted)
    }

    /// A line of dashes and dots.
    pub fn dash_dotted(name: impl Into<String>, x: &[f64], y: &[f64]) -> Self {
        Self::new(name, x, y, Style::DashDotted)
    }

    /// The area between two curves over the same x.
    pub fn band(name: impl Into<String>, x: &[f64], [lower, upper]: [&[f64]; 2]) -> Self {
        let there_and_back: Vec<_> = x.iter().chain(x.iter().rev()).copied().collect();
        let around: Vec<_> = upper.iter().chain(lower.iter().rev()).copied().collect();
        Self::new(name, &there_and_back, &around, Style::Band)
    }

    /// In this colour instead of the panel's next.
    #[must_use]
    pub fn coloured(mut self, colour: Colour) -> Self {
        self.colour = Some(colour);
        self
    }

    /// Single points.
    pub fn points(name: impl Into<String>, x: &[f64], y: &[f64]) -> Self {
        Self::new(name, x, y, Style::Points)
    }

    fn finite_points(&self) -> impl Iterator<Item = (f64, f64)> {
        self.points.iter().copied().filter(|(x, y)| x.abs() <= LARGEST && y.abs() <= LARGEST)
    }
}

/// `name [unit]`; a quantity without a unit has the unit "1" or none.
fn label(name: &str, unit: &str) -> String {
    if unit.is_empty() || unit == "1" { name.to_owned() } else { format!("{name} [{unit}]") }
}

impl Panel {
    /// Axes `x_name [x_unit]` and `y_name [y_unit]`.
    pub fn new(x_name: &str, x_unit: &str, y_name: &str, y_unit: &str) -> Self {
        Self { title: String::new(), x: label(x_name, x_unit), y: label(y_name, y_unit), series: Vec::new() }
    }

    /// With a title of its own.
    #[must_use]
    pub fn titled(mut self, title: impl Into<String>) -> Self {
        self.title = title.into();
        self
    }

    /// With one more curve.
    #[must_use]
    pub fn with(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }
}

impl Page {
    /// An empty page for panels one under the other, each with axes of its own.
    pub fn new(title: impl Into<String>) -> Self {
        Self::arranged(title, Layout::Column)
    }

    /// An empty page of the shape 16:9 for up to two panels one under the other, higher for more, with the legends at
    /// the right of the axes: no curve is hidden.
    pub fn slide(title: impl Into<String>) -> Self {
        Self::arranged(title, Layout::Slide)
    }

    fn arranged(title: impl Into<String>, layout: Layout) -> Self {
        Self { title: title.into(), layout, panels: Vec::new() }
    }

    fn columns(&self) -> usize {
        match self.layout {
            Layout::Multiples(columns) => columns,
            Layout::Column | Layout::Slide => 1,
        }
    }

    /// An empty page for small panels row by row, `columns` side by side (1 or more), with the same ranges of both axes
    /// for all: what is written along them stands at the left and at the bottom.
    pub fn small_multiples(title: impl Into<String>, columns: usize) -> Self {
        Self::arranged(title, if columns > 1 { Layout::Multiples(columns) } else { Layout::Column })
    }

    /// With one more panel, below or at the right.
    #[must_use]
    pub fn with(mut self, panel: Panel) -> Self {
        self.panels.push(panel);
        self
    }

    /// The picture as SVG text, for a page that holds it inline.
    pub fn to_svg(&self) -> String {
        draw::svg(self)
    }

    /// Writes the SVG file, complete or not at all.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), BadInput> {
        let svg = self.to_svg();
        file::write(path, |out| Ok(out.write_all(svg.as_bytes())?))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Of panels one under the other every one says what its axes are; of small ones those at the left and at the bottom.
    #[test]
    fn axes_are_described_where_they_are_read() {
        let described = |mut page: Page, name: &str| {
            for _ in 0..5 {
                page = page.with(Panel::new("along", "m", "up", "N"));
            }
            page.to_svg().matches(name).count()
        };
        assert_eq!(["along", "up"].map(|name| described(Page::new(""), name)), [5, 5]);
        assert_eq!(["along", "up"].map(|name| described(Page::small_multiples("", 3), name)), [3, 2]);
    }

    /// Five curves of 100 000 points in each of four panels, of a noise that no thinning by slope can shorten.
    #[test]
    fn a_slide_of_long_curves_is_a_small_file() {
        let time: Vec<f64> = (0..100_000).map(|k| f64::from(k) * 1e-4).collect();
        let noise: Vec<f64> = (0..100_000u64).map(|k| (k * 7919 % 1009) as f64).collect();
        let panel = (0..5).fold(Panel::new("time", "s", "noise", "N m"), |panel, _| {
            panel.with(Series::dashed("noise", &time, &noise))
        });
        let slide = (0..4).fold(Page::slide("long"), |slide, _| slide.with(panel.clone()));
        let svg = slide.to_svg();
        assert!(svg.len() < 300_000, "{} bytes", svg.len());
        assert!(svg.contains("stroke-dasharray"));
    }

    proptest! {
        #[test]
        fn any_numbers_make_a_picture(
            points in prop::collection::vec((prop::num::f64::ANY, prop::num::f64::ANY), 0..20),
            columns in 0..4usize,
        ) {
            let (x, y): (Vec<_>, Vec<_>) = points.into_iter().unzip();
            let panel = Panel::new("x", "1", "y", "N m").titled("any")
                .with(Series::line("line", &x, &y)).with(Series::dashed("dashed", &y, &x)).with(Series::points("", &x, &x))
                .with(Series::band("band", &x, [&y, &x])).with(Series::broad("broad", &x, &y)).with(Series::dotted("dotted", &x, &y));
            for page in [Page::small_multiples("any", columns), Page::slide("any")] {
                let svg = page.with(panel.clone()).with(panel.clone()).to_svg();
                prop_assert!(svg.trim_end().ends_with("</svg>") && !svg.contains("NaN") && !svg.contains("inf"));
            }
        }

        #[test]
        fn narrow_spans_make_a_picture(at in -1e6..1e6f64, span in -20..0i32) {
            let x = [at, at + at.abs() * 10f64.powi(span), at];
            let svg = Page::new("").with(Panel::new("x", "", "y", "").with(Series::line("a", &x, &x))).to_svg();
            prop_assert!(svg.trim_end().ends_with("</svg>"));
        }
    }
}
