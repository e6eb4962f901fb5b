//! Links from a URDF file: one chain of revolute joints from the root link on.
//!
//! ```text
//! A_i = Rot_z(q_i)*E_i                          E_i: the next joint, or the tip, in the frame of joint i
//! frame of joint i = (frame of the URDF joint at q_i = 0)*R_i       R_i: the least turn of z into the joint's axis
//! m = sum m_k,   m*c = sum m_k*c_k,   I = sum (I_k + m_k*(|c_k - c|^2 - (c_k - c)*(c_k - c)^T))
//! ```
//!
//! Bodies that fixed joints hold together are one link; what is fixed to the root stands still. Angles, their zero and their sign are those of the
//! URDF file. The tip is the one frame at the end of the chain. Of a joint's limits an `effort` or `velocity` of 0 is none: many files have
//! it so. Visual and collision shapes, materials, friction, damping and transmissions are not used: the gear file has the joint's friction.
//!
//! Refused by file, joint and type: joints that are not revolute, continuous or fixed, those that mimic another one, and a chain that branches.
//! Units as in the URDF: m, rad, kg, kg m^2. The XML is read by the crate urdf-rs.
//!
//! Reference: <https://wiki.ros.org/urdf/XML>.

use std::path::Path;

use nalgebra::{Isometry3, Matrix3, Point3, UnitQuaternion, Vector3};
use urdf_rs::JointType;

use super::chain::{Link, Pose, is_inertia};
use super::joint::Limits;
use crate::io::file::{self, BadInput};

/// Longest URDF file (bytes).
const LONGEST: u64 = 1 << 24;

/// An arm of a URDF file.
#[derive(Clone, Debug, PartialEq)]
pub struct UrdfArm {
    /// Name of the robot.
    pub name: String,
    /// Unit vectors of the first joint's frame in that of the root link, a row each.
    pub base: [[f64; 3]; 3],
    /// The joints that move, from the root on.
    pub joints: Vec<UrdfJoint>,
}

/// A joint of a URDF file.
#[derive(Clone, Debug, PartialEq)]
pub struct UrdfJoint {
    /// Its name.
    pub name: String,
    /// The link behind it.
    pub link: Link,
    /// What it may do.
    pub limits: Limits,
}

/// Bodies that fixed joints hold together, in the frame of the joint before them.
#[derive(Default)]
struct Body<'a> {
    parts: Vec<(Isometry3<f64>, &'a urdf_rs::Inertial)>,
    /// Joints that move, behind it.
    moving: Vec<(Isometry3<f64>, &'a urdf_rs::Joint)>,
    /// Links that nothing is attached to.
    ends: Vec<(Isometry3<f64>, &'a str)>,
}

impl UrdfArm {
    /// Reads and checks `path`; the tip is the link of that name, which is only needed where the chain ends in several.
    ///
    /// # Errors
    /// One line that names the file, the joint or link, and what is allowed.
    pub fn read(path: &Path, tip: Option<&str>) -> Result<Self, BadInput> {
        let bytes = file::read(path, LONGEST)?;
        let text = std::str::from_utf8(&bytes).map_err(|_| BadInput::new(path, "not UTF-8 text"))?;
        Self::parse(text, tip).map_err(|why| BadInput::new(path, why))
    }

    /// The arm in the text of a URDF file.
    ///
    /// # Errors
    /// As [`UrdfArm::read`], without the file.
    pub fn parse(text: &str, tip: Option<&str>) -> Result<Self, String> {
        let robot = urdf_rs::read_from_string(text).map_err(|error| format!("not a URDF file: {error}"))?;
        robot.joints.iter().try_for_each(supported)?;
        let mut body = collect(&robot, root(&robot)?, Isometry3::identity())?;
        let Some((first, _)) = next(&body)? else {
            return Err(
                "no joint that moves; allowed: revolute or continuous ones, one after the other".into()
            );
        };
        let base = axes(&first);
        let mut joints = Vec::new();
        while let Some((_, joint)) = next(&body)? {
            let turn = turn_to(axis(joint)?).inverse();
            let child = Isometry3::from_parts(Vector3::zeros().into(), turn);
            let behind = collect(&robot, &joint.child.link, child)?;
            let end = match next(&behind)? {
                Some((pose, _)) => pose,
                None => the_tip(&behind, tip)?,
            };
            let link = link(&behind, joint, &end)?;
            joints.push(UrdfJoint { name: joint.name.clone(), link, limits: limits(joint)? });
            body = behind;
        }
        require_connected(&robot, &joints)?;
        Ok(Self { name: robot.name.clone(), base, joints })
    }
}

/// Name and type of a joint, as its file has them.
fn named(joint: &urdf_rs::Joint) -> String {
    format!("joint {} ({})", joint.name, format!("{:?}", joint.joint_type).to_lowercase())
}

fn moves(joint: &urdf_rs::Joint) -> bool {
    matches!(joint.joint_type, JointType::Revolute | JointType::Continuous)
}

fn supported(joint: &urdf_rs::Joint) -> Result<(), String> {
    if !moves(joint) && joint.joint_type != JointType::Fixed {
        return Err(format!("{} is not supported; allowed: revolute, continuous and fixed", named(joint)));
    }
    match &joint.mimic {
        Some(mimic) => {
            Err(format!("{} mimics {}; allowed: joints with a motor of their own", named(joint), mimic.joint))
        }
        None => Ok(()),
    }
}

/// The one link that no joint leads to.
fn root(robot: &urdf_rs::Robot) -> Result<&str, String> {
    let is_child = |name: &str| robot.joints.iter().any(|joint| joint.child.link == name);
    let roots: Vec<_> =
        robot.links.iter().map(|link| link.name.as_str()).filter(|name| !is_child(name)).collect();
    match roots.as_slice() {
        [root] => Ok(root),
        [] => Err("no root: every link is the child of a joint".into()),
        several => Err(format!("several roots: links {}; allowed: one", several.join(", "))),
    }
}

/// Every joint leads somewhere, each link has one joint before it, and the chain from the root has them all.
fn require_connected(robot: &urdf_rs::Robot, chain: &[UrdfJoint]) -> Result<(), String> {
    for (index, joint) in robot.joints.iter().enumerate() {
        let twin = robot.joints[..index].iter().find(|other| other.child.link == joint.child.link);
        if let Some(twin) = twin {
            let child = &joint.child.link;
            return Err(format!(
                "{} and {} both lead to link {child}; allowed: a tree",
                named(twin),
                named(joint)
            ));
        }
        if moves(joint) && chain.iter().all(|known| known.name != joint.name) {
            return Err(format!("{} is not connected with the root", named(joint)));
        }
    }
    Ok(())
}

/// A link and all that is fixed to it; `pose` is its frame in that of the body.
fn collect<'a>(robot: &'a urdf_rs::Robot, name: &str, pose: Isometry3<f64>) -> Result<Body<'a>, String> {
    let mut body = Body::default();
    let mut open = vec![(pose, name.to_owned())];
    while let Some((pose, name)) = open.pop() {
        let mut links = robot.links.iter().filter(|link| link.name == name);
        let link = links.next().ok_or_else(|| format!("link {name}, which a joint names, is missing"))?;
        if links.next().is_some() || body.parts.len() > robot.links.len() {
            return Err(format!("link {name} stands there twice, or is behind itself"));
        }
        body.parts.push((pose * isometry(&link.inertial.origin)?, &link.inertial));
        let behind: Vec<_> = robot.joints.iter().filter(|joint| joint.parent.link == name).collect();
        if behind.is_empty() {
            body.ends.push((pose, &link.name));
        }
        for joint in behind {
            let there = pose * isometry(&joint.origin)?;
            match joint.joint_type {
                JointType::Fixed => open.push((there, joint.child.link.clone())),
                _ => body.moving.push((there * turn_to(axis(joint)?), joint)),
            }
        }
    }
    Ok(body)
}

/// The joint behind a body, and the frame whose z is its axis.
fn next<'a>(body: &Body<'a>) -> Result<Option<(Isometry3<f64>, &'a urdf_rs::Joint)>, String> {
    match body.moving.as_slice() {
        [] => Ok(None),
        [only] => Ok(Some(*only)),
        [(_, first), (_, second), ..] => {
            let (first, second) = (named(first), named(second));
            Err(format!("{first} and {second} branch from one link; allowed: one chain"))
        }
    }
}

fn the_tip(body: &Body<'_>, asked: Option<&str>) -> Result<Isometry3<f64>, String> {
    let names: Vec<_> = body.ends.iter().map(|(_, name)| *name).collect();
    let listed = names.join(", ");
    match (asked, body.ends.as_slice()) {
        (Some(asked), ends) => {
            ends.iter().find(|(_, name)| *name == asked).map(|(pose, _)| *pose).ok_or_else(|| {
                format!("no link {asked} at the end of the chain for robot.tip; allowed: {listed}")
            })
        }
        (None, [(pose, _)]) => Ok(*pose),
        (None, _) => Err(format!("the chain ends in the links {listed}; robot.tip has to name one")),
    }
}

fn vector(numbers: &urdf_rs::Vec3) -> Result<Vector3<f64>, String> {
    let vector = Vector3::from(numbers.0);
    if vector.iter().all(|number| number.is_finite()) {
        return Ok(vector);
    }
    Err(format!("{:?} has a number that is not finite", numbers.0))
}

fn isometry(pose: &urdf_rs::Pose) -> Result<Isometry3<f64>, String> {
    let [roll, pitch, yaw] = vector(&pose.rpy)?.into();
    let turn = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    Ok(Isometry3::from_parts(vector(&pose.xyz)?.into(), turn))
}

fn axis(joint: &urdf_rs::Joint) -> Result<Vector3<f64>, String> {
    let axis = vector(&joint.axis.xyz)?;
    let size = axis.norm();
    if size > 1e-6 { Ok(axis / size) } else { Err(format!("{} has an axis of length 0", named(joint))) }
}

/// The least turn of z into this direction; about x where they are opposite.
fn turn_to(direction: Vector3<f64>) -> UnitQuaternion<f64> {
    let half_turn = || UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
    UnitQuaternion::rotation_between(&Vector3::z(), &direction).unwrap_or_else(half_turn)
}

fn axes(pose: &Isometry3<f64>) -> [[f64; 3]; 3] {
    [Vector3::x(), Vector3::y(), Vector3::z()].map(|unit| (pose.rotation * unit).into())
}

/// Mass, centre and inertia of a body.
fn link(body: &Body<'_>, joint: &urdf_rs::Joint, end: &Isometry3<f64>) -> Result<Link, String> {
    let masses: f64 = body.parts.iter().map(|(_, inertial)| inertial.mass.value).sum();
    let least = body.parts.iter().map(|(_, inertial)| inertial.mass.value).fold(f64::INFINITY, f64::min);
    if !(masses > 0.0 && masses.is_finite() && least >= 0.0) {
        let child = &joint.child.link;
        return Err(format!(
            "the mass of link {child} behind {} is {masses} kg; allowed: above 0",
            named(joint)
        ));
    }
    let place = |pose: &Isometry3<f64>| (pose * Point3::origin()).coords;
    let moments = body.parts.iter().map(|(pose, inertial)| inertial.mass.value * place(pose));
    let centre = moments.sum::<Vector3<f64>>() / masses;
    let tensor: Matrix3<f64> = body.parts.iter().map(|(pose, inertial)| about(pose, inertial, centre)).sum();
    let link = Link {
        end: Pose { axes: axes(end), place: end.translation.vector.into() },
        mass: masses,
        centre: centre.into(),
        inertia: [tensor.m11, tensor.m22, tensor.m33],
        products: [tensor.m12, tensor.m13, tensor.m23],
        flange: 0.0,
    };
    let principal = link.principal_moments();
    if is_inertia(principal) {
        return Ok(link);
    }
    Err(format!(
        "the principal moments of inertia of link {} behind {} are {principal:.3?} kg m^2; allowed: above 0, none larger \
         than the sum of the others",
        joint.child.link,
        named(joint)
    ))
}

/// Inertia of a part about the centre of its body.
fn about(pose: &Isometry3<f64>, inertial: &urdf_rs::Inertial, centre: Vector3<f64>) -> Matrix3<f64> {
    let urdf_rs::Inertia { ixx, ixy, ixz, iyy, iyz, izz } = inertial.inertia;
    let turn = pose.rotation.to_rotation_matrix();
    let own = turn * Matrix3::new(ixx, ixy, ixz, ixy, iyy, iyz, ixz, iyz, izz) * turn.inverse();
    let off = pose.translation.vector - centre;
    own + inertial.mass.value * (Matrix3::from_diagonal_element(off.norm_squared()) - off * off.transpose())
}

fn limits(joint: &urdf_rs::Joint) -> Result<Limits, String> {
    let urdf_rs::JointLimit { lower, upper, effort, velocity, .. } = joint.limit;
    let most = |limit: f64| if limit > 0.0 { limit } else { f64::INFINITY };
    let angle = match joint.joint_type {
        JointType::Revolute if lower < upper => [lower, upper],
        JointType::Revolute => {
            return Err(format!(
                "{}: limits {lower} to {upper} rad; allowed: lower below upper",
                named(joint)
            ));
        }
        _ => Limits::NONE.angle,
    };
    Ok(Limits { angle, velocity: most(velocity), torque: most(effort) })
}

#[cfg(test)]
mod tests {
    use super::*;

    const ARM: &str = include_str!("../../../examples/arm/arm.urdf");

    fn refused(from: &str, to: &str) -> String {
        assert!(ARM.contains(from), "{from}");
        UrdfArm::parse(&ARM.replacen(from, to, 1), None).unwrap_err()
    }

    #[test]
    fn the_example_has_two_joints_and_their_limits() {
        let arm = UrdfArm::parse(ARM, None).unwrap();
        let names: Vec<_> = arm.joints.iter().map(|joint| joint.name.as_str()).collect();
        assert_eq!((arm.name.as_str(), names.as_slice()), ("two-joint arm", &["shoulder", "elbow"][..]));
        assert_eq!(arm.joints[0].limits, Limits { angle: [-3.0, 3.0], velocity: 5.0, torque: 150.0 });
        // z of the first joint is -y of the root, which is horizontal.
        let [_, up, forward] = arm.base;
        assert!((up[2] - 1.0).abs() < 1e-12 && (forward[1] + 1.0).abs() < 1e-12, "{:?}", arm.base);
    }

    /// What a fixed joint holds is merged: forearm and tool are the one link of the robot file.
    #[test]
    fn fixed_joints_are_merged() {
        let forearm = UrdfArm::parse(ARM, None).unwrap().joints[1].link;
        let expected = [4.0, 0.2, 0.006, 0.06, 0.06, 0.35];
        let [xx, yy, zz] = forearm.inertia;
        let found = [forearm.mass, forearm.centre[0], xx, yy, zz, forearm.end.place[0]];
        assert!(found.iter().zip(expected).all(|(found, asked)| (found - asked).abs() < 1e-14), "{found:?}");
        assert!(forearm.products.iter().all(|product| product.abs() < 1e-15), "{:?}", forearm.products);
    }

    #[test]
    fn what_is_no_chain_of_revolute_joints_is_named() {
        let elbow = "<joint name=\"elbow\" type=\"revolute\">";
        for kind in ["prismatic", "floating", "planar"] {
            let line = refused(elbow, &format!("<joint name=\"elbow\" type=\"{kind}\">"));
            let expected =
                format!("joint elbow ({kind}) is not supported; allowed: revolute, continuous and fixed");
            assert_eq!(line, expected);
        }
        let line = refused(elbow, &format!("{elbow}<mimic joint=\"shoulder\"/>"));
        assert_eq!(line, "joint elbow (revolute) mimics shoulder; allowed: joints with a motor of their own");
        let line = refused("<parent link=\"upper_arm\"/>", "<parent link=\"base\"/>");
        assert_eq!(
            line,
            "joint shoulder (revolute) and joint elbow (revolute) branch from one link; allowed: one chain"
        );
        let line = refused("<parent link=\"upper_arm\"/>", "<parent link=\"tool\"/>");
        assert!(line.contains("elbow (revolute) is not connected with the root"), "{line}");
        let line = refused("<parent link=\"upper_arm\"/>", "<parent link=\"shelf\"/>");
        assert!(line.contains("elbow (revolute) is not connected with the root"), "{line}");
        let line = refused("<child link=\"forearm\"/>", "<child link=\"shelf\"/>");
        assert!(line.starts_with("several roots: links base, forearm"), "{line}");
        let line = refused("<mass value=\"4.0\"/>", "<mass value=\"0\"/>");
        assert!(
            line.starts_with("the mass of link upper_arm behind joint shoulder (revolute) is 0 kg"),
            "{line}"
        );
        let line = refused("izz=\"0.06\"", "izz=\"0.6\"");
        assert!(
            line.starts_with("the principal moments of inertia of link upper_arm behind joint"),
            "{line}"
        );
        let line = refused("lower=\"-3.0\"", "lower=\"4.0\"");
        assert!(line.starts_with("joint shoulder (revolute): limits 4 to 3 rad"), "{line}");
        let line = refused("</robot>", "");
        assert!(line.starts_with("not a URDF file: "), "{line}");
    }

    #[test]
    fn a_chain_with_several_ends_needs_a_tip() {
        let camera = "<link name=\"camera\"/><joint name=\"mount\" type=\"fixed\"><origin xyz=\"0.1 0 0.05\"/>\
                      <parent link=\"forearm\"/><child link=\"camera\"/></joint></robot>";
        let text = ARM.replacen("</robot>", camera, 1);
        let line = UrdfArm::parse(&text, None).unwrap_err();
        assert!(line.ends_with("; robot.tip has to name one") && line.contains("camera"), "{line}");
        let place = |tip| UrdfArm::parse(&text, Some(tip)).unwrap().joints[1].link.end.place;
        assert!((place("camera")[2] - 0.05).abs() < 1e-15 && (place("tip")[0] - 0.35).abs() < 1e-15);
        let line = UrdfArm::parse(&text, Some("shelf")).unwrap_err();
        assert!(line.starts_with("no link shelf at the end of the chain for robot.tip; allowed: "), "{line}");
    }
}
