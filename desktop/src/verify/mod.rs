//! Measures the figures that the project claims, each beside its row in [`crate::bounds`].
//!
//! These parts need no emulator; what is measured on the firmware image stands with the emulator.

mod angle;
mod flexspline;
pub mod flexspline_oracle;
mod friction;
mod gear;
mod hysteresis;
mod strain;

use crate::figure::Figure;

/// A part of the project whose figures are measured together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The mesh against the catalogue, its reduction against the mesh, the real-time gear against the reference.
    Flexspline,
    /// Bliman-Sorine against its closed form, f32 against f64.
    Friction,
    /// The staircase against the relays, the default gear's loop.
    Hysteresis,
    /// What the compensator rests on: unbounded angles in f32.
    Compensator,
}

impl Part {
    /// Every part.
    pub const ALL: [Self; 4] = [Self::Flexspline, Self::Friction, Self::Hysteresis, Self::Compensator];

    /// As the command names it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Flexspline => "flexspline",
            Self::Friction => "friction",
            Self::Hysteresis => "hysteresis",
            Self::Compensator => "compensator",
        }
    }

    /// Measures the part's figures.
    pub fn measure(self) -> Vec<Figure> {
        match self {
            Self::Flexspline => {
                [flexspline::measure(), flexspline_oracle::measure(), strain::measure(), gear::measure()]
                    .concat()
            }
            Self::Friction => friction::measure(),
            Self::Hysteresis => hysteresis::measure(),
            Self::Compensator => angle::measure(),
        }
    }
}
