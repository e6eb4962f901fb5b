//! The one table of bounds: what each claimed figure may be at most, and why.
//!
//! Tests and `strainwave verify` read the same rows. A row that nothing measures, and a bound that has
//! become [`LOOSE`] times too loose, fail a test.

use crate::figure::Figure;

/// The largest value that a figure may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// The figure's name, dotted and stable.
    pub name: &'static str,
    /// Largest allowed value, in `unit`.
    pub value: f64,
    /// SI unit or "1".
    pub unit: &'static str,
    /// What the value follows from.
    pub why: &'static str,
}

/// A bound this many times its figure says nothing any more.
pub const LOOSE: f64 = 10.0;

/// Every bound, by name.
pub const BOUNDS: &[Bound] = &[Bound {
    name: "angle.torsion.million_turns",
    value: 2e-10,
    unit: "rad",
    why: "f32 torsion up to 1.5 mrad after 10^6 wave-generator turns: a 24-bit difference, 1 unit of which is \
          1.2e-10 rad; the observer needs 1e-6",
}];

impl Bound {
    /// The figure `value` beside this bound.
    pub fn figure(&self, value: f64) -> Figure {
        Figure::bounded(self.name, value, self.unit, self.value)
    }

    /// The bound is so far above `value` that it would not notice a loss of accuracy.
    pub fn is_loose(&self, value: f64) -> bool {
        value * LOOSE < self.value
    }
}

/// The row of a name.
pub fn find(name: &str) -> Option<&'static Bound> {
    BOUNDS.iter().find(|bound| bound.name == name)
}

/// The measured `value` beside the bound of that name.
///
/// # Panics
/// When the table has no such row, which is a mistake in the program: a measured claim has a bound.
pub fn figure(name: &str, value: f64) -> Figure {
    let bound = find(name).unwrap_or_else(|| panic!("no bound is named {name}"));
    bound.figure(value)
}
