//! A step of friction along random motion from presliding to fast sliding, both ways: no branch is always taken.

use std::hint::black_box;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainwave::friction::{BlimanSorine, FrictionModel, FrictionParams, Slip};
use strainwave::{Error, Real};

use super::{Kernel, floor};
use crate::design::joint::firmware_gear_params;
use crate::io::gear_file::GearFile;
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Steps of a pass.
const STEPS: usize = 4096;

pub(super) fn kernels(file: &GearFile) -> Result<Vec<Kernel>, Error> {
    let order_2 = BlimanSorine::order_2(1.5, 0.5, 0.02, 0.3)?;
    let joint = firmware_gear_params::<f32>(file)?.input_friction.build()?;
    Ok(vec![kernel::<f64, _>("friction.order_2", order_2), kernel::<f32, _>("friction.joint", joint)])
}

fn kernel<R: Real, M: FrictionModel<R> + 'static>(name: &'static str, model: M) -> Kernel {
    let slips = motion::<R>();
    Kernel::new(name, floor::NAME, STEPS, move || {
        // Local, so that it stays in registers as it does in a loop over a log.
        let mut state = M::State::default();
        for slip in &slips {
            black_box(model.step(&mut state, slip).force);
        }
    })
}

/// Speeds to some 20 rad/s.
fn motion<R: Real>() -> Vec<Slip<R>> {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut velocity = 0.0;
    let mut slip = || {
        velocity = 0.9 * velocity + random.random_range(-8.0..8.0);
        Slip::new(R::lit(velocity), R::lit(CONTROL_PERIOD))
    };
    (0..STEPS).map(|_| slip()).collect()
}
