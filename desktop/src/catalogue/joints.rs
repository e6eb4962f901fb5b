//! A Latin hypercube of joints over the gears of the catalogue.
//!
//! | dimension | range |
//! | --- | --- |
//! | gear | each of [`FILES`] |
//! | load L = J_fs/(N^2*J_wg) | 0.1 to 20, even over the logarithm |
//! | motor encoder | 14 to 23 bits |
//! | output encoder | none in half of the joints, else 16 to 19 bits |
//!
//! Of [`COUNT`] joints each lies in another of as many equal parts of every dimension. What is drawn is known when a joint
//! is built and stands in its gear file; its plant differs by the box ([`crate::plant::box_sample`]) of the joint's seed, and by
//! more where that is asked for ([`crate::plant::unknowns`]).
//!
//! A load below 4.8*dt^2*K3 (dt: control period) is raised to it: below 4*dt^2*K3 no gear file is allowed. It happens to
//! small gears of low ratio with next to no load.
//!
//! M. McKay, R. Beckman, W. Conover, "A comparison of three methods for selecting values of input variables in the
//! analysis of output from a computer code", Technometrics 21 (1979).

use std::ops::Range;

use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainwave::Error;

use super::FILES;
use super::load::{load_ratio, with_load};
use crate::io::gear_file::GearFile;
use crate::plant::sample::PlantSample;
use crate::plant::unknowns::Which;
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Joints of a set.
pub const COUNT: u64 = 500;
/// Seeds of the training joints that one gear is tuned on.
const OF_ONE_GEAR: u64 = 501;

/// Ends of the load.
const LOADS: [f64; 2] = [0.1, 20.0];
/// Bits of the motor's and of the output's encoder.
const MOTOR_BITS: Range<u32> = 14..24;
const OUTPUT_BITS: Range<u32> = 16..20;
/// Least load in dt^2*K3: the limit of the gear file's check, 4, with room.
const LEAST_LOAD: f64 = 4.8;

/// For what joints are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Set {
    /// For choosing gains.
    Training,
    /// For claims.
    Judged,
}

impl Set {
    /// Seed of its first joint, and of its hypercube.
    pub fn first(self) -> u64 {
        match self {
            Self::Training => 1,
            Self::Judged => 10_000,
        }
    }

    /// Seeds of its joints.
    pub fn seeds(self) -> Range<u64> {
        self.first()..self.first() + COUNT
    }

    /// Its joints, in the order of their seeds.
    pub fn joints(self) -> Vec<Joint> {
        let points = hypercube(self.first(), COUNT as usize);
        let gears: Vec<_> = FILES.iter().map(super::File::gear).collect();
        let joint = |(seed, point): (u64, Point)| {
            let gear = &gears[place(point[0], 0..gears.len() as u32) as usize];
            Joint { seed, known: built(gear, &point), unknown: Which::BOX }
        };
        self.seeds().zip(points).map(joint).collect()
    }
}

/// A joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Of its plant and noise.
    pub seed: u64,
    /// Its gear file.
    pub known: GearFile,
    /// By what its plant differs from that.
    pub unknown: Which,
}

impl Joint {
    /// Its plant.
    ///
    /// # Errors
    /// As [`PlantSample::of`].
    pub fn plant(&self) -> Result<PlantSample, Error> {
        let sample = PlantSample::of(&self.known, self.unknown, self.seed)?;
        // Its encoders are those that it was drawn with, though there is a row of encoders too.
        Ok(PlantSample { known: self.known.clone(), ..sample })
    }

    /// For people: gear, load and encoders.
    pub fn describe(&self) -> String {
        let sensors = &self.known.sensors;
        let output = sensors.output_encoder_bits.map_or_else(|| "-".into(), |bits| bits.to_string());
        format!(
            "{} {} load {:.2} bits {}/{output}",
            self.seed,
            self.known.gear.name,
            load_ratio(&self.known),
            sensors.motor_encoder_bits
        )
    }
}

/// Training joints of one gear, a hypercube of their own.
pub fn of_gear(gear: &GearFile, count: u64) -> Vec<Joint> {
    let points = hypercube(OF_ONE_GEAR, count as usize);
    let seeds = OF_ONE_GEAR..;
    let joint = |(seed, point)| Joint { seed, known: built(gear, &point), unknown: Which::BOX };
    seeds.zip(points).map(joint).collect()
}

/// Gear, load, motor encoder, output encoder, each from 0 to 1.
type Point = [f64; 4];

/// Points of which each has a part of its own in every dimension.
fn hypercube(seed: u64, count: usize) -> Vec<Point> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut points = vec![Point::default(); count];
    for dimension in 0..Point::default().len() {
        let mut parts: Vec<_> = (0..count).collect();
        parts.shuffle(&mut random);
        for (point, part) in points.iter_mut().zip(parts) {
            point[dimension] = (part as f64 + random.random_range(0.0..1.0)) / count as f64;
        }
    }
    points
}

/// The whole number of a range at a fraction of it.
fn place(fraction: f64, range: Range<u32>) -> u32 {
    range.start + ((fraction * f64::from(range.end - range.start)) as u32).min(range.end - range.start - 1)
}

fn built(gear: &GearFile, [_, load, motor, output]: &Point) -> GearFile {
    let n = f64::from(gear.gear.ratio);
    let drawn = LOADS[0] * (LOADS[1] / LOADS[0]).powf(*load) * n * n * gear.inertia.wave_generator;
    let least = LEAST_LOAD * CONTROL_PERIOD * CONTROL_PERIOD * gear.stiffness.k3;
    let mut known = with_load(gear, drawn.max(least));
    known.sensors.motor_encoder_bits = place(*motor, MOTOR_BITS);
    known.sensors.output_encoder_bits = (*output >= 0.5).then(|| place(2.0 * output - 1.0, OUTPUT_BITS));
    known.sensors.output_encoder_zero = known.sensors.output_encoder_bits.map(|_| 0.0);
    known
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_of_every_dimension_has_one_point() {
        let points = hypercube(7, 50);
        for dimension in 0..4 {
            let mut parts: Vec<_> = points.iter().map(|point| (point[dimension] * 50.0) as usize).collect();
            parts.sort_unstable();
            assert_eq!(parts, (0..50).collect::<Vec<_>>());
        }
        assert_eq!(points, hypercube(7, 50));
        assert_ne!(points, hypercube(8, 50));
    }

    /// Every joint's file could be written and read, and lies in the ranges that are said.
    #[test]
    fn every_joint_is_one() {
        for set in [Set::Training, Set::Judged] {
            let joints = set.joints();
            assert_eq!(joints.len(), COUNT as usize);
            let with_output = joints.iter().filter(|joint| joint.known.sensors.output_encoder_bits.is_some());
            assert_eq!(with_output.count(), COUNT as usize / 2);
            for joint in &joints {
                joint.known.check().unwrap_or_else(|error| panic!("{}: {error}", joint.describe()));
                assert!((0.099..20.1).contains(&load_ratio(&joint.known)), "{}", joint.describe());
            }
        }
    }

    #[test]
    fn no_joint_is_in_both_sets() {
        let [training, judged] = [Set::Training, Set::Judged].map(Set::joints);
        assert!(training.iter().all(|joint| judged.iter().all(|other| other.known != joint.known)));
    }

    #[test]
    fn a_share_has_its_place() {
        assert_eq!([0.0, 0.09, 0.1, 0.999].map(|fraction| place(fraction, MOTOR_BITS)), [14, 14, 15, 23]);
    }
}
