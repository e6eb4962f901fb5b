//! Energy of springs, nodes and pulley without damping, friction or load over 1e5 steps.
//!
//! The motor is held. First the output swings on the belt, wound up by half of the torsion at which a span becomes slack; then every
//! node has a random displacement and speed. Semi-implicit Euler keeps the energy but for a part that comes and goes with (w*dt)^2/8 of
//! the energy in a mode w, the speeds taken as the mean of those before and after a displacement: small in the first case, in
//! which the energy is in the slow mode, and not in the second, whose steps are therefore shorter.

use std::array::from_fn;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainwave::belt::{Belt, BeltState, SpanState};
use strainwave::friction::{LastForce, Viscous};
use strainwave::gear::Motion;

use super::plain;
use crate::io::figure::Figure;
use crate::verify::{bounds, largest};

/// Nodes of a span.
const NODES: usize = 16;
/// Steps of a run.
const STEPS: u32 = 100_000;
/// Steps as fractions of the stable one.
const SWINGING: f64 = 0.5;
const SHAKEN: f64 = 1e-3;
/// Greatest displacement (m) and speed (m/s) of a node: no link becomes slack.
const DISPLACEMENT: f64 = 2e-6;
const SPEED: f64 = 0.005;

pub(super) fn measure() -> Vec<Figure> {
    let mut swinging = Run::new(SWINGING);
    let params = plain(0.0, 0.0);
    let slack = params.span.pretension / (params.span.span_stiffness() * params.radius(&params.output));
    swinging.output.angle = swinging.output.angle.plus(-0.5 * slack);
    let stretch = -swinging.output.angle.to_radians() * params.radius(&params.output);
    // Every link the same.
    let even = |j: usize| stretch * (j + 1) as f64 / (NODES + 1) as f64;
    let span = SpanState { displacement: from_fn(even), velocity: [0.0; NODES] };
    (swinging.state.chain.forward, swinging.state.chain.backward) = (span, span);
    let mut shaken = Run::new(SHAKEN);
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut span = || SpanState {
        displacement: from_fn(|_| DISPLACEMENT * random.random_range(-1.0..1.0)),
        velocity: from_fn(|_| SPEED * random.random_range(-1.0..1.0)),
    };
    (shaken.state.chain.forward, shaken.state.chain.backward) = (span(), span());
    vec![
        bounds::figure("belt.energy", swinging.drift()),
        bounds::figure("belt.energy.every_mode", shaken.drift()),
    ]
}

type Chain = Belt<f64, Viscous<f64>, NODES>;

struct Run {
    belt: Chain,
    state: BeltState<f64, LastForce<f64>, NODES>,
    output: Motion<f64>,
    /// Of the output with the belt on its pulley (kg m^2).
    inertia: f64,
}

impl Run {
    /// At rest, with steps of this fraction of the stable one.
    fn new(fraction: f64) -> Self {
        let params = plain(0.0, 0.0);
        let belt: Chain =
            params.build(fraction * params.stable_step(NODES)).expect("the example is in range");
        let inertia = params.inertia(&params.output, NODES);
        Self { state: belt.rest(), belt, output: Motion::default(), inertia }
    }

    /// Energy before a step that is done here, above that of the belt at rest (J).
    fn step(&mut self) -> f64 {
        let held = Motion::default();
        let before = self.output;
        let spans = self.belt.span_energy(&self.state, &held, &before);
        self.belt.step(&mut self.state, &mut self.output, &held, 0.0);
        let mean = 0.5 * (before.velocity + self.output.velocity);
        spans + 0.5 * self.inertia * mean * mean - self.belt.span_energy(&self.belt.rest(), &held, &held)
    }

    /// Largest change of the energy, relative to that brought in.
    fn drift(mut self) -> f64 {
        let start = self.step();
        largest((1..STEPS).map(|_| self.step() / start - 1.0))
    }
}
