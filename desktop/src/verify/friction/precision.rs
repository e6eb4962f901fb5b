//! Error of f32 over long random motion.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainwave::friction::{
    FrictionModel, FrictionParams, Harmonics, JointFrictionParams, LoadFactors, RippleParams, Slip,
};
use strainwave::{Heading, Real};

use crate::design::joint::firmware_gear_params;
use crate::io::figure::Figure;
use crate::io::gear_file::GearFile;
use crate::verify::bounds;
use crate::verify::largest;
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Steps of random motion.
const STEPS: usize = 10_000_000;

/// The wave generator's friction along the same motion in both precisions, with everything on, as a fraction of Fc.
pub(super) fn measure() -> Vec<Figure> {
    let (double, single) = (everything::<f64>(), everything::<f32>());
    let difference = worst(&double.build().expect("in range"), &single.build().expect("in range"));
    vec![bounds::figure("friction.f32", difference / double.forward.coulomb)]
}

/// The default gear's, its level moving with load and angle.
fn everything<R: Real>() -> JointFrictionParams<R> {
    let default =
        firmware_gear_params::<R>(&GearFile::default_gear()).expect("the default gear").input_friction;
    let harmonics = |a, b| Harmonics { mean: R::ONE, cosines: [a, b].map(R::lit), sines: [b, a].map(R::lit) };
    JointFrictionParams {
        load: LoadFactors { driving: R::lit(0.08), driven: R::lit(0.12) },
        ripple: RippleParams { forward: harmonics(0.2, 0.1), backward: harmonics(0.1, -0.15) },
        ..default
    }
}

/// Speeds to some 30 rad/s, loads to some 0.7 N m, every angle.
fn worst(double: &impl FrictionModel<f64>, single: &impl FrictionModel<f32>) -> f64 {
    let (mut double_state, mut single_state) = Default::default();
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let (mut velocity, mut load, mut phase) = (0.0f32, 0.0f32, 0u32);
    largest((0..STEPS).map(|_| {
        velocity = 0.999 * velocity + random.random_range(-1.0..1.0f32);
        load = 0.999 * load + random.random_range(-0.03..0.03f32);
        phase = phase.wrapping_add(random.random_range(0..1 << 20));
        let exact = Slip {
            wave_generator: Heading::of_phase(phase),
            ..Slip::new(f64::from(velocity), CONTROL_PERIOD).under(0.0, f64::from(load))
        };
        let rounded = Slip {
            wave_generator: Heading::of_phase(phase),
            ..Slip::new(velocity, CONTROL_PERIOD as f32).under(0.0, load)
        };
        let force = f64::from(single.step(&mut single_state, &rounded).force);
        (force - double.step(&mut double_state, &exact).force).abs()
    }))
}
