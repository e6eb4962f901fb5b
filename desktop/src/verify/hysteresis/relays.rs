//! The staircase against the relays of eq. (9) on grid inputs, with random weights.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainwave::hysteresis::{Relays, RelaysState, Staircase, StaircaseState};

use super::history::random_weights;
use crate::io::figure::Figure;
use crate::verify::bounds;
use crate::verify::largest;

/// Random inputs on the grid.
const INPUTS: usize = 1_000_000;

pub(super) fn measure() -> Vec<Figure> {
    vec![
        bounds::figure("hysteresis.8.staircase_against_relays", worst::<8>()),
        bounds::figure("hysteresis.16.staircase_against_relays", worst::<16>()),
        bounds::figure("hysteresis.24.staircase_against_relays", worst::<24>()),
        bounds::figure("hysteresis.50.staircase_against_relays", worst::<50>()),
    ]
}

/// Largest difference of the outputs as a fraction of the total weight.
fn worst<const L: usize>() -> f64 {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let weights = random_weights::<L>(&mut random);
    let relays = Relays::build(1.0, &weights).expect("the range is positive");
    // Nested inputs on a grid of 50 levels turn 50 times at most.
    let staircase = Staircase::<f64, L, 51>::build(1.0, &weights).expect("as the relays");
    let (mut relays_state, mut state) = (RelaysState::default(), StaircaseState::default());
    largest((0..INPUTS).map(|_| {
        let input = relays.edge(random.random_range(0..=L));
        relays.step(&mut relays_state, input) - staircase.step(&mut state, input).output
    }))
}
