//! Operators and inputs at random.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use strainwave::Real;
use strainwave::compensator::{HYSTERESIS_LEVELS, HYSTERESIS_MEMORY};
use strainwave::hysteresis::{Staircase, StaircaseState, Weights};

/// Levels of the real-time build.
pub const LEVELS: usize = HYSTERESIS_LEVELS;
/// The operator of the real-time build in either precision, inputs -1 to 1.
pub type Model<R> = Staircase<R, LEVELS, HYSTERESIS_MEMORY>;
/// Its state.
pub type State<R> = StaircaseState<R, HYSTERESIS_MEMORY>;

/// Even weights, 1 at saturation.
pub fn standard<R: Real>() -> Model<R> {
    let weights = Weights::uniform(R::ONE).expect("the weight is in range");
    Staircase::build(R::ONE, &weights).expect("the range is positive")
}

/// Random weights, none below zero, 1 at saturation.
pub fn random_weights<const L: usize>(random: &mut ChaCha8Rng) -> Weights<f64, L> {
    let mut table = [[0.0; L]; L];
    for i in 0..L {
        for j in 0..=i.min(L - 1 - i) {
            table[i][j] = random.random_range(0.0..1.0);
            table[L - 1 - j][L - 1 - i] = table[i][j];
        }
    }
    let total: f64 = table.iter().flatten().sum();
    Weights::from_fn(|i, j| table[i][j] / total).expect("the weights are symmetric")
}

/// An operator of random weights.
pub fn at_random(random: &mut ChaCha8Rng) -> Model<f64> {
    Staircase::build(1.0, &random_weights(random)).expect("the range is positive")
}

/// Up to `most` inputs within +-1.
pub fn inputs(random: &mut ChaCha8Rng, most: usize) -> Vec<f64> {
    let count = random.random_range(1..=most);
    (0..count).map(|_| random.random_range(-1.0..=1.0)).collect()
}

/// The outputs along `inputs` from a demagnetised start, and the state there.
pub fn run<R: Real>(model: &Model<R>, inputs: impl IntoIterator<Item = f64>) -> (State<R>, Vec<f64>) {
    let mut state = StaircaseState::default();
    let outputs = inputs.into_iter().map(|input| model.step(&mut state, R::lit(input)).output.to_f64());
    let outputs = outputs.collect();
    (state, outputs)
}
