//! Encoders with their errors.
//!
//! ```text
//! count = round((theta + E(theta) - E(0) + noise) * 2^bits/(2*pi)),   E(theta) = sum_i a_i*sin(k_i*theta + p_i)
//! ```
//!
//! A joint's encoders are set to zero where it stands at zero.
//! Orders 1 and 2 a revolution are eccentricity and tilt of the scale, a high order is the interpolation within a signal period.
//! Noise is uniform within +- so many counts. A count is the one whose middle is nearest to the angle. Units: rad.

use std::collections::VecDeque;
use std::f64::consts::{PI, TAU};

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use strainwave::Angle;

use super::cogging::Wave;

/// Sines of an encoder's scale error.
pub const WAVES: usize = 3;

/// Errors of an encoder.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EncoderErrors {
    /// Over its own angle (rad).
    pub waves: [Wave; WAVES],
    /// Half width of its noise (counts).
    pub noise: f64,
}

impl EncoderErrors {
    /// Of the scale, at an angle (rad).
    pub fn at(&self, angle: Angle<f64>) -> f64 {
        self.waves.iter().map(|wave| wave.at(angle) - wave.at(Angle::default())).sum()
    }

    /// There are any of the scale.
    fn any(&self) -> bool {
        self.waves.iter().any(|wave| wave.amplitude != 0.0)
    }
}

/// Raw count of an encoder of 2^bits counts a revolution.
pub fn encoder_count(angle: Angle<f64>, bits: u32) -> u32 {
    angle.phase() >> (32 - bits)
}

/// An encoder of 2^bits counts a revolution whose last counts may be lost in noise.
#[derive(Clone, Copy, Debug)]
pub struct EncoderModel {
    bits: u32,
    lost: u32,
    errors: EncoderErrors,
}

impl EncoderModel {
    /// Of so many bits; a `noise` of 2 takes the last of them, of 4 the last two.
    pub fn new(bits: u32, noise: f64, errors: EncoderErrors) -> Self {
        Self { bits, lost: noise.log2().round().max(0.0) as u32, errors }
    }

    /// The count at an angle; its noise is drawn from `random`.
    pub fn read(&self, angle: Angle<f64>, random: &mut ChaCha8Rng) -> u32 {
        let bits = self.bits - self.lost.min(self.bits);
        let mut shown = angle;
        if self.errors.any() {
            shown = shown.plus(self.errors.at(angle));
        }
        if self.errors.noise > 0.0 {
            let noise = self.errors.noise;
            shown = shown.plus(random.random_range(-noise..=noise) * TAU / 2f64.powi(bits.cast_signed()));
        }
        let half = PI / 2f64.powi(bits.cast_signed());
        encoder_count(shown.plus(half), bits) << (self.bits - bits)
    }
}

/// Counts of an encoder that arrive late, and not every period.
#[derive(Clone, Debug)]
pub struct LateEncoder {
    encoder: EncoderModel,
    /// By how many periods.
    delay: usize,
    /// Every how many.
    every: usize,
    /// Delayed counts, the newest last.
    coming: VecDeque<u32>,
    periods: usize,
}

impl LateEncoder {
    /// Late by `delay` periods, read every so many.
    pub fn new(encoder: EncoderModel, delay: usize, every: usize) -> Self {
        Self { encoder, delay, every, coming: VecDeque::with_capacity(delay + 1), periods: 0 }
    }

    /// The count that arrives in this period, when one does.
    pub fn read(&mut self, angle: Angle<f64>, random: &mut ChaCha8Rng) -> Option<u32> {
        self.coming.push_back(self.encoder.read(angle, random));
        let arrived = if self.coming.len() > self.delay { self.coming.pop_front() } else { None };
        let due = self.periods.is_multiple_of(self.every);
        self.periods += 1;
        arrived.filter(|_| due)
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    fn random() -> ChaCha8Rng {
        ChaCha8Rng::seed_from_u64(1)
    }

    fn revolutions(fraction: f64) -> Angle<f64> {
        Angle::from_radians_f64(fraction * TAU / 16.0)
    }

    #[test]
    fn an_encoder_gives_the_nearest_count() {
        let counts = |noise, fraction: f64| {
            EncoderModel::new(4, noise, EncoderErrors::default()).read(revolutions(fraction), &mut random())
        };
        assert_eq!(
            [-0.49, 0.0, 0.49, 0.51, 3.4, 15.6].map(|fraction| counts(1.0, fraction)),
            [0, 0, 0, 1, 3, 0]
        );
        assert_eq!([-0.9, 0.9, 1.1, 2.9, 15.1].map(|fraction| counts(2.0, fraction)), [0, 0, 2, 2, 0]);
    }

    #[test]
    fn a_late_and_slow_encoder_gives_old_counts_now_and_then() {
        let mut late = LateEncoder::new(EncoderModel::new(4, 1.0, EncoderErrors::default()), 2, 3);
        let read = (0..10).map(|k| late.read(revolutions(f64::from(k)), &mut random()));
        let expected = [None, None, None, Some(1), None, None, Some(4), None, None, Some(7)];
        assert_eq!(read.collect::<Vec<_>>(), expected);
    }

    #[test]
    fn an_eccentric_scale_repeats_every_turn_and_is_off_by_its_sines() {
        let mut errors = EncoderErrors::default();
        errors.waves[0] = Wave { order: 1, amplitude: 1e-3, phase: 0.3 };
        errors.waves[1] = Wave { order: 2, amplitude: 2e-4, phase: -0.8 };
        let encoder = EncoderModel::new(24, 1.0, errors);
        for k in 0..64 {
            let angle = Angle::from_counts(i64::from(k) << 26);
            let count = encoder.read(angle, &mut random());
            let x = angle.to_radians();
            let shown = f64::from(count) * TAU / f64::from(1 << 24);
            let error = |x: f64| 1e-3 * (x + 0.3).sin() + 2e-4 * (2.0 * x - 0.8).sin();
            let expected = x + error(x) - error(0.0);
            let difference = (shown - expected) - TAU * ((shown - expected) / TAU).round();
            assert!(difference.abs() < TAU / f64::from(1 << 24), "{k}: {shown} {expected}");
            assert_eq!(count, encoder.read(Angle::from_counts(angle.counts + (3 << 32)), &mut random()));
        }
    }

    #[test]
    fn noise_of_a_count_moves_by_a_count() {
        let errors = EncoderErrors { noise: 1.0, ..EncoderErrors::default() };
        let (encoder, mut random) = (EncoderModel::new(8, 1.0, errors), random());
        let angle = Angle::from_counts(100 << 24);
        let counts: Vec<_> = (0..400).map(|_| encoder.read(angle, &mut random)).collect();
        assert!(counts.iter().all(|count| (99..=101).contains(count)));
        assert!((99..=101).all(|expected| counts.contains(&expected)));
    }
}
