//! Encoders that a controller reads.

use super::GearFile;

/// Which encoders the controller reads; motor torque it always does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SensorSet {
    /// The motor's alone.
    Motor,
    /// The motor's and the output's.
    Both,
}

impl SensorSet {
    /// Both of them.
    pub const ALL: [Self; 2] = [Self::Motor, Self::Both];

    /// Sensors of a gear file's joint.
    pub fn of(file: &GearFile) -> Self {
        if file.sensors.output_encoder_bits.is_some() { Self::Both } else { Self::Motor }
    }

    /// The one of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|set| set.name() == name)
    }

    /// The name, as in `motor`.
    pub fn name(self) -> &'static str {
        ["motor", "both"][self as usize]
    }
}
