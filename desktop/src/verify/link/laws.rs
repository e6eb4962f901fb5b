//! Energy without loss, the power at both ports, and the symmetry of the coupling.

use strainwave::Angle;
use strainwave::gear::Motion;
use strainwave::link::{Link, LinkInput, LinkOutput, LinkParams};

use super::motion::{DT, link_params};
use crate::io::figure::Figure;
use crate::verify::{bounds, largest};

/// Steps without load, over which the energy stays.
const FREE: u32 = 1_000_000;
/// Steps of the driven motion.
const DRIVEN: u32 = 20_000;

pub(super) fn measure() -> Vec<Figure> {
    let link = LinkParams { damping: [0.0; 2], ..link_params() }.build(DT).expect("in range");
    vec![
        bounds::figure("link.energy.free", free(&link)),
        bounds::figure("link.energy.ports", ports(&link)),
        bounds::figure("link.coupling", asymmetry()),
    ]
}

/// Largest relative change of the energy of a link that swings with the joint held level.
fn free(link: &Link<f64, 2>) -> f64 {
    let held = LinkInput::default();
    let mut state = link.settled(&LinkInput { tip_force: 20.0, ..held });
    link.step(&mut state, &held);
    let rest = link.energy(&link.settled(&held), &held.joint);
    let start = link.energy(&state, &held.joint) - rest;
    largest((0..FREE).map(|_| {
        link.step(&mut state, &held);
        (link.energy(&state, &held.joint) - rest) / start - 1.0
    }))
}

/// Work at joint and tip, by trapezoids, less the change of the energy, over all that went through both ports.
fn ports(link: &Link<f64, 2>) -> f64 {
    let input = |k: u32| {
        let t = f64::from(k) * DT;
        let (amplitude, omega) = (0.4, 9.0);
        let (sine, cosine) = (omega * t).sin_cos();
        let angle = Angle::from_radians_f64(amplitude * (1.0 - cosine));
        let joint = Motion { angle, velocity: amplitude * omega * sine };
        let tip_force = 3.0 * (1.0 - (17.0 * t).cos());
        LinkInput { joint, acceleration: amplitude * omega * omega * cosine, tip_force, couple: 0.0 }
    };
    let powers = |output: &LinkOutput<f64>, input: &LinkInput<f64>| {
        [output.torque * input.joint.velocity, input.tip_force * output.tip_velocity]
    };
    let mut state = link.settled(&input(0));
    let start = link.energy(&state, &input(0).joint);
    let mut before = powers(&link.peek(&state, &input(0)), &input(0));
    let (mut work, mut through) = (0.0, 0.0);
    for k in 1..=DRIVEN {
        let now = powers(&link.step(&mut state, &input(k)), &input(k));
        for (before, now) in before.iter().zip(now) {
            work += 0.5 * DT * (before + now);
            through += 0.5 * DT * (before + now).abs();
        }
        before = now;
    }
    let change = link.energy(&state, &input(DRIVEN).joint) - start;
    (work - change).abs() / through
}

/// Torque of a link that swings freely against the bending moment at its clamp, which a gauge there shows: relative difference.
///
/// The torque comes from the coefficients by which the joint's acceleration drives the modes, the moment from their curvature.
fn asymmetry() -> f64 {
    let params = LinkParams { damping: [0.0; 2], gravity: 0.0, ..link_params() };
    let link = params.build(DT).expect("in range");
    let gauge = params.gauge(0.0).expect("the clamp is on the link");
    let mut state = link.settled(&LinkInput { acceleration: 10.0, ..LinkInput::default() });
    let errors = (0..1000).map(|_| {
        let torque = link.step(&mut state, &LinkInput::default()).torque;
        let curvature = -2.0 * link.strain(&state, &gauge) / params.thickness;
        [torque, torque + params.bending_stiffness * curvature]
    });
    let errors: Vec<_> = errors.collect();
    largest(errors.iter().map(|[_, error]| *error)) / largest(errors.iter().map(|[torque, _]| *torque))
}
