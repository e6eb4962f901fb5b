//! Laws that hold on any input: order 1 is Dahl's model, and the path alone counts.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::friction::{BlimanSorine, DahlParams, FrictionModel, Slip, StateSpaceParams};

use crate::io::figure::Figure;
use crate::verify::bounds;
use crate::verify::largest;

const LEVEL: f64 = 2.0;
const EPS: f64 = 0.02;
/// Steps of random motion.
const STEPS: usize = 100_000;

pub(super) fn measure() -> Vec<Figure> {
    vec![
        bounds::figure("friction.order_1_is_dahl", off_dahl()),
        bounds::figure(
            "friction.rate_independence",
            largest([dahl_off_rate(), order_2_off_rate(), general_off_rate()]),
        ),
    ]
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

/// Largest difference of the two models' forces over a motion each, as a fraction of the level.
fn difference<A: FrictionModel<f64>, B: FrictionModel<f64>>(
    (a, along_a): (&A, &[Slip<f64>]),
    (b, along_b): (&B, &[Slip<f64>]),
) -> f64 {
    let (mut state_a, mut state_b) = (A::State::default(), B::State::default());
    let pairs = along_a.iter().zip(along_b);
    largest(pairs.map(|(slip_a, slip_b)| {
        (a.step(&mut state_a, slip_a).force - b.step(&mut state_b, slip_b).force).abs() / LEVEL
    }))
}

fn off_dahl() -> f64 {
    let order_1 = BlimanSorine::order_1(LEVEL, EPS).expect("the level is in range");
    let dahl = DahlParams { coulomb: LEVEL, stiffness: LEVEL / EPS, exponent: 1.0 };
    let dahl = dahl.build().expect("the level is in range");
    difference((&order_1, &motion()), (&dahl, &motion()))
}

/// The same path ten times as fast, and ten times as slowly.
fn off_rate(model: &impl FrictionModel<f64>) -> f64 {
    let motion = motion();
    largest([10.0, 0.1].map(|rate| {
        let faster = |slip: &Slip<f64>| Slip::new(slip.velocity * rate, slip.duration.seconds() / rate);
        difference((model, &motion), (model, &motion.iter().map(faster).collect::<Vec<_>>()))
    }))
}

fn dahl_off_rate() -> f64 {
    let shapes =
        [0.0, 1.0, 2.0].map(|exponent| DahlParams { coulomb: LEVEL, stiffness: LEVEL / EPS, exponent });
    largest(shapes.map(|dahl| off_rate(&dahl.build().expect("the level is in range"))))
}

fn order_2_off_rate() -> f64 {
    off_rate(&BlimanSorine::order_2(1.5 * LEVEL, 0.5 * LEVEL, EPS, 0.3).expect("the levels are in range"))
}

fn general_off_rate() -> f64 {
    let rate = 1.0 / EPS;
    let a = [[-rate, 4.0 * rate], [-4.0 * rate, -2.0 * rate]];
    let params = StateSpaceParams { a, b: [rate, 0.5 * rate], c: [4.5 * LEVEL, 2.25 * LEVEL] };
    off_rate(&params.build().expect("the system is stable and dissipative"))
}
