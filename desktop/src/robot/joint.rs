//! A joint of a robot: its gear, the link behind it, and what it may do.

use std::path::Path;

use super::beam::Beam;
use super::chain::Link;
use crate::design::buildable::buildable;
use crate::io::file::BadInput;
use crate::io::gear_file::GearFile;
use crate::io::keyed_file::key::{Allowed, within};

/// Largest magnitude of gravity (m/s^2), and of a length (m).
pub(super) const LARGEST: f64 = 100.0;
/// A component of gravity.
pub(super) const GRAVITY: Allowed = within(-LARGEST, LARGEST, "m/s^2");
/// An angle.
pub(super) const ANGLE: Allowed = within(-std::f64::consts::PI, std::f64::consts::PI, "rad");

/// A joint and the link behind it.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// The gear, and all that the joint's controller knows.
    pub gear: GearFile,
    /// Angle at the start (rad).
    pub start: f64,
    /// The link; without what turns with the flange alone. Of a beam what it is when it does not bend.
    pub link: Link,
    /// The beam that it is, where it bends.
    pub beam: Option<Beam>,
    /// What the link's joint may do, besides what the gear can.
    pub limits: Limits,
}

/// Limits of a joint; infinite where there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Least and largest angle (rad).
    pub angle: [f64; 2],
    /// Largest speed (rad/s).
    pub velocity: f64,
    /// Largest torque (N m).
    pub torque: f64,
}

impl Limits {
    /// No limit.
    pub const NONE: Self =
        Self { angle: [f64::NEG_INFINITY, f64::INFINITY], velocity: f64::INFINITY, torque: f64::INFINITY };
}

/// The gear file that a joint names, which a compensator can be built for.
///
/// # Errors
/// One line that names the key and what is wrong with the gear.
pub(super) fn usable(
    path: &Path,
    index: usize,
    name: &str,
    gear: impl Fn(&str) -> Result<GearFile, BadInput>,
) -> Result<GearFile, BadInput> {
    let gear = gear(name)?;
    let refuse = |why: String| BadInput::new(path, format_args!("joint[{index}].gear = {name:?}: {why}"));
    buildable(&gear).map_err(refuse)?;
    Ok(gear)
}
