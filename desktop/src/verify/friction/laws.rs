//! A law that holds on any input: the path alone counts.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainwave::Error;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::friction::any::closed_motions;
use strainwave::friction::{ClosedMotionTest, ForceOverPath, FrictionModel, Slip};

use crate::io::figure::Figure;
use crate::verify::bounds;
use crate::verify::largest;

const LEVEL: f64 = 2.0;
const EPS: f64 = 0.02;
/// Steps of random motion.
const STEPS: usize = 100_000;

pub(super) fn measure() -> Vec<Figure> {
    let mut worst = OffRate(0.0);
    closed_motions(LEVEL, EPS, &mut worst);
    vec![bounds::figure("friction.rate_independence", worst.0)]
}

/// Largest effect of the rate on a registered model whose force depends on the path alone.
struct OffRate(f64);

impl ClosedMotionTest<f64> for OffRate {
    fn run<M: FrictionModel<f64>>(&mut self, model: Result<M, Error>, _: ForceOverPath) {
        if M::RATE_INDEPENDENT {
            self.0 = largest([self.0, off_rate(&model.expect("its parameters are in range"))]);
        }
    }
}

/// A random motion whose steps are from 1e-6 to 10 eps long.
fn motion() -> Vec<Slip<f64>> {
    let mut random = ChaCha8Rng::seed_from_u64(2);
    let mut slip = || {
        let way = EPS * 10f64.powf(random.random_range(-6.0..1.0));
        Slip::new(if random.random() { way / CONTROL_PERIOD } else { -way / CONTROL_PERIOD }, CONTROL_PERIOD)
    };
    (0..STEPS).map(|_| slip()).collect()
}

/// Largest difference of a model's forces over two motions, as a fraction of the level.
fn difference<M: FrictionModel<f64>>(model: &M, one: &[Slip<f64>], other: &[Slip<f64>]) -> f64 {
    let (mut state_one, mut state_other) = (M::State::default(), M::State::default());
    let pairs = one.iter().zip(other);
    largest(pairs.map(|(slip, other)| {
        (model.step(&mut state_one, slip).force - model.step(&mut state_other, other).force).abs() / LEVEL
    }))
}

/// The same path ten times as fast, and ten times as slowly.
fn off_rate(model: &impl FrictionModel<f64>) -> f64 {
    let motion = motion();
    largest([10.0, 0.1].map(|rate| {
        let faster = |slip: &Slip<f64>| Slip::new(slip.velocity * rate, slip.duration.seconds() / rate);
        difference(model, &motion, &motion.iter().map(faster).collect::<Vec<_>>())
    }))
}
