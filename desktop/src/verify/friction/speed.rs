//! Cost of a step of Bliman-Sorine friction of order 2 on this machine, one thread, f64.
//!
//! By the clock, the best of many short batches along random motion from presliding to fast sliding, both
//! ways. Other work on the machine, and another machine, make it slower: it is reported, not judged.

use std::hint::black_box;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainwave::friction::bliman_sorine::BlimanSorineState;
use strainwave::friction::{BlimanSorine, FrictionModel, Slip};

use crate::io::figure::Figure;
use crate::verify::{Measured, fastest};
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Batches, and steps of one: some 16 us, which are seldom interrupted.
const BATCHES: usize = 5000;
const STEPS: usize = 4096;

/// The figure of the clock.
pub fn measure() -> Measured {
    let model = BlimanSorine::order_2(1.5, 0.5, 0.02, 0.3).expect("the levels are in range");
    let slips = motion();
    let best = fastest(BATCHES, || {
        // Local, so that it stays in registers as it does in a loop over a log.
        let mut state = BlimanSorineState::default();
        for slip in &slips {
            black_box(model.step(&mut state, slip).force);
        }
    });
    vec![Figure::reported("friction.order_2.step", best * 1e9 / STEPS as f64, "ns")].into()
}

/// Speeds to some 20 rad/s.
fn motion() -> Vec<Slip<f64>> {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut velocity = 0.0;
    let mut slip = || {
        velocity = 0.9 * velocity + random.random_range(-8.0..8.0);
        Slip::new(velocity, CONTROL_PERIOD)
    };
    (0..STEPS).map(|_| slip()).collect()
}
