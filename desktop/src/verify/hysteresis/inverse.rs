//! The operator after its inverse, and the inverse after the operator, on random histories.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainwave::Real;
use strainwave::compensator::HYSTERESIS_MEMORY;
use strainwave::flexspline::stiffness_line::StiffnessLine;
use strainwave::hysteresis::{TorsionHysteresis, TorsionHysteresisState};

use super::default_gear::{hysteresis, line};
use super::history::{LEVELS, Model, inputs, run, standard};
use crate::io::figure::Figure;
use crate::verify::bounds;
use crate::verify::largest;

/// Histories, and places of each.
const HISTORIES: usize = 1000;
const PLACES: usize = 50;

pub(super) fn measure() -> Vec<Figure> {
    let [after_64, before_64] = worst(&standard::<f64>());
    let [after_32, before_32] = worst(&standard::<f32>());
    vec![
        bounds::figure("hysteresis.forward_after_inverse.f64", after_64),
        bounds::figure("hysteresis.inverse_after_forward.f64", before_64),
        bounds::figure("hysteresis.forward_after_inverse.f32", after_32),
        bounds::figure("hysteresis.inverse_after_forward.f32", before_32),
        bounds::figure("hysteresis.torque_after_torsion.f64", torque_after_torsion::<f64>()),
        bounds::figure("hysteresis.torque_after_torsion.f32", torque_after_torsion::<f32>()),
    ]
}

/// Distance of the output from the target, and of the input found from the one that was, as fractions of their spans.
fn worst<R: Real>(model: &Model<R>) -> [f64; 2] {
    let inverse = model.inverse().expect("even weights rise");
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut places = Vec::new();
    for _ in 0..HISTORIES {
        let (state, _) = run(model, inputs(&mut random, 40));
        for _ in 0..PLACES {
            let fraction: f64 = random.random_range(-1.0..1.0);
            let output = |input| model.peek(&state, input).output;
            let residual = output(inverse.input(&state, R::lit(fraction))) - R::lit(fraction);
            let moved = inverse.input(&state, output(R::lit(fraction))) - R::lit(fraction);
            places.push([0.5 * residual.to_f64(), 0.5 * moved.to_f64()]);
        }
    }
    [0, 1].map(|k| largest(places.iter().map(|place| place[k])))
}

/// Distance of the torque through the default gear's line and hysteresis from the target, as a fraction of twice the
/// rated torque.
fn torque_after_torsion<R: Real>() -> f64 {
    let line: StiffnessLine<R> = line();
    let model: TorsionHysteresis<R, LEVELS, HYSTERESIS_MEMORY> = hysteresis();
    let inverse = model.inverse(&line).expect("the line is stiffer than the loop");
    let rated = super::default_gear::rated_torque();
    let mut random = ChaCha8Rng::seed_from_u64(9);
    largest((0..HISTORIES).map(|_| {
        let mut state = TorsionHysteresisState::default();
        for fraction in inputs(&mut random, 40) {
            model.step(&mut state, line.torsion(R::lit(rated * fraction)));
        }
        largest((0..PLACES).map(|_| {
            let torque = R::lit(rated * random.random_range(-1.2..1.2));
            let torsion = inverse.torsion(&state, torque);
            let found = line.torque(torsion) + model.peek(&state, torsion).torque;
            (found - torque).to_f64() / (2.0 * rated)
        }))
    }))
}
