//! The robot file: one TOML file that describes an arm, joint by joint from the base to the tip.
//!
//! `[robot]` has its name and gravity in the frame of the base, each `[[joint]]` the gear file of the joint, relative to the robot's
//! file, and the link behind it ([`super::chain`]). [`KEYS`] lists every key with what it may hold. As with a gear file an unknown or missing
//! key, a wrong type and a value out of range are refused by one line that names file, key, value and what is allowed.
//!
//! A joint with the key `beam` has a link that bends, from a link file ([`super::flexible`]), in the place of a rigid one.
//!
//! A file with the key `robot.urdf` has its links from a URDF file (`super::urdf_file`).

use std::path::Path;

use serde::Deserialize;

use super::beam::Beam;
use super::chain::{Link, Pose, is_inertia};
use super::joint::{ANGLE, GRAVITY, LARGEST, usable};
pub use super::joint::{Joint, Limits};
use super::urdf_file::UrdfText;
use crate::io::file::{self, BadInput, folder_of};
use crate::io::gear_file::{DEFAULT, GearFile};
use crate::io::keyed_file::key::{Allowed, Key, MOST_ENTRIES, Schema, key, optional, positive, within};
use crate::io::keyed_file::{self, KeyedFile, LONGEST_FILE};
use crate::io::link_file::LinkFile;

/// The robot of scenario S7, as a file.
pub const EXAMPLE: &str = include_str!("../../../examples/arm/arm.toml");
/// The gear of its elbow, as a file.
const ELBOW: &str = include_str!("../../../examples/arm/elbow.toml");

/// Largest mass (kg) and inertia (kg m^2).
const HEAVIEST: f64 = 1e5;

const PLACE: Allowed = within(-LARGEST, LARGEST, "m");
const INERTIA: Allowed = positive(HEAVIEST, "kg m^2");
const LENGTH: Allowed = within(0.0, LARGEST, "m");
const MASS: Allowed = positive(HEAVIEST, "kg");

/// The keys in the order of the file.
pub const KEYS: &[Key] = &[
    key("robot.name", Allowed::Text),
    optional("robot.gravity_x_m_per_s2", GRAVITY),
    optional("robot.gravity_y_m_per_s2", GRAVITY),
    optional("robot.gravity_z_m_per_s2", GRAVITY),
    key("joint[].gear", Allowed::Text),
    optional("joint[].start_rad", ANGLE),
    optional("joint[].beam", Allowed::Text),
    optional("joint[].length_m", LENGTH),
    optional("joint[].offset_m", PLACE),
    optional("joint[].twist_rad", ANGLE),
    optional("joint[].mass_kg", MASS),
    optional("joint[].centre_m", PLACE),
    optional("joint[].centre_y_m", PLACE),
    optional("joint[].centre_z_m", PLACE),
    optional("joint[].inertia_kg_m2", INERTIA),
    optional("joint[].inertia_x_kg_m2", INERTIA),
    optional("joint[].inertia_y_kg_m2", INERTIA),
];

/// A robot, its gear files read.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotFile {
    /// Name of the robot.
    pub name: String,
    /// Gravity in the frame of the base (m/s^2).
    pub gravity: [f64; 3],
    /// The joints, from the base on.
    pub joints: Vec<Joint>,
    /// Payloads beyond the rating that a beam's file states, a line each.
    pub warnings: Vec<String>,
}

/// The file as it stands there.
#[derive(Deserialize)]
struct Text {
    robot: RobotText,
    #[serde(default)]
    joint: Vec<JointText>,
}

#[derive(Deserialize)]
struct RobotText {
    name: String,
    #[serde(default)]
    gravity_x_m_per_s2: f64,
    #[serde(default)]
    gravity_y_m_per_s2: f64,
    #[serde(default)]
    gravity_z_m_per_s2: f64,
}

#[derive(Deserialize)]
struct JointText {
    gear: String,
    beam: Option<String>,
    #[serde(default)]
    start_rad: f64,
    #[serde(default)]
    twist_rad: f64,
    length_m: Option<f64>,
    offset_m: Option<f64>,
    mass_kg: Option<f64>,
    centre_m: Option<f64>,
    centre_y_m: Option<f64>,
    centre_z_m: Option<f64>,
    inertia_kg_m2: Option<f64>,
    inertia_x_kg_m2: Option<f64>,
    inertia_y_kg_m2: Option<f64>,
}

impl KeyedFile for Text {
    const SCHEMA: Schema = Schema::of(KEYS);
    const DEFAULT: &'static str = EXAMPLE;

    /// There is a joint, and each has either a beam or all of a rigid link, whose moments of inertia are those of a body.
    fn conditions(&self, damaged: &[&str]) -> Vec<String> {
        if damaged.contains(&"joint") {
            return Vec::new();
        }
        if self.joint.is_empty() {
            return vec![format!("missing key joint; allowed: a list of 1 to {MOST_ENTRIES} tables")];
        }
        self.joint.iter().enumerate().flat_map(|(index, joint)| joint.faults(index)).collect()
    }
}

impl JointText {
    /// What a rigid link needs.
    fn needed(&self) -> [(&'static str, Option<f64>, Allowed); 4] {
        [
            ("length_m", self.length_m, LENGTH),
            ("mass_kg", self.mass_kg, MASS),
            ("centre_m", self.centre_m, PLACE),
            ("inertia_kg_m2", self.inertia_kg_m2, INERTIA),
        ]
    }

    /// What it may have.
    fn possible(&self) -> [(&'static str, Option<f64>); 5] {
        [
            ("offset_m", self.offset_m),
            ("centre_y_m", self.centre_y_m),
            ("centre_z_m", self.centre_z_m),
            ("inertia_x_kg_m2", self.inertia_x_kg_m2),
            ("inertia_y_kg_m2", self.inertia_y_kg_m2),
        ]
    }

    fn faults(&self, index: usize) -> Vec<String> {
        if self.beam.is_some() {
            let given =
                self.needed().map(|(name, value, _)| (name, value)).into_iter().chain(self.possible());
            let beside =
                |name| format!("joint[{index}].{name} beside joint[{index}].beam; allowed: one of them");
            return given.filter(|(_, value)| value.is_some()).map(|(name, _)| beside(name)).collect();
        }
        let missing = self.needed().into_iter().filter(|(_, value, _)| value.is_none());
        let faults: Vec<_> = missing
            .map(|(name, _, allowed)| format!("missing key joint[{index}].{name}; allowed: {allowed}"))
            .collect();
        if faults.is_empty() {
            require_inertia(index, &self.link()).err().into_iter().collect()
        } else {
            faults
        }
    }

    /// The rigid link of a checked file.
    fn link(&self) -> Link {
        let [length, mass, centre, about_z] = self.needed().map(|(_, value, _)| value.unwrap_or_default());
        let [offset, centre_y, centre_z] =
            [self.offset_m, self.centre_y_m, self.centre_z_m].map(Option::unwrap_or_default);
        let [about_x, about_y] =
            [self.inertia_x_kg_m2, self.inertia_y_kg_m2].map(|moment| moment.unwrap_or(about_z));
        Link {
            end: Pose::denavit_hartenberg([length, offset], self.twist_rad),
            mass,
            centre: [centre, centre_y, centre_z],
            inertia: [about_x, about_y, about_z],
            products: [0.0; 3],
            flange: 0.0,
        }
    }

    /// The file of the beam, where there is one.
    fn beam(&self, folder: &Path) -> Result<Option<LinkFile>, BadInput> {
        self.beam.as_ref().map(|beam| LinkFile::read(&folder.join(beam))).transpose()
    }
}

impl RobotFile {
    /// Reads and checks `path` and the gear files that it names.
    ///
    /// # Errors
    /// One line that names the file, the key, its value and what is allowed.
    pub fn read(path: &Path) -> Result<Self, BadInput> {
        let folder = folder_of(path);
        Self::parse(path, &file::read(path, LONGEST_FILE)?, |gear| {
            GearFile::read_with_belt(&folder.join(gear))
        })
    }

    /// Reads and checks `path`, and tells everything that is wrong with it; of the gear files the first thing.
    ///
    /// # Errors
    /// An error for each fault, as [`RobotFile::read`] has it for the first.
    pub fn faultless(path: &Path) -> Result<Self, Vec<BadInput>> {
        let folder = folder_of(path);
        let gear = |gear: &str| GearFile::read_with_belt(&folder.join(gear));
        let bytes = file::read(path, LONGEST_FILE).map_err(|error| vec![error])?;
        let robot = if names_urdf(&bytes) {
            Self::of_urdf(path, &keyed_file::faultless(path)?, gear)
        } else {
            Self::of(path, keyed_file::faultless(path)?, gear)
        };
        robot.map_err(|error| vec![error])
    }

    /// The robot file in `bytes`, its gear files by `gear`; `path` is named in errors, and a URDF file is relative to it.
    ///
    /// # Errors
    /// As [`RobotFile::read`].
    pub fn parse(
        path: &Path,
        bytes: &[u8],
        gear: impl Fn(&str) -> Result<GearFile, BadInput>,
    ) -> Result<Self, BadInput> {
        if names_urdf(bytes) {
            return Self::of_urdf(path, &keyed_file::parse(path, bytes)?, gear);
        }
        Self::of(path, keyed_file::parse(path, bytes)?, gear)
    }

    fn of_urdf(
        path: &Path,
        text: &UrdfText,
        gear: impl Fn(&str) -> Result<GearFile, BadInput>,
    ) -> Result<Self, BadInput> {
        let (name, gravity, joints) = text.robot(path, gear)?;
        Ok(Self { name, gravity, joints, warnings: Vec::new() })
    }

    fn of(
        path: &Path,
        text: Text,
        gear: impl Fn(&str) -> Result<GearFile, BadInput>,
    ) -> Result<Self, BadInput> {
        let (mut joints, mut warnings) = (Vec::new(), Vec::new());
        for (index, joint) in text.joint.iter().enumerate() {
            let gear = usable(path, index, &joint.gear, &gear)?;
            let file = joint.beam(folder_of(path))?;
            warnings.extend(
                file.as_ref().and_then(LinkFile::warning).map(|why| format!("joint[{index}].beam: {why}")),
            );
            let beam = file.map(|file| Beam::of(&file, joint.twist_rad));
            let link = beam.map_or_else(|| joint.link(), |beam| beam.straight());
            joints.push(Joint { gear, start: joint.start_rad, link, beam, limits: Limits::NONE });
        }
        let RobotText { name, gravity_x_m_per_s2, gravity_y_m_per_s2, gravity_z_m_per_s2 } = text.robot;
        let gravity = [gravity_x_m_per_s2, gravity_y_m_per_s2, gravity_z_m_per_s2];
        Ok(Self { name, gravity, joints, warnings })
    }

    /// The robot of scenario S7, `examples/arm/arm.toml`.
    pub fn example() -> Self {
        let gear = |path: &str| {
            let text = if path.ends_with("hd25-100.toml") { DEFAULT } else { ELBOW };
            GearFile::parse(Path::new(path), text.as_bytes())
        };
        Self::parse(Path::new("arm.toml"), EXAMPLE.as_bytes(), gear).expect("the example is tested")
    }
}

/// The robot file in `bytes` has its links from a URDF file.
fn names_urdf(bytes: &[u8]) -> bool {
    let table = std::str::from_utf8(bytes).ok().and_then(|text| text.parse::<toml::Table>().ok());
    table.is_some_and(|table| table.get("robot").is_some_and(|robot| robot.get("urdf").is_some()))
}

/// Refuses moments of inertia that no body has.
fn require_inertia(index: usize, link: &Link) -> Result<(), String> {
    let [x, y, z] = link.inertia;
    if is_inertia(link.inertia) {
        return Ok(());
    }
    Err(format!(
        "joint[{index}].inertia_kg_m2 = {z} with inertia_x_kg_m2 = {x} and inertia_y_kg_m2 = {y} is out of range; allowed: none \
         larger than the sum of the others"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<RobotFile, String> {
        let gear = |_: &str| Ok(GearFile::default_gear());
        RobotFile::parse(Path::new("arm.toml"), text.as_bytes(), gear).map_err(|error| error.to_string())
    }

    #[test]
    fn the_example_is_an_arm_under_gravity() {
        let robot = RobotFile::example();
        assert_eq!((robot.joints.len(), robot.gravity), (2, [0.0, -9.80665, 0.0]));
        assert_eq!(robot.joints[0].gear, GearFile::default_gear());
        assert!(robot.joints[1].gear.gear.rated_torque < 40.0);
        assert_eq!((robot.joints[1].link.end.place[0], robot.joints[1].start), (0.35, 1.1));
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (from, to, line) in [
            (
                "mass_kg = 4.0",
                "mass = 4.0",
                "arm.toml: unknown key joint[0].mass = 4.0; the nearest known key is joint[].mass_kg (a number above 0 to 1e5 kg)",
            ),
            (
                "mass_kg = 4.0",
                "mass_kg = -4.0",
                "arm.toml: joint[0].mass_kg = -4.0 is out of range; allowed: a number above 0 to 1e5 kg",
            ),
            (
                "length_m = 0.40",
                "length_m = \"long\"",
                "arm.toml: joint[0].length_m = \"long\" is text; allowed: a number from 0 to 100 m",
            ),
            (
                "name = \"two-joint arm\"",
                "",
                "arm.toml: missing key robot.name; allowed: text of 1 to 80 characters",
            ),
            (
                "inertia_x_kg_m2 = 0.006",
                "inertia_x_kg_m2 = 0.6",
                "arm.toml: joint[0].inertia_kg_m2 = 0.06 with inertia_x_kg_m2 = 0.6 and inertia_y_kg_m2 = 0.06 is out of range; allowed: none larger than the sum of the others",
            ),
            (
                "mass_kg = 4.0",
                "",
                "arm.toml: missing key joint[0].mass_kg; allowed: a number above 0 to 1e5 kg",
            ),
            (
                "mass_kg = 4.0",
                "beam = \"forearm.toml\"\nmass_kg = 4.0",
                "arm.toml: joint[0].length_m beside joint[0].beam; allowed: one of them; and 5 more",
            ),
            ("[robot]", "[robot", "arm.toml: line 4: not TOML: unclosed table, expected `]`; and "),
        ] {
            assert!(EXAMPLE.contains(from));
            let found = parsed(&EXAMPLE.replacen(from, to, 1)).unwrap_err();
            assert!(found.starts_with(line), "{found}");
        }
        let bare = parsed("[robot]\nname = \"a\"\n").unwrap_err();
        assert_eq!(bare, "arm.toml: missing key joint; allowed: a list of 1 to 8 tables");
    }

    /// Of a gear file the reader names itself; a gear that cannot be built for is named by the robot's.
    #[test]
    fn a_gear_that_cannot_be_used_is_named() {
        let gear = |_: &str| {
            let mut gear = GearFile::default_gear();
            gear.friction.input.model = strainwave::friction::ModelName::LuGre;
            Ok(gear)
        };
        let line = RobotFile::parse(Path::new("arm.toml"), EXAMPLE.as_bytes(), gear).unwrap_err().to_string();
        assert!(
            line.starts_with("arm.toml: joint[0].gear = \"../../gears/hd25-100.toml\": friction.input.model"),
            "{line}"
        );
    }
}
