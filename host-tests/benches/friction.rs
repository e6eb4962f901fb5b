//! Time of one step of friction, f64, one core: Dahl, Bliman-Sorine of order 2, LuGre, and the gear's block.
//!
//! Along random motion of 4096 steps from presliding to fast sliding, both ways, over and over: no branch
//! is always taken.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::friction::{
    BlimanSorine, DahlParams, FrictionModel, FrictionParams, LuGreParams, LubricatedContactParams, Slip,
    StateSpaceParams,
};
use strainwave_desktop::GearFile;
use strainwave_desktop::design::joint::firmware_gear_params;

const STEPS: usize = 4096;
const EPS: f64 = 0.02;

/// Velocities (rad/s) of a linear congruential sequence, smoothed.
fn motion() -> Vec<Slip<f64>> {
    let (mut seed, mut velocity) = (1u32, 0.0);
    let mut slip = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        velocity = 0.9 * velocity + f64::from(seed.cast_signed()) / f64::from(1 << 28);
        Slip::new(velocity, CONTROL_PERIOD)
    };
    (0..STEPS).map(|_| slip()).collect()
}

fn step<M: FrictionModel<f64>>(criterion: &mut Criterion, name: &str, model: &M) {
    let motion = motion();
    let mut group = criterion.benchmark_group("friction");
    group.throughput(Throughput::Elements(STEPS as u64));
    group.bench_function(name, |bencher| {
        bencher.iter(|| {
            // Local, so that it stays in registers as it does in a loop over a log.
            let mut state = M::State::default();
            for slip in &motion {
                black_box(model.step(&mut state, slip).force);
            }
        });
    });
    group.finish();
}

fn steps(criterion: &mut Criterion) {
    let dahl = DahlParams { coulomb: 1.0, stiffness: 1.0 / EPS, exponent: 1.0 };
    step(criterion, "dahl", &dahl.build().expect("the level is in range"));
    let order_2 = BlimanSorine::order_2(1.5, 0.5, EPS, 0.3).expect("the levels are in range");
    step(criterion, "bliman_sorine_2", &order_2);
    let rates = [-1.0 / (0.3 * EPS), -1.0 / EPS];
    let a = [[rates[0], 0.0], [0.0, rates[1]]];
    let general = StateSpaceParams { a, b: [-1.5 * rates[0], 0.5 * rates[1]], c: [1.0, 1.0] };
    step(criterion, "state_space_2", &general.build().expect("the system is stable and dissipative"));
    let contact = LubricatedContactParams {
        coulomb: 1.0,
        static_level: 1.5,
        stribeck_velocity: 2.0,
        stribeck_exponent: 2.0,
        viscous: 0.4,
    };
    let lugre = LuGreParams { contact, stiffness: 1.0 / EPS, damping: 0.01 };
    step(criterion, "lugre", &lugre.build().expect("the levels are in range"));
    let gear = firmware_gear_params::<f64>(&GearFile::default_gear()).expect("the default gear");
    step(criterion, "joint", &gear.input_friction.build().expect("the default gear can be built"));
}

criterion_group!(benches, steps);
criterion_main!(benches);
