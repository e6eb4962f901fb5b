//! Robot sample: gears and links that differ from what the joints' controllers know.
//!
//! Every joint is drawn from the box of a seed of its own ([`crate::plant::box_sample`]): joint i of the robot of seed s from s + i, so that
//! robots of n joints follow each other at s, s + n, ... The factor on the load's inertia acts on mass and inertia of the link.
//! Seed 0 is the robot of the file.

use strainwave::Error;
use strainwave::gear::GearParams;

use super::beam::Beam;
use super::chain::Link;
use super::file::RobotFile;
use crate::design::belt::driving_belt;
use crate::design::joint::firmware_gear_params;
use crate::plant::box_sample::BoxSample;
use crate::plant::driving_belt::DrivingBeltParams;

/// A robot.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotSample {
    /// From which it is drawn.
    pub seed: u64,
    /// True parameters of the gears.
    pub gears: Vec<GearParams<f64>>,
    /// True belts in front of them, where there are.
    pub belts: Vec<Option<DrivingBeltParams>>,
    /// True links.
    pub links: Vec<Link>,
    /// True beams, in the place of links that bend.
    pub beams: Vec<Option<Beam>>,
    /// Angles at the start (rad).
    pub starts: Vec<f64>,
    /// Gravity in the frame of the base (m/s^2).
    pub gravity: [f64; 3],
}

/// The seed of a joint.
pub fn seed_of_joint(seed: u64, joint: usize) -> u64 {
    if seed == 0 { 0 } else { seed + joint as u64 }
}

impl RobotSample {
    /// The robot of a file with factors from the boxes of `seed`.
    ///
    /// # Errors
    /// As [`firmware_gear_params`].
    pub fn boxed(file: &RobotFile, seed: u64) -> Result<Self, Error> {
        let (mut gears, mut belts) = (Vec::new(), Vec::new());
        let (mut links, mut beams) = (Vec::new(), Vec::new());
        for (index, joint) in file.joints.iter().enumerate() {
            let factors = BoxSample::from_seed(seed_of_joint(seed, index));
            let params: GearParams<f64> = firmware_gear_params(&joint.gear)?;
            let cup = &params.flexspline.cup;
            let flange = cup.mass() * cup.radius * cup.radius;
            let beam = joint.beam.map(|beam| beam.scaled(factors.inertia));
            let link = beam.map_or_else(|| joint.link.scaled(factors.inertia), |beam| beam.straight());
            links.push(Link { flange, ..link });
            beams.push(beam);
            gears.push(factors.apply(&params));
            belts.push(driving_belt(&joint.gear).map(|belt| factors.apply_to_belt(belt)));
        }
        let starts = file.joints.iter().map(|joint| joint.start).collect();
        Ok(Self { seed, gears, belts, links, beams, starts, gravity: file.gravity })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_joint_has_a_box_of_its_own() {
        let file = RobotFile::example();
        let of = |seed| RobotSample::boxed(&file, seed).unwrap();
        assert_eq!(of(10_000), of(10_000));
        let mass = |seed, joint: usize| of(seed).links[joint].mass / file.joints[joint].link.mass;
        assert_eq!([mass(0, 0), mass(0, 1)], [1.0; 2]);
        assert!(mass(10_000, 0) != mass(10_000, 1) && (mass(10_000, 1) - mass(10_001, 0)).abs() < 1e-12);
        assert!((mass(10_000, 0) - BoxSample::from_seed(10_000).inertia).abs() < 1e-12);
    }
}
