//! Measures the figures that the project claims, each beside its row in [`crate::bounds`].

mod angle;
mod gear;

use crate::figure::Figure;

/// A part of the project whose figures are measured together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Unbounded angles in f32.
    Angle,
    /// The real-time build of the gear against the reference.
    Gear,
}

impl Part {
    /// Every part.
    pub const ALL: [Self; 2] = [Self::Angle, Self::Gear];

    /// As the command names it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Angle => "angle",
            Self::Gear => "gear",
        }
    }

    /// The part of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|part| part.name() == name)
    }

    /// Measures the part's figures.
    pub fn measure(self) -> Vec<Figure> {
        match self {
            Self::Angle => angle::measure(),
            Self::Gear => gear::measure(),
        }
    }
}
