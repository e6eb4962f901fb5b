//! The operating points at which a controller is linearised.

use super::controller::Controller;
use super::corners::Point;
use super::mode::Mode;
use super::parts::Parts;
use crate::io::gear_file::GearFile;
use crate::io::gear_file::SensorSet;

/// A controller at one operating point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Variant {
    /// Its sensors.
    pub set: SensorSet,
    /// Its gains.
    pub mode: Mode,
    /// Operating point on the gear's line.
    pub point: Point,
    /// The disturbance path passes everything, or nothing: the ends of its dead zone's describing function.
    pub passes: bool,
}

impl Variant {
    /// Those of a set with the disturbance path on or off.
    pub fn all(set: SensorSet, passes: bool) -> impl Iterator<Item = Self> {
        let points = move |mode| Point::ALL.map(|point| Self { set, mode, point, passes });
        Mode::ALL.into_iter().flat_map(points)
    }

    /// The controller.
    pub fn controller(&self, file: &GearFile, parts: &Parts) -> Controller {
        Controller::new(file, parts, self.set, self.mode, self.point.stiffness(file), self.passes)
    }
}
