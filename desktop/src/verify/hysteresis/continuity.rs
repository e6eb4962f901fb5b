//! Continuity: change of the output for a millionth of the input's span, anywhere along random histories.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainwave::Real;

use super::history::{Model, inputs, run, standard};
use crate::io::figure::Figure;
use crate::verify::bounds;
use crate::verify::largest;

/// Histories, and places of each.
const HISTORIES: usize = 1000;
const PLACES: usize = 50;
/// Of the input, whose span is 2.
const STEP: f64 = 2e-6;

pub(super) fn measure() -> Vec<Figure> {
    vec![
        bounds::figure("hysteresis.continuity.f64", worst(&standard::<f64>())),
        bounds::figure("hysteresis.continuity.f32", worst(&standard::<f32>())),
    ]
}

/// As a fraction of the output's span.
fn worst<R: Real>(model: &Model<R>) -> f64 {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    largest((0..HISTORIES).map(|_| {
        let (state, _) = run(model, inputs(&mut random, 25));
        largest((0..PLACES).map(|_| {
            let input = random.random_range(-1.0..1.0 - STEP);
            let output = |input| model.peek(&state, R::lit(input)).output.to_f64();
            0.5 * (output(input + STEP) - output(input))
        }))
    }))
}
