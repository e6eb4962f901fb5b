//! Time of one sample of hysteresis, one core: the staircase at 8 to 64 levels in f64 and f32, its inverse, and the
//! relays of eq. (9) at 50 levels.
//!
//! Along 1024 samples of three tones of 10 to 120 Hz at 10 kHz, with minor loops in minor loops, over and over.

use std::f64::consts::TAU;
use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use strainwave::Real;
use strainwave::hysteresis::{Relays, RelaysState, Staircase, StaircaseState, Weights};

const SAMPLES: usize = 1024;
const MEMORY: usize = 28;

fn inputs<R: Real>() -> Vec<R> {
    let tones = [(0.5, 1.0), (0.3, 4.0), (0.2, 12.0)];
    let input = |k: usize| {
        let time = TAU * k as f64 / SAMPLES as f64;
        tones.iter().map(|(amplitude, cycles)| amplitude * (cycles * time).sin()).sum()
    };
    (0..SAMPLES).map(|k| R::lit(input(k))).collect()
}

fn model<R: Real, const L: usize>() -> Staircase<R, L, MEMORY> {
    let weights = Weights::uniform(R::ONE).expect("the weight is in range");
    Staircase::build(R::ONE, &weights).expect("the range is positive")
}

fn run<R: Real>(criterion: &mut Criterion, name: &str, mut step: impl FnMut(R) -> R) {
    let inputs = inputs::<R>();
    let mut group = criterion.benchmark_group("hysteresis");
    group.throughput(Throughput::Elements(SAMPLES as u64));
    group.bench_function(name, |bencher| {
        bencher.iter(|| {
            for input in &inputs {
                black_box(step(*input));
            }
        });
    });
    group.finish();
}

fn staircase<R: Real, const L: usize>(criterion: &mut Criterion, precision: &str) {
    let (model, mut state) = (model::<R, L>(), StaircaseState::default());
    run(criterion, &format!("staircase_{L}_{precision}"), |input| model.step(&mut state, input).output);
}

fn inverse<R: Real>(criterion: &mut Criterion, precision: &str) {
    let (model, mut state) = (model::<R, 24>(), StaircaseState::default());
    let inverse = model.inverse().expect("even weights rise");
    run(criterion, &format!("inverse_24_{precision}"), |output| {
        let input = inverse.input(&state, output);
        model.step(&mut state, input);
        input
    });
}

fn relays(criterion: &mut Criterion) {
    let weights = Weights::uniform(1.0).expect("the weight is in range");
    let model = Relays::<f64, 50>::build(1.0, &weights).expect("the range is positive");
    let mut state = RelaysState::default();
    run(criterion, "relays_50_f64", |input| model.step(&mut state, input));
}

fn samples(criterion: &mut Criterion) {
    staircase::<f64, 8>(criterion, "f64");
    staircase::<f64, 16>(criterion, "f64");
    staircase::<f64, 24>(criterion, "f64");
    staircase::<f64, 50>(criterion, "f64");
    staircase::<f64, 64>(criterion, "f64");
    staircase::<f32, 8>(criterion, "f32");
    staircase::<f32, 24>(criterion, "f32");
    staircase::<f32, 64>(criterion, "f32");
    inverse::<f64>(criterion, "f64");
    inverse::<f32>(criterion, "f32");
    relays(criterion);
}

criterion_group!(benches, samples);
criterion_main!(benches);
