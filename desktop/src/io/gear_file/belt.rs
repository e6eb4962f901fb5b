//! `[belt]` of a gear file: a tooth belt between the motor and the wave generator, the usual wrist.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::io::belt_file::{Geometry, require_engaged};
use crate::io::file::BadInput;
use crate::io::gear_file::GearFile;

/// The example of a wrist, as a file.
pub const WRIST: &str = include_str!("../../../../gears/belt/wrist.toml");

/// `[belt]`
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrivingBelt {
    /// p (m).
    #[serde(rename = "pitch_m")]
    pub pitch: f64,
    /// z_b.
    pub teeth: u32,
    /// EA, force over strain (N).
    #[serde(rename = "stiffness_n")]
    pub stiffness: f64,
    /// rho (kg/m).
    #[serde(rename = "mass_kg_per_m")]
    pub mass: f64,
    /// F0, tension of each span at rest (N).
    #[serde(rename = "pretension_n")]
    pub pretension: f64,
    /// z_1.
    pub motor_pulley_teeth: u32,
    /// z_2.
    pub wave_generator_pulley_teeth: u32,
    /// Rotor with its pulley (kg m^2).
    #[serde(rename = "rotor_inertia_kg_m2")]
    pub rotor_inertia: f64,
    /// Damping ratio of the wave generator's inertia on both spans, the motor held.
    pub mode_damping_ratio: f64,
}

impl DrivingBelt {
    /// Teeth of both pulleys, the motor's first.
    pub fn pulley_teeth(&self) -> [u32; 2] {
        [self.motor_pulley_teeth, self.wave_generator_pulley_teeth]
    }

    /// z_1/z_2: angle of the wave generator over the motor's.
    pub fn ratio(&self) -> f64 {
        f64::from(self.motor_pulley_teeth) / f64::from(self.wave_generator_pulley_teeth)
    }

    /// Where the belt lies; `None` when it is too short.
    pub fn geometry(&self) -> Option<Geometry> {
        Geometry::new(self.pitch, self.pulley_teeth(), self.teeth)
    }

    /// The belt goes around both pulleys with a tooth of either in mesh, and the ratio is one that the compensator has.
    ///
    /// # Errors
    /// One line that names the key, its value and what is allowed.
    pub(super) fn check(&self) -> Result<(), String> {
        let names = ["belt.motor_pulley_teeth", "belt.wave_generator_pulley_teeth"];
        require_engaged(self.pitch, self.teeth, self.pulley_teeth(), names)?;
        if (0.125..=4.0).contains(&self.ratio()) {
            return Ok(());
        }
        let [motor, driven] = self.pulley_teeth();
        Err(format!(
            "{} = {motor} is out of range beside {} = {driven}; allowed: 1/8 to 4 times as many",
            names[0], names[1]
        ))
    }
}

impl GearFile {
    /// The example of a wrist.
    pub fn wrist() -> Self {
        Self::parse(Path::new("wrist.toml"), WRIST.as_bytes()).expect("the example is tested")
    }

    /// The same where nothing is known of belts.
    ///
    /// # Errors
    /// One line that names the file and its section.
    pub fn without_belt(self, path: &Path) -> Result<Self, BadInput> {
        if self.belt.is_none() {
            return Ok(self);
        }
        Err(BadInput::new(
            path,
            "section [belt] is not known here: a motor in front of a tooth belt is for check, pil, robot, export and flash; \
             allowed: a gear file without [belt]",
        ))
    }
}
