//! Error of a full memory: a ring-down with four times as many reversals as it stores, and the motion out of it.

use strainwave::compensator::HYSTERESIS_MEMORY;
use strainwave::hysteresis::{Staircase, StaircaseState, Weights};

use super::history::{LEVELS, Model, standard};
use crate::io::figure::Figure;
use crate::verify::bounds;
use crate::verify::largest;

/// Left of the amplitude after every half cycle: a damping ratio of 0.02.
const DECAY: f64 = 0.94;
/// Places of the way out.
const PLACES: i32 = 2000;

pub(super) fn measure() -> Vec<Figure> {
    let bound = bound();
    vec![
        bounds::figure("hysteresis.full_memory.error", largest([1.0, -1.0].map(error))),
        bounds::figure("hysteresis.full_memory.error_bound", bound),
    ]
}

/// Largest difference from a memory that holds all, as a fraction of the output at saturation.
fn error(side: f64) -> f64 {
    let weights = Weights::uniform(1.0).expect("the weight is in range");
    let whole = Staircase::<f64, LEVELS, { 5 * HYSTERESIS_MEMORY }>::build(1.0, &weights).expect("as this");
    let (model, mut state, mut whole_state) = (standard(), Default::default(), StaircaseState::default());
    let mut step = |input| model.step(&mut state, input).output - whole.step(&mut whole_state, input).output;
    for k in 0..4 * HYSTERESIS_MEMORY as i32 {
        step((-DECAY).powi(k));
    }
    largest((0..=PLACES).map(|k| step(side * f64::from(k) / f64::from(PLACES))))
}

/// Bound of the error: the output change over the smallest loop that is always kept.
fn bound() -> f64 {
    let model: Model<f64> = standard();
    let mut state = Default::default();
    // The first of the memory is the demagnetised past; the last three may be forgotten.
    let kept = HYSTERESIS_MEMORY as i32 - 4;
    let outputs: Vec<f64> = (0..=kept).map(|k| model.step(&mut state, (-DECAY).powi(k)).output).collect();
    let [.., before, last] = outputs[..] else { return f64::NAN };
    (last - before).abs()
}
