//! Controllers in the pictures and tables of a report: the same name, colour and stroke in all of them.

use super::plot::{Colour, Series};
use crate::io::gear_file::{Kind, SensorSet};

/// Controller of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Controller {
    /// A baseline, by its place among the baselines.
    Baseline(usize),
    /// The compensator with these sensors.
    Compensator(SensorSet),
}

impl Controller {
    /// As in the names of figures.
    pub fn name(self) -> &'static str {
        match self {
            Self::Baseline(place) => Kind::ALL[place].name(),
            Self::Compensator(sensors) => sensors.name(),
        }
    }

    /// For people.
    pub fn title(self) -> &'static str {
        match self {
            Self::Baseline(0) => "B0: cascade alone",
            Self::Baseline(1) => "B1: rigid joint",
            Self::Baseline(2) => "B2: stored error, wind-up",
            Self::Baseline(_) => "B3: output encoder",
            Self::Compensator(SensorSet::Motor) => "compensated, motor encoder",
            Self::Compensator(SensorSet::Both) => "compensated, both encoders",
        }
    }

    /// Sensors that it reads.
    pub fn sensors(self) -> SensorSet {
        match self {
            Self::Baseline(place) => Kind::ALL[place].sensors(),
            Self::Compensator(sensors) => sensors,
        }
    }

    /// It reads the output encoder.
    pub fn reads_output(self) -> bool {
        self.sensors() == SensorSet::Both
    }

    /// Curve of this controller with its name, colour and stroke.
    pub fn series(self, x: &[f64], y: &[f64]) -> Series {
        let title = self.title();
        match self {
            Self::Baseline(0) => Series::broad(title, x, y).coloured(Colour::SkyBlue),
            Self::Baseline(1) => Series::dashed(title, x, y).coloured(Colour::Vermilion),
            Self::Baseline(2) => Series::dotted(title, x, y).coloured(Colour::Green),
            Self::Baseline(_) => Series::dash_dotted(title, x, y).coloured(Colour::Purple),
            Self::Compensator(_) => Series::line("compensated", x, y).coloured(Colour::Blue),
        }
    }
}
