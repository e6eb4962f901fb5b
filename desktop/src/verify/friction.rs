//! Friction: exact steps in the path length, and what f32 leaves of them.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainwave::Real;
use strainwave::friction::bliman_sorine::{BlimanSorine, BlimanSorineState};
use strainwave::friction::{JointFriction, JointFrictionState};

use crate::bounds;
use crate::figure::Figure;
use crate::gear_file::GearFile;
use crate::joint::{CONTROL_PERIOD, gear_params};
use crate::verify::largest;

/// Levels and lengths of the measured model: f1, f2, eps, eta.
const MODEL: (f64, f64, f64, f64) = (1.5, 0.5, 0.02, 0.3);
/// Steps of random motion.
const STEPS: usize = 1_000_000;

pub(super) fn measure() -> Vec<Figure> {
    vec![
        bounds::figure("friction.closed_form", worst_against_closed_form()),
        bounds::figure("friction.f32", worst_of_f32()),
    ]
}

/// One-way motion in steps of 1e-6 to 10 eps against F(s) = f1*(1 - e^(-s/(eta*eps))) - f2*(1 - e^(-s/eps)).
fn worst_against_closed_form() -> f64 {
    let (f1, f2, eps, eta) = MODEL;
    let model = BlimanSorine::order_2(f1, f2, eps, eta).expect("the levels are in range");
    let closed = |s: f64| -f1 * (-s / (eta * eps)).exp_m1() + f2 * (-s / eps).exp_m1();
    let mut worst = 0.0;
    for step in [1e-6, 1e-4, 1e-2, 0.3, 1.0, 10.0].map(|share| share * eps) {
        let mut state = BlimanSorineState::default();
        for k in 1..=1000 {
            let force = model.step(&mut state, step).expect("the step is finite");
            let wanted = closed(f64::from(k) * step);
            worst = largest([worst, force / wanted - 1.0]);
        }
    }
    worst
}

/// The wave generator's friction along the same random motion in both precisions, as a share of Fc.
fn worst_of_f32() -> f64 {
    let file = GearFile::default_gear();
    let (double, single) = (input_friction::<f64>(&file), input_friction::<f32>(&file));
    let (mut double_state, mut single_state) = (JointFrictionState::default(), JointFrictionState::default());
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut velocity = 0.0f32;
    let mut worst = 0.0;
    for _ in 0..STEPS {
        velocity = 0.999 * velocity + random.random_range(-1.0..1.0f32);
        let exact = double.step(&mut double_state, f64::from(velocity)).force;
        let rounded = single.step(&mut single_state, velocity).force;
        worst = largest([worst, f64::from(rounded) - exact]);
    }
    worst / file.friction.input.coulomb
}

fn input_friction<R: Real>(file: &GearFile) -> JointFriction<R> {
    gear_params::<R>(file)
        .input_friction
        .build(R::lit(CONTROL_PERIOD))
        .expect("the default gear can be built")
}
