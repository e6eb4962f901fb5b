//! The real-time reduction against the chain of many nodes: the example with its damping, friction and pitch error, both in f64.
//!
//! The motor accelerates and brakes within 0.1 s each, the output under a load that jumps to -4 N m; at [`HARDER_LOAD`] it jumps to
//! 45 N m, under which the forward span goes slack. The largest differences of torsion and of span forces, relative to the largest torsion
//! and to the pretension.

use strainwave::Real;
use strainwave::belt::BeltTorques;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::gear::Motion;

use crate::design::belt::belt_params;
use crate::io::belt_file::BeltFile;
use crate::io::figure::Figure;
use crate::plant::belt::{NODES, reference_steps};
use crate::verify::{bounds, largest};

/// Control periods of the run.
const PERIODS: u32 = 5000;
/// When the load comes on under which a span goes slack (s).
const HARDER_LOAD: f64 = 0.3;

pub(super) fn measure() -> Vec<Figure> {
    let steps = reference_steps(&belt_params::<f64>(&BeltFile::example()));
    let chain = run::<f64, NODES>(steps);
    let reduced = run::<f64, 0>(1);
    let pairs: Vec<_> = chain.iter().zip(&reduced).collect();
    let (taut, slack) = pairs.split_at((HARDER_LOAD / CONTROL_PERIOD).round() as usize);
    assert!(taut.iter().all(|(chain, _)| !chain.slack) && slack.iter().any(|(chain, _)| chain.slack));
    let torsion = largest(pairs.iter().map(|(a, b)| a.torsion - b.torsion));
    vec![
        bounds::figure(
            "belt.reduction.torsion",
            torsion / largest(chain.iter().map(|torques| torques.torsion)),
        ),
        bounds::figure("belt.reduction.forces", force_difference(taut)),
        bounds::figure("belt.reduction.forces.slack", force_difference(slack)),
    ]
}

/// Largest difference of a span force, relative to the pretension.
fn force_difference(pairs: &[(&BeltTorques<f64>, &BeltTorques<f64>)]) -> f64 {
    let forces = pairs.iter().flat_map(|(a, b)| [a.forward - b.forward, a.backward - b.backward]);
    largest(forces) / BeltFile::example().belt.pretension
}

/// Speed of the motor (rad/s).
fn motor_speed(time: f64) -> f64 {
    // A smooth rise and fall, 60 rad/s at most.
    let x = (time / 0.2).min(1.0);
    60.0 * (std::f64::consts::PI * x).sin().powi(2)
}

/// Load (N m).
fn load(time: f64) -> f64 {
    match time {
        time if time < 0.05 => 0.0,
        time if time < HARDER_LOAD => -4.0,
        _ => 45.0,
    }
}

/// Torques at every control period, of spans of `N` nodes in `steps` steps a period.
pub(super) fn run<R: Real, const N: usize>(steps: usize) -> Vec<BeltTorques<R>> {
    let dt = CONTROL_PERIOD / steps as f64;
    let belt =
        belt_params::<R>(&BeltFile::example()).build::<N>(R::lit(dt)).expect("the example is in range");
    let (mut state, mut output, mut motor) = (belt.rest(), Motion::default(), Motion::default());
    (0..PERIODS)
        .map(|period| {
            let mut first = None;
            for step in 0..steps {
                let time = f64::from(period) * CONTROL_PERIOD + step as f64 * dt;
                let torques = belt.step(&mut state, &mut output, &motor, R::lit(load(time)));
                first.get_or_insert(torques);
                motor.velocity = R::lit(motor_speed(time + dt));
                motor.angle = motor.angle.plus(R::lit(dt) * motor.velocity);
            }
            first.unwrap_or_default()
        })
        .collect()
}
