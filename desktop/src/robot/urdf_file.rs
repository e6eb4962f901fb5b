//! The robot file whose links come from a URDF file ([`super::urdf`]).
//!
//! `robot.urdf` names that file, relative to the robot's; each `[[joint]]` gives the gear file of the joint of that name. Gravity is in the
//! frame of the root link; where no component is given it is that of the earth along its -z. What a URDF joint does not allow at the start is
//! refused by file, key and limit.

use std::path::Path;

use serde::Deserialize;

use super::joint::{ANGLE, GRAVITY, Joint, usable};
use super::urdf::{UrdfArm, UrdfJoint};
use crate::io::file::{BadInput, folder_of};
use crate::io::gear_file::GearFile;
use crate::io::keyed_file::KeyedFile;
use crate::io::keyed_file::key::{Allowed, Key, MOST_ENTRIES, Schema, key, optional};
use crate::plant::payload::GRAVITY as STANDARD_GRAVITY;

/// The robot of scenario S7, its links from a URDF file.
const EXAMPLE: &str = include_str!("../../../examples/arm/arm-urdf.toml");

/// The keys in the order of the file.
const KEYS: &[Key] = &[
    key("robot.urdf", Allowed::Text),
    optional("robot.tip", Allowed::Text),
    optional("robot.gravity_x_m_per_s2", GRAVITY),
    optional("robot.gravity_y_m_per_s2", GRAVITY),
    optional("robot.gravity_z_m_per_s2", GRAVITY),
    key("joint[].name", Allowed::Text),
    key("joint[].gear", Allowed::Text),
    optional("joint[].start_rad", ANGLE),
];

/// The file as it stands there.
#[derive(Deserialize)]
pub(super) struct UrdfText {
    robot: RobotText,
    #[serde(default)]
    joint: Vec<JointText>,
}

#[derive(Deserialize)]
struct RobotText {
    urdf: String,
    tip: Option<String>,
    gravity_x_m_per_s2: Option<f64>,
    gravity_y_m_per_s2: Option<f64>,
    gravity_z_m_per_s2: Option<f64>,
}

#[derive(Deserialize)]
struct JointText {
    name: String,
    gear: String,
    #[serde(default)]
    start_rad: f64,
}

impl KeyedFile for UrdfText {
    const SCHEMA: Schema = Schema::of(KEYS);
    const DEFAULT: &'static str = EXAMPLE;

    /// Names are there once.
    fn conditions(&self, damaged: &[&str]) -> Vec<String> {
        if damaged.contains(&"joint") {
            return Vec::new();
        }
        let twice =
            |index: usize| self.joint[..index].iter().any(|other| other.name == self.joint[index].name);
        let named =
            |index: usize| format!("joint[{index}].name = {:?} stands there twice", self.joint[index].name);
        (0..self.joint.len()).filter(|index| twice(*index)).map(named).collect()
    }
}

impl RobotText {
    fn gravity(&self) -> [f64; 3] {
        match [self.gravity_x_m_per_s2, self.gravity_y_m_per_s2, self.gravity_z_m_per_s2] {
            [None, None, None] => [0.0, 0.0, -STANDARD_GRAVITY],
            given => given.map(Option::unwrap_or_default),
        }
    }
}

impl UrdfText {
    /// Name of the robot, gravity in the frame of its first joint (m/s^2) and its joints, their gear files by `gear`; the URDF file is relative to
    /// `path`.
    ///
    /// # Errors
    /// One line that names the file and what is wrong in it.
    pub(super) fn robot(
        &self,
        path: &Path,
        gear: impl Fn(&str) -> Result<GearFile, BadInput>,
    ) -> Result<(String, [f64; 3], Vec<Joint>), BadInput> {
        let urdf = folder_of(path).join(&self.robot.urdf);
        let arm = UrdfArm::read(&urdf, self.robot.tip.as_deref())?;
        self.require_known(&arm).map_err(|why| BadInput::new(path, why))?;
        if arm.joints.len() > MOST_ENTRIES {
            let count = arm.joints.len();
            return Err(BadInput::new(
                &urdf,
                format_args!("{count} joints; allowed: at most {MOST_ENTRIES}"),
            ));
        }
        let joints =
            arm.joints.iter().map(|joint| self.joint(path, joint, &gear)).collect::<Result<_, _>>()?;
        let given = self.robot.gravity();
        let along = |axis: [f64; 3]| axis.iter().zip(given).map(|(axis, given)| axis * given).sum();
        Ok((arm.name.clone(), arm.base.map(along), joints))
    }

    /// Every joint that the robot file names is one of the arm.
    fn require_known(&self, arm: &UrdfArm) -> Result<(), String> {
        let known: Vec<_> = arm.joints.iter().map(|joint| joint.name.as_str()).collect();
        match self.joint.iter().position(|joint| !known.contains(&joint.name.as_str())) {
            None => Ok(()),
            Some(index) => Err(format!(
                "joint[{index}].name = {:?} is no joint that moves in {}; allowed: {}",
                self.joint[index].name,
                self.robot.urdf,
                known.join(", ")
            )),
        }
    }

    fn joint(
        &self,
        path: &Path,
        found: &UrdfJoint,
        gear: impl Fn(&str) -> Result<GearFile, BadInput>,
    ) -> Result<Joint, BadInput> {
        let refuse = |why: String| BadInput::new(path, why);
        let (name, urdf) = (&found.name, &self.robot.urdf);
        let index = self.joint.iter().position(|joint| joint.name == *name);
        let index = index
            .ok_or_else(|| refuse(format!("no [[joint]] has the name {name:?} of a joint of {urdf}")))?;
        let JointText { gear: file, start_rad, .. } = &self.joint[index];
        let [least, largest] = found.limits.angle;
        if !(least..=largest).contains(start_rad) {
            return Err(refuse(format!(
                "joint[{index}].start_rad = {start_rad} is out of range; allowed: {least} to {largest} rad, the limits of {name} \
                 in {urdf}"
            )));
        }
        let gear = usable(path, index, file, gear)?;
        Ok(Joint { gear, start: *start_rad, link: found.link, beam: None, limits: found.limits })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::gear_file::DEFAULT;
    use crate::robot::RobotFile;

    fn folder() -> std::path::PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/arm")
    }

    fn parsed(text: &str) -> Result<RobotFile, String> {
        let gear = |path: &str| GearFile::parse(Path::new(path), DEFAULT.as_bytes());
        let path = folder().join("arm-urdf.toml");
        RobotFile::parse(&path, text.as_bytes(), gear).map_err(|error| error.to_string())
    }

    /// The URDF file of the example is the robot of `arm.toml`.
    #[test]
    fn the_example_is_the_arm_of_s7() {
        let [urdf, expected] =
            [RobotFile::read(&folder().join("arm-urdf.toml")).unwrap(), RobotFile::example()];
        let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-14);
        assert!(near(&urdf.gravity, &expected.gravity), "{:?}", urdf.gravity);
        for (found, expected) in urdf.joints.iter().zip(&expected.joints) {
            assert_eq!((found.start, &found.gear), (expected.start, &expected.gear));
            let (found, expected) = (&found.link, &expected.link);
            assert!((found.mass - expected.mass).abs() < 1e-14);
            for (a, b) in [
                (found.end.place, expected.end.place),
                (found.centre, expected.centre),
                (found.inertia, expected.inertia),
                (found.products, expected.products),
            ] {
                assert!(near(&a, &b), "{found:?} {expected:?}");
            }
            assert!(near(found.end.axes.as_flattened(), expected.end.axes.as_flattened()), "{found:?}");
        }
    }

    #[test]
    fn what_does_not_fit_the_urdf_file_is_named() {
        for (from, to, line) in [
            (
                "name = \"elbow\"",
                "name = \"wrist\"",
                "joint[1].name = \"wrist\" is no joint that moves in arm.urdf; allowed: shoulder, elbow",
            ),
            ("name = \"elbow\"", "name = \"shoulder\"", "joint[1].name = \"shoulder\" stands there twice"),
            (
                "start_rad = 1.10",
                "start_rad = -1.10",
                "joint[1].start_rad = -1.1 is out of range; allowed: 0 to 2.8 rad, the limits of elbow in arm.urdf",
            ),
            (
                "start_rad = 1.10",
                "length_m = 1.10",
                "unknown key joint[1].length_m = 1.1; the nearest known key is ",
            ),
            ("\"arm.urdf\"", "\"none.urdf\"", "cannot be read"),
        ] {
            assert!(EXAMPLE.contains(from));
            let found = parsed(&EXAMPLE.replacen(from, to, 1)).unwrap_err();
            assert!(found.contains(line), "{found}");
        }
        let (bare, _) = EXAMPLE.rsplit_once("[[joint]]").unwrap();
        assert!(
            parsed(bare).unwrap_err().ends_with("no [[joint]] has the name \"elbow\" of a joint of arm.urdf")
        );
    }

    #[test]
    fn gravity_that_is_not_given_is_the_earths() {
        let without = EXAMPLE.replacen("gravity_z_m_per_s2 = -9.80665", "", 1);
        let [x, y, z] = parsed(&without).unwrap().gravity;
        assert!(x == 0.0 && (y + STANDARD_GRAVITY).abs() < 1e-14 && z.abs() < 1e-14, "{x} {y} {z}");
        let along = EXAMPLE.replacen("gravity_z_m_per_s2 = -9.80665", "gravity_x_m_per_s2 = 1.0", 1);
        assert_eq!(parsed(&along).unwrap().gravity, [1.0, 0.0, 0.0]);
    }
}
