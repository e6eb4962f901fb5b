//! The area of a closed loop against the energy that the relays crossed along it dissipate.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainwave::hysteresis::{Relays, RelaysState, Staircase, StaircaseState};

use super::history::{LEVELS, random_weights};
use crate::io::figure::Figure;
use crate::verify::bounds;
use crate::verify::largest;

/// Closed loops.
const LOOPS: usize = 200;

pub(super) fn measure() -> Vec<Figure> {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let worst = largest((0..LOOPS).map(|_| closed_loop(&mut random)));
    vec![bounds::figure("hysteresis.loop_area", worst)]
}

/// Both operators along grid inputs, cell by cell: relays switch in the middle of a cell, so the trapezoid between
/// its edges is exact.
struct Walk<'a> {
    relays: &'a Relays<f64, LEVELS>,
    relays_state: RelaysState<f64, LEVELS>,
    staircase: &'a Staircase<f64, LEVELS, 51>,
    state: StaircaseState<f64, 51>,
    edge: usize,
    output: f64,
    /// Integral of the input over the output: what a loop of the output over the input takes.
    area: f64,
}

impl Walk<'_> {
    fn to(&mut self, edge: usize) {
        while self.edge != edge {
            let next = if edge > self.edge { self.edge + 1 } else { self.edge - 1 };
            let (from, to) = (self.relays.edge(self.edge), self.relays.edge(next));
            self.relays.step(&mut self.relays_state, to);
            let output = self.staircase.step(&mut self.state, to).output;
            self.area -= 0.5 * (self.output + output) * (to - from);
            (self.edge, self.output) = (next, output);
        }
    }
}

/// Relative difference over the second lap of random corners, which closes in the memory too.
fn closed_loop(random: &mut ChaCha8Rng) -> f64 {
    let weights = random_weights(random);
    let relays = Relays::build(1.0, &weights).expect("the range is positive");
    let staircase = Staircase::build(1.0, &weights).expect("as the relays");
    let mut walk = Walk {
        relays: &relays,
        relays_state: RelaysState::default(),
        staircase: &staircase,
        state: StaircaseState::default(),
        edge: LEVELS / 2,
        output: 0.0,
        area: 0.0,
    };
    let corners = random.random_range(2..30);
    let corners: Vec<usize> =
        (0..corners).map(|_| random.random_range(0..=LEVELS)).chain([0, LEVELS]).collect();
    corners.iter().for_each(|&edge| walk.to(edge));
    let (area, dissipated) = (walk.area, walk.relays_state.dissipated());
    corners.iter().for_each(|&edge| walk.to(edge));
    let lost = walk.relays_state.dissipated() - dissipated;
    (walk.area - area) / lost - 1.0
}
