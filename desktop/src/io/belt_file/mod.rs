//! The belt file: one TOML file that describes a tooth-belt gear.
//!
//! Keys carry their unit; the fields here are the same numbers in the same SI units, without the suffix. [`KEYS`] lists every key with
//! what it may hold: it is read as a gear file is ([`crate::io::gear_file`]), with the same refusals, and its
//! `[friction]` has the same keys ([`crate::io::gear_file::friction`]), angles and ripple being those of the motor's pulley.
//!
//! Beyond the ranges of keys: the belt goes around both pulleys, and at least one tooth of either is in mesh.

mod geometry;
mod keys;

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::io::file::{self, BadInput};
use crate::io::gear_file::friction::Friction;
use crate::io::gear_file::physics::friction;
use crate::io::keyed_file::key::Schema;
use crate::io::keyed_file::{self, KeyedFile, LONGEST_FILE};
pub use geometry::Geometry;
pub use keys::KEYS;

/// The example `at5-16`, as a file.
pub const EXAMPLE: &str = include_str!("../../../../gears/belt/at5-16.toml");

/// A belt file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BeltFile {
    /// The belt.
    pub belt: Belt,
    /// Pulley of the motor.
    pub motor_pulley: Pulley,
    /// Pulley of the output.
    pub output_pulley: Pulley,
    /// Damping of the belt.
    pub damping: Damping,
    /// Tooth pitch error.
    #[serde(default, skip_serializing_if = "PitchError::is_empty")]
    pub pitch_error: PitchError,
    /// Friction of both pulleys.
    pub friction: PulleyFrictions,
}

/// `[belt]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Belt {
    /// Name of the gear.
    pub name: String,
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
}

/// `[motor_pulley]` and `[output_pulley]`
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pulley {
    /// z.
    pub teeth: u32,
    /// With all that turns with it, but the belt (kg m^2).
    #[serde(rename = "inertia_kg_m2")]
    pub inertia: f64,
}

/// `[damping]`
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Damping {
    /// Modal damping ratio of the output's inertia on both spans, the motor held.
    pub output_mode_ratio: f64,
}

/// `[pitch_error]`: e = sum of A_k sin(k x + p_k).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PitchError {
    /// x is the angle of the motor's pulley.
    pub motor: Vec<PitchHarmonic>,
    /// x is the angle of the output's pulley.
    pub output: Vec<PitchHarmonic>,
    /// x is the angle of the belt, a revolution of it 2*pi.
    pub belt: Vec<PitchHarmonic>,
}

impl PitchError {
    fn is_empty(&self) -> bool {
        self.motor.is_empty() && self.output.is_empty() && self.belt.is_empty()
    }
}

/// One term of the pitch error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PitchHarmonic {
    /// k, periods a revolution.
    pub order: u32,
    /// A_k (m).
    #[serde(rename = "amplitude_m")]
    pub amplitude: f64,
    /// p_k (rad).
    #[serde(rename = "phase_rad")]
    pub phase: f64,
}

/// `[friction.motor]` and `[friction.output]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PulleyFrictions {
    /// At the motor's pulley.
    pub motor: Friction,
    /// At the output's pulley.
    pub output: Friction,
}

impl KeyedFile for BeltFile {
    const SCHEMA: Schema = keys::SCHEMA;
    const DEFAULT: &'static str = EXAMPLE;

    fn conditions(&self, damaged: &[&str]) -> Vec<String> {
        let sound = |sections: &[&str]| !sections.iter().any(|section| damaged.contains(section));
        let mut faults = Vec::new();
        if sound(&["belt", "motor_pulley", "output_pulley"]) {
            faults.extend(self.require_engaged().err());
        }
        let sides = [
            ("motor", &self.friction.motor, "motor_pulley", self.motor_pulley),
            ("output", &self.friction.output, "output_pulley", self.output_pulley),
        ];
        for (side, model, section, pulley) in sides {
            if sound(&["friction", section]) {
                faults.extend(friction::check(&format!("friction.{side}"), model, pulley.inertia).err());
            }
        }
        faults
    }
}

impl BeltFile {
    /// Reads and checks `path`.
    ///
    /// # Errors
    /// One line that names the file, the key, its value and what is allowed.
    pub fn read(path: &Path) -> Result<Self, BadInput> {
        Self::parse(path, &file::read(path, LONGEST_FILE)?)
    }

    /// The belt file in `bytes`; `path` is only named in errors.
    ///
    /// # Errors
    /// As [`BeltFile::read`].
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Self, BadInput> {
        keyed_file::parse(path, bytes)
    }

    /// Reads and checks `path`, and tells everything that is wrong with it.
    ///
    /// # Errors
    /// An error for each fault, as [`BeltFile::read`] has it for the first.
    pub fn faultless(path: &Path) -> Result<Self, Vec<BadInput>> {
        keyed_file::faultless(path)
    }

    /// The example `at5-16`.
    pub fn example() -> Self {
        Self::parse(Path::new("at5-16.toml"), EXAMPLE.as_bytes()).expect("the example is tested")
    }

    /// The same as text that [`BeltFile::parse`] reads back.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).expect("every field has a TOML form")
    }

    /// Teeth of both pulleys, the motor's first.
    fn pulley_teeth(&self) -> [u32; 2] {
        [self.motor_pulley.teeth, self.output_pulley.teeth]
    }

    /// Where the belt lies; `None` when it is too short.
    pub fn geometry(&self) -> Option<Geometry> {
        Geometry::new(self.belt.pitch, self.pulley_teeth(), self.belt.teeth)
    }

    /// The belt goes around both pulleys, and a tooth of either is in mesh.
    fn require_engaged(&self) -> Result<(), String> {
        let names = ["motor_pulley.teeth", "output_pulley.teeth"];
        require_engaged(self.belt.pitch, self.belt.teeth, self.pulley_teeth(), names)
    }
}

/// A belt of this pitch (m) and so many teeth goes around both pulleys, and a tooth of either is in mesh; `names` are those of
/// the pulleys' teeth.
pub(super) fn require_engaged(
    pitch: f64,
    belt_teeth: u32,
    teeth: [u32; 2],
    names: [&str; 2],
) -> Result<(), String> {
    let Some(geometry) = Geometry::new(pitch, teeth, belt_teeth) else {
        return Err(format!(
            "belt.teeth = {belt_teeth} is out of range; allowed: at least {}, to go around pulleys of {} and {} teeth",
            Geometry::fewest_teeth(pitch, teeth),
            teeth[0],
            teeth[1]
        ));
    };
    for (index, name) in names.into_iter().enumerate() {
        let engaged = geometry.teeth_in_mesh(teeth[index], index);
        if engaged < 1.0 {
            return Err(format!(
                "{name} = {} is out of range: no tooth engaged, the belt lies on {engaged:.2} teeth; allowed: at least 1 \
                 tooth in mesh",
                teeth[index]
            ));
        }
    }
    Ok(())
}
