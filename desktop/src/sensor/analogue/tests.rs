//! Laws of the analogue path, and its statistics within derived bounds.

use std::f64::consts::TAU;

use proptest::prelude::*;
use rand::SeedableRng;

use super::*;

const DT: f64 = 1e-4;
const SAMPLES: usize = 100_000;

fn random(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

fn readings(params: AnalogueParams, seed: u64, truth: impl Fn(usize) -> f64) -> Vec<f64> {
    let (path, mut state, mut random) = (params.build(DT).unwrap(), AnalogueState::default(), random(seed));
    (0..SAMPLES).map(|k| path.step(&mut state, truth(k), &mut random)).collect()
}

fn mean(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().sum::<f64>() / SAMPLES as f64
}

/// Mean, variance and correlation of neighbours of n normal samples deviate by sigma/sqrt(n), sqrt(2/n) and 1/sqrt(n): four of each.
#[test]
fn noise_is_white_and_as_large_as_its_density_says() {
    let (density, n) = (2e-3, SAMPLES as f64);
    let deviation = density * (0.5 / DT).sqrt();
    for seed in 1..=5 {
        let found = readings(
            AnalogueParams { noise: Noise::Density(density), ..AnalogueParams::IDEAL },
            seed,
            |_| 0.0,
        );
        let variance = mean(found.iter().map(|x| x * x));
        assert!(mean(found.iter().copied()).abs() < 4.0 * deviation / n.sqrt());
        assert!((variance / deviation.powi(2) - 1.0).abs() < 4.0 * (2.0 / n).sqrt(), "{variance}");
        let neighbours = mean(found.windows(2).map(|pair| pair[0] * pair[1])) / variance;
        assert!(neighbours.abs() < 4.0 / n.sqrt(), "{neighbours}");
    }
}

/// Half of the step is the same density: sqrt(2) times the deviation.
#[test]
fn a_density_is_the_same_noise_in_one_hertz_at_any_rate() {
    let noise = |dt: f64| {
        let path = AnalogueParams { noise: Noise::Density(1.0), ..AnalogueParams::IDEAL }.build(dt).unwrap();
        path.step(&mut AnalogueState::default(), 0.0, &mut random(3))
    };
    assert!((noise(0.5 * DT) / noise(DT) - 2f64.sqrt()).abs() < 1e-12);
}

/// 1000 drifts of a second, the time constant 2 s: variances within four of their deviations, sqrt(2/1000) of them.
#[test]
fn drift_starts_at_zero_and_spreads_as_its_equation_says() {
    let params = AnalogueParams { drift: DriftParams { deviation: 0.5, time: 2.0 }, ..AnalogueParams::IDEAL };
    let path = params.build(0.01).unwrap();
    let mut variances = [0.0; 3];
    for seed in 0..1000 {
        let (mut state, mut random) = (AnalogueState::default(), random(seed));
        let drift: Vec<f64> = (0..800).map(|_| path.step(&mut state, 0.0, &mut random)).collect();
        for (variance, at) in variances.iter_mut().zip([10, 200, 800]) {
            *variance += drift[at - 1].powi(2) / 1000.0;
        }
    }
    for (variance, time) in variances.into_iter().zip([0.1, 2.0, 8.0_f64]) {
        let expected = 0.25 * (1.0 - (-time).exp());
        assert!(
            (variance / expected - 1.0).abs() < 4.0 * (0.002_f64).sqrt(),
            "{time}: {variance} {expected}"
        );
    }
}

/// Samples 0.1 ms apart join a sine linearly, which takes sinc^2(f*dt) of it: 3e-4 of 1 at 100 Hz.
#[test]
fn at_the_bandwidth_the_amplitude_is_three_decibels_lower() {
    let frequency = 100.0;
    let params = AnalogueParams { bandwidth: Some(frequency), gain: 2.0, ..AnalogueParams::IDEAL };
    let found = readings(params, 1, |k| (TAU * frequency * k as f64 * DT).sin());
    let settled = &found[SAMPLES / 2..];
    let square = settled.iter().map(|x| x * x).sum::<f64>() / settled.len() as f64;
    assert!((square - 1.0).abs() < 1e-3, "{square}");
}

#[test]
fn what_is_out_of_range_is_named() {
    let good = AnalogueParams::IDEAL;
    for (params, name) in [
        (AnalogueParams { gain: f64::NAN, ..good }, "gain"),
        (AnalogueParams { offset: f64::INFINITY, ..good }, "offset"),
        (AnalogueParams { drift: DriftParams { deviation: 1.0, time: 0.0 }, ..good }, "drift_time"),
        (AnalogueParams { drift: DriftParams { deviation: -1.0, time: 1.0 }, ..good }, "drift"),
        (AnalogueParams { bandwidth: Some(0.0), ..good }, "bandwidth"),
        (AnalogueParams { noise: Noise::Rms(-1.0), ..good }, "noise"),
        (AnalogueParams { noise: Noise::Density(f64::NAN), ..good }, "noise"),
        (AnalogueParams { range: Some(0.0), ..good }, "range"),
        (AnalogueParams { resolution: -1.0, ..good }, "resolution"),
    ] {
        assert_eq!(params.build(DT).err(), Some(Error::OutOfRange(name)));
    }
    assert_eq!(good.build(0.0).err(), Some(Error::OutOfRange("dt")));
}

proptest! {
    /// Bit for bit, and no random number is drawn.
    #[test]
    fn an_ideal_path_reads_the_truth(truth in prop::num::f64::NORMAL) {
        let path = AnalogueParams::IDEAL.build(DT).unwrap();
        let mut drawn = random(1);
        prop_assert_eq!(path.step(&mut AnalogueState::default(), truth, &mut drawn).to_bits(), truth.to_bits());
        prop_assert_eq!(drawn, random(1));
    }

    /// Within the range, on the grid of counts, half a count from what it would be without.
    #[test]
    fn a_reading_is_limited_and_rounded(truth in -1e3..1e3, noise in 0.0..10.0, resolution in 0.01..1.0, seed: u64) {
        let fine = AnalogueParams { noise: Noise::Rms(noise), ..AnalogueParams::IDEAL };
        let coarse = AnalogueParams { resolution, ..fine };
        let limited = AnalogueParams { range: Some(50.0), ..coarse };
        let [fine, coarse, limited] = [fine, coarse, limited].map(|params| {
            params.build(DT).unwrap().step(&mut AnalogueState::default(), truth, &mut random(seed))
        });
        prop_assert!((coarse - fine).abs() <= 0.5001 * resolution);
        prop_assert!((coarse / resolution - (coarse / resolution).round()).abs() < 1e-9);
        prop_assert_eq!(limited, coarse.clamp(-50.0, 50.0));
    }

    /// Without noise: zero in, zero out; twice in, twice out.
    #[test]
    fn it_is_linear_and_at_rest_zero(truths in prop::collection::vec(-1e3..1e3, 1..50), bandwidth in 1.0..5000.0) {
        let path = AnalogueParams { bandwidth: Some(bandwidth), gain: 1.3, ..AnalogueParams::IDEAL }.build(DT).unwrap();
        let run = |factor: f64| -> Vec<f64> {
            let (mut state, mut random) = (AnalogueState::default(), random(1));
            truths.iter().map(|truth| path.step(&mut state, factor * truth, &mut random)).collect()
        };
        prop_assert!(run(0.0).iter().all(|reading| *reading == 0.0));
        prop_assert!(run(2.0).iter().zip(run(1.0)).all(|(twice, once)| *twice == 2.0 * once));
    }

    /// Any input bits give a finite reading.
    #[test]
    fn any_input_is_total(bits in prop::collection::vec(any::<u64>(), 1..20)) {
        let params = AnalogueParams {
            bandwidth: Some(300.0),
            noise: Noise::Density(1e-3),
            drift: DriftParams { deviation: 1.0, time: 1.0 },
            resolution: 0.1,
            range: Some(1e6),
            ..AnalogueParams::IDEAL
        };
        let (path, mut state, mut random) = (params.build(DT).unwrap(), AnalogueState::default(), random(1));
        for bits in bits {
            prop_assert!(path.step(&mut state, f64::from_bits(bits), &mut random).is_finite());
        }
    }
}
