//! Pictures of curves: panels one under the other, or small ones side by side on the same axes, in one SVG file.
//!
//! Text is SVG text in the viewer's sans-serif font: no font file is needed to draw. Curves are
//! thinned to the picture's resolution by lowest and highest point, so a file stays small and a
//! spike of one sample stays visible.
//!
//! ```
//! use strainwave_desktop::plot::{Page, Panel, Series};
//! let time: Vec<f64> = (0..1000).map(|k| f64::from(k) * 1e-3).collect();
//! let torsion: Vec<f64> = time.iter().map(|t| 1e-3 * (20.0 * t).sin()).collect();
//! let panel = Panel::new("time", "s", "torsion", "rad").with(Series::line("model", &time, &torsion));
//! let svg = Page::new("Wind-up").with(panel).to_svg();
//! assert!(svg.starts_with("<svg") && svg.contains("torsion [rad]"));
//! ```

mod decimate;
mod draw;

use std::path::Path;

use crate::io::file::{self, BadInput};

/// Larger numbers (and NaN) are no physical quantity, and the span of two of them can overflow.
const LARGEST: f64 = 1e100;

/// A picture: a title and panels.
#[derive(Clone, Debug)]
pub struct Page {
    title: String,
    columns: usize,
    panels: Vec<Panel>,
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
}

/// Style of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Style {
    Line,
    Dashed,
    Points,
}

impl Series {
    fn new(name: impl Into<String>, x: &[f64], y: &[f64], style: Style) -> Self {
        Self { name: name.into(), points: x.iter().copied().zip(y.iter().copied()).collect(), style }
    }

    /// A line through the points; those that are not finite are left out.
    pub fn line(name: impl Into<String>, x: &[f64], y: &[f64]) -> Self {
        Self::new(name, x, y, Style::Line)
    }

    /// A dashed line: a reference, a setpoint, a bound.
    pub fn dashed(name: impl Into<String>, x: &[f64], y: &[f64]) -> Self {
        Self::new(name, x, y, Style::Dashed)
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
        Self::small_multiples(title, 1)
    }

    /// An empty page for small panels row by row, `columns` side by side (1 or more), with the same ranges of both axes
    /// for all: what is written along them stands at the left and at the bottom.
    pub fn small_multiples(title: impl Into<String>, columns: usize) -> Self {
        Self { title: title.into(), columns: columns.max(1), panels: Vec::new() }
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

    proptest! {
        #[test]
        fn any_numbers_make_a_picture(
            points in prop::collection::vec((prop::num::f64::ANY, prop::num::f64::ANY), 0..20),
            columns in 0..4usize,
        ) {
            let (x, y): (Vec<_>, Vec<_>) = points.into_iter().unzip();
            let panel = Panel::new("x", "1", "y", "N m").titled("any")
                .with(Series::line("line", &x, &y)).with(Series::dashed("dashed", &y, &x)).with(Series::points("", &x, &x));
            let svg = Page::small_multiples("any", columns).with(panel.clone()).with(panel).to_svg();
            prop_assert!(svg.trim_end().ends_with("</svg>") && !svg.contains("NaN") && !svg.contains("inf"));
        }

        #[test]
        fn narrow_spans_make_a_picture(at in -1e6..1e6f64, span in -20..0i32) {
            let x = [at, at + at.abs() * 10f64.powi(span), at];
            let svg = Page::new("").with(Panel::new("x", "", "y", "").with(Series::line("a", &x, &x))).to_svg();
            prop_assert!(svg.trim_end().ends_with("</svg>"));
        }
    }
}
