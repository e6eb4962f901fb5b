//! A held motor and a constant load: torsion and span forces of the settled chain against their closed forms.
//!
//! ```text
//! |load| <= 2*F0*r:  F = F0 -+ load/(2*r)              both spans are taut
//! |load| >  2*F0*r:  F = |load|/r and 0                one is slack, the other alone carries the load
//! phi = -sign(load)*(F_tight - F0)/(K*r),  K = EA/L
//! ```

use strainwave::belt::BeltTorques;
use strainwave::gear::Motion;

use super::plain;
use crate::io::figure::Figure;
use crate::verify::{bounds, largest};

/// Nodes of a span.
const NODES: usize = 8;
/// Loads as fractions of that at which a span becomes slack.
const TAUT: [f64; 4] = [-0.95, -0.3, 0.1, 0.8];
const SLACK: [f64; 3] = [-2.5, 1.2, 3.0];
/// Time in which the load comes on, and that in which the chain settles (s).
const RAMP: f64 = 0.1;
const SETTLING: f64 = 2.0;
/// Damping over stiffness of the belt (s), and viscous friction at the output (N m s/rad): some 0.5 of the critical one.
const DAMPING_TIME: f64 = 1e-5;
const VISCOUS: f64 = 20.0;

pub(super) fn measure() -> Vec<Figure> {
    let taut = TAUT.map(Settled::under);
    let slack = SLACK.map(Settled::under);
    let stiffness = taut.iter().map(|settled| settled.stiffness_error());
    let forces = taut.iter().chain(&slack).map(Settled::force_error);
    vec![
        bounds::figure("belt.stiffness", largest(stiffness)),
        bounds::figure("belt.stiffness.slack", largest(slack.iter().map(Settled::stiffness_error))),
        bounds::figure("belt.span_forces", largest(forces)),
    ]
}

/// The chain at rest under a load.
struct Settled {
    /// (N m)
    load: f64,
    torques: BeltTorques<f64>,
}

impl Settled {
    /// At a fraction of the load at which a span becomes slack.
    fn under(fraction: f64) -> Self {
        let params = plain(DAMPING_TIME, VISCOUS);
        let load = fraction * 2.0 * params.span.pretension * params.radius(&params.output);
        let dt = 0.5 * params.stable_step(NODES);
        let belt = params.build::<NODES>(dt).expect("the example is in range");
        let (mut state, mut output, held) = (belt.rest(), Motion::default(), Motion::default());
        let mut torques = BeltTorques::default();
        for step in 0..((RAMP + SETTLING) / dt) as u32 {
            // Smooth at both ends, so that little rings on.
            let x = (f64::from(step) * dt / RAMP).min(1.0);
            torques = belt.step(&mut state, &mut output, &held, load * x * x * (3.0 - 2.0 * x));
        }
        Self { load, torques }
    }

    /// Tensions of the forward and of the backward span (N).
    fn closed_forces(&self) -> [f64; 2] {
        let params = plain(DAMPING_TIME, VISCOUS);
        let force = self.load / params.radius(&params.output);
        let pretension = params.span.pretension;
        if force.abs() <= 2.0 * pretension {
            [pretension - 0.5 * force, pretension + 0.5 * force]
        } else {
            [(-force).max(0.0), force.max(0.0)]
        }
    }

    /// Relative error of load over torsion.
    fn stiffness_error(&self) -> f64 {
        let params = plain(DAMPING_TIME, VISCOUS);
        let tight = self.closed_forces().into_iter().fold(0.0, f64::max);
        let stretch = (tight - params.span.pretension) / params.span.span_stiffness();
        let torsion = -self.load.signum() * stretch / params.radius(&params.output);
        self.torques.torsion / torsion - 1.0
    }

    /// Largest error of a tension, relative to the pretension.
    fn force_error(&self) -> f64 {
        let [forward, backward] = self.closed_forces();
        let errors = [self.torques.forward - forward, self.torques.backward - backward];
        largest(errors) / plain(DAMPING_TIME, VISCOUS).span.pretension
    }
}
