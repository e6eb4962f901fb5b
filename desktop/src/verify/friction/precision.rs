//! What f32 loses over long random motion.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainwave::friction::{FrictionModel, JointFrictionParams, Slip};

use crate::bounds;
use crate::figure::Figure;
use crate::gear_file::GearFile;
use crate::joint::{CONTROL_PERIOD, gear_params};
use crate::verify::largest;

/// Steps of random motion.
const STEPS: usize = 10_000_000;

/// The wave generator's friction along the same motion in both precisions, as shares of Fc.
pub(super) fn measure() -> Vec<Figure> {
    let file = GearFile::default_gear();
    let (double, single) =
        (gear_params::<f64>(&file).input_friction, gear_params::<f32>(&file).input_friction);
    let product = {
        let step = |params: &JointFrictionParams<f64>| params.build(CONTROL_PERIOD);
        let step32 = |params: &JointFrictionParams<f32>| params.build(CONTROL_PERIOD as f32);
        worst(&step(&double).expect("the default gear"), &step32(&single).expect("the default gear"))
    };
    let passive = worst(
        &double.build_passive().expect("the default gear"),
        &single.build_passive().expect("the default gear"),
    );
    vec![
        bounds::figure("friction.f32", product / double.coulomb),
        bounds::figure("friction.passive.f32", passive / double.coulomb),
    ]
}

fn worst(double: &impl FrictionModel<f64>, single: &impl FrictionModel<f32>) -> f64 {
    let (mut double_state, mut single_state) = Default::default();
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut velocity = 0.0f32;
    largest((0..STEPS).map(|_| {
        velocity = 0.999 * velocity + random.random_range(-1.0..1.0f32);
        let exact = double.step(&mut double_state, &Slip::new(f64::from(velocity), CONTROL_PERIOD)).force;
        let rounded = single.step(&mut single_state, &Slip::new(velocity, CONTROL_PERIOD as f32)).force;
        (f64::from(rounded) - exact).abs()
    }))
}
