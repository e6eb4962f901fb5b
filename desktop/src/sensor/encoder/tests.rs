//! Counts, scale, delay, jitter.

use proptest::prelude::*;
use rand::SeedableRng;

use super::*;

fn random() -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(1)
}

const DT: f64 = 1e-4;

fn at(angle: Angle<f64>, velocity: f64) -> Motion<f64> {
    Motion { angle, velocity }
}

/// The first count.
fn read(params: &EncoderParams, angle: Angle<f64>) -> u32 {
    params.build(DT).unwrap().step(&mut EncoderState::default(), at(angle, 0.0), &mut random()).count
}

fn revolutions(fraction: f64) -> Angle<f64> {
    Angle::from_radians_f64(fraction * TAU / 16.0)
}

#[test]
fn an_encoder_gives_the_nearest_count() {
    let counts = |lost_bits, fraction: f64| {
        let encoder = EncoderParams { lost_bits, ..EncoderParams::of_bits(4) };
        read(&encoder, revolutions(fraction))
    };
    assert_eq!([-0.49, 0.0, 0.49, 0.51, 3.4, 15.6].map(|fraction| counts(0, fraction)), [0, 0, 0, 1, 3, 0]);
    assert_eq!([-0.9, 0.9, 1.1, 2.9, 15.1].map(|fraction| counts(1, fraction)), [0, 0, 2, 2, 0]);
}

#[test]
fn a_late_and_slow_encoder_gives_old_counts_now_and_then() {
    let late = EncoderParams { delay: 2.0 * DT, every: 3, ..EncoderParams::of_bits(4) }.build(DT).unwrap();
    let mut state = EncoderState::default();
    let mut step = |k| late.step(&mut state, at(revolutions(f64::from(k)), 0.0), &mut random());
    let read = (0..10).map(|k| step(k).new_count());
    let expected = [None, None, None, Some(1), None, None, Some(4), None, None, Some(7)];
    assert_eq!(read.collect::<Vec<_>>(), expected);
}

#[test]
fn an_eccentric_scale_repeats_every_turn_and_is_off_by_its_sines() {
    let mut errors = EncoderErrors::default();
    errors.waves[0] = Wave { order: 1, amplitude: 1e-3, phase: 0.3 };
    errors.waves[1] = Wave { order: 2, amplitude: 2e-4, phase: -0.8 };
    let encoder = EncoderParams { errors, ..EncoderParams::of_bits(24) };
    for k in 0..64 {
        let angle = Angle::from_counts(i64::from(k) << 26);
        let count = read(&encoder, angle);
        let x = angle.to_radians();
        let shown = f64::from(count) * TAU / f64::from(1 << 24);
        let error = |x: f64| 1e-3 * (x + 0.3).sin() + 2e-4 * (2.0 * x - 0.8).sin();
        let expected = x + error(x) - error(0.0);
        let difference = (shown - expected) - TAU * ((shown - expected) / TAU).round();
        assert!(difference.abs() < TAU / f64::from(1 << 24), "{k}: {shown} {expected}");
        assert_eq!(count, read(&encoder, Angle::from_counts(angle.counts + (3 << 32))));
    }
}

#[test]
fn noise_of_a_count_moves_by_a_count() {
    let errors = EncoderErrors { noise: 1.0, ..EncoderErrors::default() };
    let encoder = EncoderParams { errors, ..EncoderParams::of_bits(8) }.build(DT).unwrap();
    let (mut random, mut state) = (random(), EncoderState::default());
    let angle = Angle::from_counts(100 << 24);
    let counts: Vec<_> =
        (0..400).map(|_| encoder.step(&mut state, at(angle, 0.0), &mut random).count).collect();
    assert!(counts.iter().all(|count| (99..=101).contains(count)));
    assert!((99..=101).all(|expected| counts.contains(&expected)));
}

/// At constant speed a late reading is that of the angle so long ago, fractions of a sample too.
#[test]
fn a_delay_is_kept_to_a_fraction_of_a_sample() {
    for delay in [0.3, 1.0, 2.75] {
        let encoder = EncoderParams { delay: delay * DT, ..EncoderParams::of_bits(32) }.build(DT).unwrap();
        let mut state = EncoderState::default();
        for k in 0..20 {
            let angle = Angle::from_radians_f64(f64::from(k) * 1e-3);
            let reading = encoder.step(&mut state, at(angle, 10.0), &mut random());
            let shown = f64::from(reading.count) * TAU / 2f64.powi(32);
            let expected = (f64::from(k) - delay).max(0.0) * 1e-3;
            // The first angles are older than any that was sampled.
            assert!(f64::from(k) < delay + 1.0 || (shown - expected).abs() < 2e-9, "{delay} {k}: {shown}");
            assert_eq!(reading.is_new, f64::from(k) >= delay.floor());
        }
    }
}

/// Uniform within +-jitter: of n readings the mean square is within four of its standard deviations, sqrt(4/5/n) of it.
#[test]
fn jitter_is_an_error_in_proportion_to_the_speed() {
    let (jitter, samples) = (2e-6, 20_000);
    let encoder = EncoderParams { jitter, ..EncoderParams::of_bits(32) }.build(DT).unwrap();
    for velocity in [0.0, 30.0, -400.0] {
        let (mut state, mut random, angle) =
            (EncoderState::default(), random(), Angle::from_radians_f64(1.0));
        let mut squares = 0.0;
        for _ in 0..samples {
            let count = encoder.step(&mut state, at(angle, velocity), &mut random).count;
            let error = f64::from(count) * TAU / 2f64.powi(32) - 1.0;
            assert!(error.abs() <= jitter * velocity.abs() + 3e-9);
            squares += error * error / f64::from(samples);
        }
        let expected = (jitter * velocity).powi(2) / 3.0;
        assert!(
            (squares - expected).abs() <= 4.0 * (0.8 / f64::from(samples)).sqrt() * expected + 1e-17,
            "{velocity}"
        );
    }
}

#[test]
fn what_is_out_of_range_is_named() {
    let good = EncoderParams::of_bits(20);
    for (params, name) in [
        (EncoderParams { bits: 0, ..good }, "bits"),
        (EncoderParams { bits: 33, ..good }, "bits"),
        (EncoderParams { lost_bits: 20, ..good }, "lost_bits"),
        (EncoderParams { delay: -1e-4, ..good }, "delay"),
        (EncoderParams { every: 0, ..good }, "every"),
        (EncoderParams { jitter: f64::NAN, ..good }, "jitter"),
    ] {
        assert_eq!(params.build(DT).err(), Some(Error::OutOfRange(name)));
    }
    assert_eq!(good.build(0.0).err(), Some(Error::OutOfRange("dt")));
}

proptest! {
    /// Rounding is within half a count, and the zero angle is count 0 whatever the scale's errors.
    #[test]
    fn rounding_is_half_a_count_at_most(bits in 4..=24u32, counts: i64, amplitude in 0.0..1e-2, phase in -3.0..3.0) {
        let angle = Angle::from_counts(counts >> 8);
        let count = read(&EncoderParams::of_bits(bits), angle);
        let width = TAU / 2f64.powi(bits.cast_signed());
        let error = f64::from(count) * width - f64::from(angle.phase()) * TAU / 2f64.powi(32);
        let error = error - TAU * (error / TAU).round();
        prop_assert!(error.abs() <= 0.5 * width + 1e-9, "{error} of {width}");
        let mut errors = EncoderErrors::default();
        errors.waves[0] = Wave { order: 1, amplitude, phase };
        prop_assert_eq!(read(&EncoderParams { errors, ..EncoderParams::of_bits(bits) }, Angle::default()), 0);
    }
}
