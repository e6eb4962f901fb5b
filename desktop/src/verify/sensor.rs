//! Sensors: statistics of their readings against the words of their datasheets.
//!
//! Every figure is a relative error. What is random is the worst of several seeds, so that it stands near the limits of chance, which its bound is
//! derived from: of n normal samples the deviation is found to 1/sqrt(2*n).

use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use strainwave::Angle;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::gear::Motion;

use super::Measured;
use crate::sensor::{
    AccelerometerParams, AnalogueState, EncoderErrors, EncoderParams, EncoderState, GaugeBridgeParams,
    MotorCurrentParams, TorqueSensorParams, Wave,
};
use crate::verify::{bounds, largest};

const DT: f64 = CONTROL_PERIOD;
const SAMPLES: usize = 100_000;
/// Of what is random.
const SEEDS: u64 = 8;
/// 1/golden ratio: multiples of it, less whole numbers, lie evenly between 0 and 1 however many there are.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// Samples of a periodogram, how many are averaged, and bins of each band.
const WINDOW: usize = 1000;
const WINDOWS: usize = 200;
const BAND: usize = 30;

pub(super) fn measure() -> Measured {
    let figures = vec![
        bounds::figure("sensor.encoder.quantisation", encoder_quantisation()),
        bounds::figure("sensor.encoder.delay", encoder_delay()),
        bounds::figure("sensor.encoder.eccentricity", encoder_eccentricity()),
        bounds::figure("sensor.encoder.jitter", encoder_jitter()),
        bounds::figure("sensor.accelerometer.noise_density", noise_density()),
        bounds::figure("sensor.accelerometer.bandwidth", bandwidth()),
        bounds::figure("sensor.gauge_bridge.output", bridge_output()),
        bounds::figure("sensor.gauge_bridge.drift", bridge_drift()),
        bounds::figure("sensor.torque_sensor.noise", torque_noise()),
        bounds::figure("sensor.motor_current.quantisation", current_quantisation()),
    ];
    Measured::from(figures)
}

fn random(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

/// Root of the mean square.
fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, count) = values.into_iter().fold((0.0, 0.0), |(sum, n), value| (sum + value * value, n + 1.0));
    f64::sqrt(sum / count)
}

/// Angles that the encoder shows less the true ones (rad), the shortest way, of as many samples.
fn encoder_errors(params: &EncoderParams, seed: u64, truth: impl Fn(usize) -> Motion<f64>) -> Vec<f64> {
    let encoder = params.build(DT).expect("the parameters are in range");
    let (mut state, mut random) = (EncoderState::default(), random(seed));
    let error = |k: usize| {
        let motion = truth(k);
        let count = encoder.step(&mut state, motion, &mut random).count;
        let shown = f64::from(count) * TAU / 2f64.powi(params.bits.cast_signed());
        let error = shown - f64::from(motion.angle.phase()) * TAU / 2f64.powi(32);
        error - TAU * (error / TAU).round()
    };
    (0..SAMPLES).map(error).collect()
}

fn at_rest(angle: f64) -> Motion<f64> {
    Motion { angle: Angle::from_radians_f64(angle), velocity: 0.0 }
}

/// Rms of the rounding of angles that lie evenly against a count over sqrt(12).
fn encoder_quantisation() -> f64 {
    let params = EncoderParams::of_bits(17);
    let errors = encoder_errors(&params, 1, |k| at_rest(TAU * (GOLDEN * k as f64).fract()));
    (rms(errors) / (TAU / 2f64.powi(17) / 12f64.sqrt()) - 1.0).abs()
}

/// What the reading lags at constant speed, over that speed, against delays of whole samples and fractions.
fn encoder_delay() -> f64 {
    let speed = 3.0;
    let error = |delay: f64| {
        let params = EncoderParams { delay, ..EncoderParams::of_bits(32) };
        let errors = encoder_errors(&params, 1, |k| Motion {
            angle: Angle::from_radians_f64(speed * DT * k as f64),
            velocity: speed,
        });
        let settled = &errors[SAMPLES / 2..];
        let lag = -settled.iter().sum::<f64>() / settled.len() as f64;
        lag / speed / delay - 1.0
    };
    largest([37e-6, 100e-6, 250e-6, 1e-3].map(error))
}

/// First and second order of the error over a revolution, against the words, of the first amplitude.
fn encoder_eccentricity() -> f64 {
    let waves = [
        Wave { order: 1, amplitude: 1e-3, phase: 0.4 },
        Wave { order: 2, amplitude: 2e-4, phase: -1.0 },
        Wave { order: 2048, amplitude: 9e-6, phase: 0.0 },
    ];
    let params = EncoderParams { errors: EncoderErrors { waves, noise: 0.0 }, ..EncoderParams::of_bits(24) };
    let angle = |k: usize| TAU * k as f64 / SAMPLES as f64;
    let errors = encoder_errors(&params, 1, |k| at_rest(angle(k)));
    let error = |wave: &Wave| {
        let (order, scale) = (f64::from(wave.order), 2.0 / SAMPLES as f64);
        let part = |of: fn(f64) -> f64| {
            scale * errors.iter().enumerate().map(|(k, error)| error * of(order * angle(k))).sum::<f64>()
        };
        let (sine, cosine) = (part(f64::sin), part(f64::cos));
        let (of_cosine, of_sine) = wave.phase.sin_cos();
        (sine - wave.amplitude * of_sine).hypot(cosine - wave.amplitude * of_cosine) / waves[0].amplitude
    };
    largest(waves.iter().map(error))
}

/// Rms at constant speed against speed*jitter/sqrt(3).
fn encoder_jitter() -> f64 {
    let (jitter, velocity) = (2e-6, 300.0);
    let params = EncoderParams { jitter, ..EncoderParams::of_bits(32) };
    let error = |seed| {
        let errors = encoder_errors(&params, seed, |_| Motion { velocity, ..at_rest(1.0) });
        rms(errors) / (velocity * jitter / 3f64.sqrt()) - 1.0
    };
    largest((1..=SEEDS).map(error))
}

/// One-sided density by averaged periodograms in a low, a middle and a high band.
fn noise_density() -> f64 {
    let stated = 2.5e-4;
    let params = AccelerometerParams { noise_density: stated, ..AccelerometerParams::default() };
    let sensor = params.build(DT).expect("the parameters are in range");
    let (mut state, mut random) = (AnalogueState::default(), random(1));
    let mut powers = [0.0; 3];
    for _ in 0..WINDOWS {
        let window: Vec<f64> = (0..WINDOW).map(|_| sensor.step(&mut state, 0.0, &mut random)).collect();
        for (power, first) in powers.iter_mut().zip([1, WINDOW / 4, WINDOW / 2 - BAND]) {
            *power += (first..first + BAND).map(|bin| power_at(&window, bin)).sum::<f64>();
        }
    }
    // |X|^2 of a bin is the density squared times half of the window over dt.
    let scale = 2.0 * DT / (WINDOW * WINDOWS * BAND) as f64;
    largest(powers.map(|power| (scale * power).sqrt() / stated - 1.0))
}

/// |X|^2 of a bin of the discrete Fourier transform.
fn power_at(window: &[f64], bin: usize) -> f64 {
    let (step_sine, step_cosine) = (TAU * bin as f64 / window.len() as f64).sin_cos();
    let (mut sum, mut turn) = ([0.0; 2], [1.0, 0.0]);
    for value in window {
        sum = [sum[0] + value * turn[0], sum[1] + value * turn[1]];
        turn = [turn[0] * step_cosine - turn[1] * step_sine, turn[0] * step_sine + turn[1] * step_cosine];
    }
    sum[0] * sum[0] + sum[1] * sum[1]
}

/// Frequency at which the amplitude of a sine is 1/sqrt(2), by bisection, against the stated bandwidth.
fn bandwidth() -> f64 {
    let stated = 200.0;
    let params = AccelerometerParams { bandwidth: Some(stated), ..AccelerometerParams::default() };
    let (mut low, mut high) = (0.5 * stated, 2.0 * stated);
    for _ in 0..30 {
        let middle = f64::midpoint(low, high);
        let passes = amplitude(&params, middle) > FRAC_1_SQRT_2;
        (low, high) = if passes { (middle, high) } else { (low, middle) };
    }
    (low / stated - 1.0).abs()
}

/// Of the reading of a sine of amplitude 1 (frequency in Hz), by the Fourier coefficient over the last half.
fn amplitude(params: &AccelerometerParams, frequency: f64) -> f64 {
    let sensor = params.build(DT).expect("the parameters are in range");
    let (mut state, mut random) = (AnalogueState::default(), random(1));
    let (mut sine, mut cosine, mut weights) = (0.0, 0.0, 0.0);
    let count = 4000;
    for k in 0..2 * count {
        let (of_sine, of_cosine) = (TAU * frequency * DT * k as f64).sin_cos();
        let reading = sensor.step(&mut state, of_sine, &mut random);
        if k >= count {
            // Hann's window: the last half need not be whole periods.
            let weight = 1.0 - (TAU * (k - count) as f64 / count as f64).cos();
            (sine, cosine) = (sine + weight * reading * of_sine, cosine + weight * reading * of_cosine);
            weights += 0.5 * weight;
        }
    }
    (sine / weights).hypot(cosine / weights)
}

/// Voltage of each circuit against two voltage dividers, of the largest.
fn bridge_output() -> f64 {
    let (factor, excitation) = (2.05, 5.0);
    let error = |(arms, strain): (u32, f64)| {
        let params = GaugeBridgeParams {
            gauge_factor: factor,
            active_arms: arms,
            excitation,
            ..GaugeBridgeParams::default()
        };
        let bridge = params.build(DT).expect("the parameters are in range");
        let reading = bridge.step(&mut AnalogueState::default(), strain, &mut random(1));
        let x = factor * strain;
        let [r1, r2, r3, r4] = match arms {
            1 => [1.0 + x, 1.0, 1.0, 1.0],
            2 => [1.0 + x, 1.0 - x, 1.0, 1.0],
            _ => [1.0 + x, 1.0 - x, 1.0 + x, 1.0 - x],
        };
        reading / (excitation * (r1 / (r1 + r2) - r4 / (r3 + r4))) - 1.0
    };
    let strains = [-4e-3, -7e-4, 1.3e-3, 3e-3];
    largest([1, 2, 4].into_iter().flat_map(|arms| strains.map(|strain| error((arms, strain)))))
}

/// Deviation of many drifts after a tenth of the time constant, one, and four of them, against the equation.
fn bridge_drift() -> f64 {
    let (deviation, time, count) = (5e-6, 300.0, 2000_u32);
    let params = GaugeBridgeParams {
        excitation: 1.0,
        zero_drift: deviation,
        zero_drift_time: time,
        ..GaugeBridgeParams::default()
    };
    // Exact for any step: one of 3 s is enough.
    let bridge = params.build(3.0).expect("the parameters are in range");
    let mut squares = [0.0; 3];
    for seed in 0..count {
        let (mut state, mut random) = (AnalogueState::default(), random(seed.into()));
        let zeros: Vec<f64> = (0..400).map(|_| bridge.step(&mut state, 0.0, &mut random)).collect();
        for (square, step) in squares.iter_mut().zip([10, 100, 400]) {
            *square += zeros[step - 1].powi(2) / f64::from(count);
        }
    }
    let error = |(square, after): (f64, f64)| {
        f64::sqrt(square) / (deviation * (1.0 - f64::exp(-2.0 * after)).sqrt()) - 1.0
    };
    largest(squares.into_iter().zip([0.1, 1.0, 4.0]).map(error))
}

/// Rms of the samples against the word.
fn torque_noise() -> f64 {
    let stated = 0.67;
    let sensor = TorqueSensorParams::of_noise(stated).build(DT).expect("the parameters are in range");
    let error = |seed| {
        let (mut state, mut random) = (AnalogueState::default(), random(seed));
        rms((0..SAMPLES).map(|_| sensor.step(&mut state, 0.0, &mut random))) / stated - 1.0
    };
    largest((1..=SEEDS).map(error))
}

/// Rms of the rounding of currents that lie evenly against a count over sqrt(12).
fn current_quantisation() -> f64 {
    let resolution = 0.015;
    let params = MotorCurrentParams { torque_constant: 0.1, resolution, ..MotorCurrentParams::default() };
    let sensor = params.build(DT).expect("the parameters are in range");
    let (mut state, mut random) = (AnalogueState::default(), random(1));
    let errors = (0..SAMPLES).map(|k| {
        let torque = PI * (GOLDEN * k as f64).fract() - 1.0;
        sensor.step(&mut state, torque, &mut random) - sensor.current(torque)
    });
    (rms(errors) / (resolution / 12f64.sqrt()) - 1.0).abs()
}
