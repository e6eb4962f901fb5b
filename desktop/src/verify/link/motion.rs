//! A fast move of the joint, a hold and a pull at the tip, under gravity: torque of the joint and deflection of the tip against a beam of
//! 40 Hermite elements.
//!
//! The answer is `desktop/oracle/link/motion.csv`, by `beam.py` beside it, which says what moves how; its constants are here again.
//! The elements' torque is the reaction at the clamp, the link's a balance of momentum; the elements have 80 modes, the link two.

use std::f64::consts::{PI, TAU};

use strainwave::gear::Motion;
use strainwave::link::{LinkInput, LinkParams};
use strainwave::{Angle, Real};

use crate::io::figure::Figure;
use crate::verify::{bounds, largest};

const STORED: &str = include_str!("../../../oracle/link/motion.csv");
/// Step (s).
pub(super) const DT: f64 = 1e-4;
/// Steps from one stored row to the next.
const EVERY: usize = 20;
const ANGLE: f64 = 1.2;
const DURATION: f64 = 0.4;
const FORCE: f64 = 2.0;
const PULL: f64 = 0.5;
const PULLED: f64 = 0.1;

/// Largest differences over the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Differences {
    /// Of the torque, over the largest torque.
    pub torque: f64,
    /// Of the deflection, over the largest deflection.
    pub deflection: f64,
}

/// The link of the motion, with two modes.
pub fn link_params<R: Real>() -> LinkParams<R> {
    LinkParams {
        length: R::lit(0.6),
        bending_stiffness: R::lit(90.0),
        linear_density: R::lit(0.5),
        thickness: R::lit(5e-3),
        payload_mass: R::lit(0.4),
        payload_inertia: R::lit(4e-4),
        damping: [R::lit(0.01); 2],
        gravity: R::lit(9.81),
        patch: None,
    }
}

pub(super) fn measure() -> Vec<Figure> {
    let Differences { torque, deflection } = differences(&link_params());
    vec![
        bounds::figure("link.torque.finite_elements", torque),
        bounds::figure("link.tip.finite_elements", deflection),
        bounds::figure("link.f32", single_precision()),
    ]
}

/// Those of a link from the stored one.
///
/// # Panics
/// When the embedded file is not the table, which is a mistake in the program, or the link cannot be built.
pub fn differences(params: &LinkParams<f64>) -> Differences {
    let mut reader = csv::Reader::from_reader(STORED.as_bytes());
    let stored: Vec<[f64; 3]> =
        reader.deserialize().map(|row| row.expect("motion.csv is a table of a motion")).collect();
    let found = run(params, (stored.len() - 1) * EVERY);
    let relative = |column: usize| {
        let size = largest(stored.iter().map(|row| row[column]));
        largest(stored.iter().zip(found.iter().step_by(EVERY)).map(|(a, b)| a[column] - b[column - 1])) / size
    };
    Differences { torque: relative(1), deflection: relative(2) }
}

/// Torque and deflection after each of so many steps, from rest.
fn run<R: Real>(params: &LinkParams<R>, steps: usize) -> Vec<[f64; 2]> {
    let link = params.build(R::lit(DT)).expect("the parameters are in range");
    let mut state = link.settled(&input(0.0));
    let times = (0..=steps).map(|step| step as f64 * DT);
    let outputs = times.map(|time| link.step(&mut state, &input(time)));
    outputs.map(|output| [output.torque.to_f64(), output.deflection.to_f64()]).collect()
}

fn input<R: Real>(time: f64) -> LinkInput<R> {
    let x = (time / DURATION).clamp(0.0, 1.0);
    let (sine, cosine) = (TAU * x).sin_cos();
    let joint = Motion {
        angle: Angle::from_radians_f64(ANGLE * (x - sine / TAU)),
        velocity: R::lit(ANGLE / DURATION * (1.0 - cosine)),
    };
    let acceleration = R::lit(ANGLE * TAU / DURATION.powi(2) * sine);
    let pulled = ((time - PULL) / PULLED).clamp(0.0, 1.0);
    let tip_force = R::lit(FORCE * (PI * pulled).sin().powi(2));
    LinkInput { joint, acceleration, tip_force, couple: R::ZERO }
}

/// Largest difference of the torque in f32 from that in f64, over the largest torque.
fn single_precision() -> f64 {
    let steps = 50_000;
    let (single, double) = (run(&link_params::<f32>(), steps), run(&link_params::<f64>(), steps));
    largest(single.iter().zip(&double).map(|(a, b)| a[0] - b[0])) / largest(double.iter().map(|row| row[0]))
}
