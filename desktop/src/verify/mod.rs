//! Verification: measures the figures that the project claims, each with its row in [`crate::verify::bounds`].
//!
//! These parts need no emulator; what is measured on the firmware image stands with the emulator. All figures repeat
//! exactly; times by the clock do not, and stand in [`crate::speed`].

pub mod baselines;
pub mod belt;
pub mod bounds;
pub mod catalogue;
pub mod compensator;
pub mod constants;
pub mod faults;
pub mod flexspline;
pub mod friction;
pub mod gauges;
pub mod healthy;
pub mod hysteresis;
pub mod identify;
pub mod judge;
pub mod link;
pub mod piezo;
pub mod replay;
pub mod robot;
pub mod robustness;
mod sensor;
pub mod step_response;
pub mod stored_map;

use self::bounds::LOOSE;
use crate::io::figure::Figure;
use crate::io::file::BadInput;

/// Measured figures and notes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    /// The figures.
    pub figures: Vec<Figure>,
    /// Skipped or unjudged figures with the reason, a line each.
    pub notes: Vec<String>,
}

impl Measured {
    /// Nothing, for this reason.
    fn skipped(why: String) -> Self {
        Self { notes: vec![why], ..Self::default() }
    }

    /// Takes what else was measured.
    pub fn add(&mut self, other: Self) {
        self.figures.extend(other.figures);
        self.notes.extend(other.notes);
    }

    /// The same, in which a figure far below its bound does not hold: such a bound would not notice a loss of accuracy.
    fn with_tight_bounds(mut self) -> Self {
        for figure in &mut self.figures {
            if bounds::find(&figure.name).is_some_and(|bound| bound.is_loose(figure.value)) {
                figure.holds = false;
                self.notes.push(format!("{}: its bound is more than {LOOSE} times too loose", figure.name));
            }
        }
        self
    }
}

impl From<Vec<Figure>> for Measured {
    fn from(figures: Vec<Figure>) -> Self {
        Self { figures, ..Self::default() }
    }
}

/// The largest magnitude; NaN, which `f64::max` would pass over, counts as larger than any, and none as NaN.
fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    // Without its sign a NaN is the last in the total order.
    values.into_iter().map(f64::abs).max_by(f64::total_cmp).unwrap_or(f64::NAN)
}

/// A part of the project whose figures are measured together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The mesh against the catalogue, its reduction against the mesh, the real-time gear against the reference.
    Flexspline,
    /// Friction against closed forms, scipy and measured gears; work; f32 against f64.
    Friction,
    /// The staircase against the relays, its laws and its inverse, the default gear's loop, identification.
    Hysteresis,
    /// The belt gear against closed forms, energy, reduction, f32 against f64.
    Belt,
    /// The arm link against closed forms and finite elements, its laws.
    Link,
    /// The PZT patch against its constitutive law, its loop.
    Piezo,
    /// Readings of the sensors against the words of their datasheets.
    Sensor,
    /// Torque by strain gauges on the flexspline, and the observer with it.
    Gauges,
    /// Basis of the compensator: unbounded angles in f32.
    Compensator,
}

impl Part {
    /// Every part.
    pub const ALL: [Self; 9] = [
        Self::Flexspline,
        Self::Friction,
        Self::Hysteresis,
        Self::Belt,
        Self::Link,
        Self::Piezo,
        Self::Sensor,
        Self::Gauges,
        Self::Compensator,
    ];

    /// As the command names it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Flexspline => "flexspline",
            Self::Friction => "friction",
            Self::Hysteresis => "hysteresis",
            Self::Belt => "belt",
            Self::Link => "link",
            Self::Piezo => "piezo",
            Self::Sensor => "sensor",
            Self::Gauges => "gauges",
            Self::Compensator => "compensator",
        }
    }

    /// Measures the part's figures, but for those of many runs or logs ([`compensator::against_baselines`], [`replay`]).
    ///
    /// # Errors
    /// Measured data that are there and cannot be used.
    pub fn measure(self) -> Result<Measured, BadInput> {
        let measured = match self {
            Self::Flexspline => flexspline::measure(),
            Self::Friction => friction::measure(),
            Self::Hysteresis => hysteresis::measure(),
            Self::Belt => Ok(belt::measure()),
            Self::Link => Ok(link::measure()),
            Self::Piezo => Ok(piezo::measure()),
            Self::Sensor => Ok(sensor::measure()),
            Self::Gauges => gauges::measure(),
            Self::Compensator => Ok(compensator::measure()),
        };
        Ok(measured?.with_tight_bounds())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bound_that_is_too_loose_is_told_and_does_not_hold() {
        let name = "flexspline.8x3.ripple";
        let bound = bounds::find(name).unwrap().value;
        let measured = |value| Measured::from(vec![bounds::figure(name, value)]).with_tight_bounds();
        let (tight, loose) = (measured(0.11 * bound), measured(0.09 * bound));
        assert!(tight.figures[0].holds && tight.notes.is_empty());
        assert!(!loose.figures[0].holds && loose.notes[0].starts_with(name), "{loose:?}");
    }

    #[test]
    fn what_is_not_a_number_is_never_passed_over() {
        assert_eq!(largest([1.0, -3.0, 2.0]), 3.0);
        assert!(largest([1.0, f64::NAN, 2.0]).is_nan() && largest([1.0, -f64::NAN]).is_nan());
        assert!(largest([]).is_nan());
    }
}
