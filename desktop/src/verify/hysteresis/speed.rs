//! Cost of the operator on this machine, one core, by the clock: the best of many short batches.
//!
//! Three tones of 10 to 120 Hz at 10 kHz, 1024 samples with minor loops in minor loops: the same for every number of
//! levels, and for the relays of eq. (9) in the same run. A desktop's processor predicts the reversals of such an input;
//! at random reversals a sample takes about twice as long. Other work on the machine, and another machine, make them
//! slower: the time is reported; judged is its ratio to that of the relays.

use std::f64::consts::TAU;
use std::hint::black_box;

use strainwave::hysteresis::{Relays, RelaysState, Staircase, StaircaseState, Weights};

use crate::io::figure::Figure;
use crate::verify::bounds;
use crate::verify::{Measured, fastest};

/// Batches, and samples of one.
const BATCHES: usize = 10_000;
const SAMPLES: usize = 1024;
/// Batches of the relays, which take a hundred times as long.
const RELAY_BATCHES: usize = 100;

/// The figures of the clock.
pub fn measure() -> Measured {
    let inputs = inputs();
    let slowest = [
        staircase::<8>(&inputs),
        staircase::<16>(&inputs),
        staircase::<24>(&inputs),
        staircase::<32>(&inputs),
        staircase::<64>(&inputs),
    ];
    let fifty = staircase::<50>(&inputs);
    let slowest = slowest.into_iter().fold(fifty, f64::max);
    Measured::from(vec![
        Figure::reported("hysteresis.sample", slowest, "ns"),
        bounds::figure("hysteresis.50.relays_over_staircase", relays::<50>(&inputs) / fifty),
    ])
}

/// Amplitude and cycles of each tone.
const TONES: [(f64, f64); 3] = [(0.5, 1.0), (0.3, 4.0), (0.2, 12.0)];

/// Their sum, within +-1.
fn inputs() -> Vec<f64> {
    let input = |k: usize| {
        let time = TAU * k as f64 / SAMPLES as f64;
        TONES.iter().map(|(amplitude, cycles)| amplitude * (cycles * time).sin()).sum()
    };
    (0..SAMPLES).map(input).collect()
}

fn weights<const L: usize>() -> Weights<f64, L> {
    Weights::uniform(1.0).expect("the weight is in range")
}

/// Time of a sample (ns).
fn staircase<const L: usize>(inputs: &[f64]) -> f64 {
    let model = Staircase::<f64, L, 28>::build(1.0, &weights()).expect("the range is positive");
    let mut state = StaircaseState::default();
    best(BATCHES, inputs, |input| model.step(&mut state, input).output)
}

fn relays<const L: usize>(inputs: &[f64]) -> f64 {
    let model = Relays::<f64, L>::build(1.0, &weights()).expect("the range is positive");
    let mut state = RelaysState::default();
    best(RELAY_BATCHES, inputs, |input| model.step(&mut state, input))
}

/// Time of a step (ns), the best of `batches`.
fn best(batches: usize, inputs: &[f64], mut step: impl FnMut(f64) -> f64) -> f64 {
    let best = fastest(batches, || {
        for input in inputs {
            black_box(step(*input));
        }
    });
    best * 1e9 / inputs.len() as f64
}
