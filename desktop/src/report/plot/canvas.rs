//! Canvas that a page is drawn on: its units, its writing, and the frame of a panel.

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

/// `plotters` rounds to whole units: a quarter of a pixel each keeps slanted lines smooth.
pub(super) const PIXEL: u32 = 4;
pub(super) const WIDTH: u32 = 900 * PIXEL;
pub(super) const PANEL_HEIGHT: u32 = 300 * PIXEL;

pub(super) type Area<DB> = DrawingArea<DB, Shift>;
pub(super) type Drawn<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;
pub(super) type Chart<'a, DB> = ChartContext<'a, DB, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Frame of a panel on its page.
pub(super) struct Frame {
    pub(super) x: (f64, f64),
    pub(super) y: (f64, f64),
    /// One of several side by side.
    pub(super) small: bool,
    /// The legend stands at the right of the axes.
    pub(super) beside: bool,
    /// Width along the x axis within which a curve is thinned.
    pub(super) column: f64,
    /// Labels along the axes.
    pub(super) describes: (bool, bool),
}

impl Frame {
    /// The size of large writing, or of small.
    pub(super) fn size(&self, large: u32, small: u32) -> u32 {
        if self.small { small } else { large }
    }
}

/// The viewer's sans-serif, `size` in pixels.
pub(super) fn font(size: u32) -> FontDesc<'static> {
    ("sans-serif", size * PIXEL).into_font()
}
