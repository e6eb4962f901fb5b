//! Encoder: its scale, its timing, its counts.
//!
//! ```text
//! count = round((theta_s + E(theta_s) - E(0) + noise) * 2^bits/(2*pi)),   E(theta) = sum_i a_i*sin(k_i*theta + p_i)
//! theta_s = theta(t - delay) + omega*jitter
//! ```
//!
//! A joint's encoders are set to zero where it stands at zero. Orders 1 and 2 a revolution are eccentricity and tilt of the
//! scale, a high order is the interpolation within a signal period. Noise is uniform within +- so many counts, jitter of the sampling instant within +- so
//! many seconds. A count is the one whose middle is nearest to the angle. Units: rad, s.
//!
//! Discretisation: a delay of n whole samples and a fraction is the count of n samples ago, of the angle interpolated by the fraction between
//! the samples before and after. A slow encoder gives a count every so many samples. Random numbers of a step: jitter, then noise, each only where there
//! is one.

use std::collections::VecDeque;
use std::f64::consts::{PI, TAU};

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use strainwave::gear::Motion;
use strainwave::{Angle, Error};

use super::wave::Wave;
use super::{is_size, require};

/// Sines of an encoder's scale error.
pub const WAVES: usize = 3;
/// Longest delay and jitter (s).
pub const LONGEST: f64 = 0.1;
/// Least share of a sample that counts as a fraction of a delay; less is the rounding of a delay of whole samples.
const LEAST_FRACTION: f64 = 1e-9;

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

/// Encoder of 2^bits counts a revolution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EncoderParams {
    /// Bits a revolution; 1..=32.
    pub bits: u32,
    /// So many of them, the last, are 0; less than `bits`.
    pub lost_bits: u32,
    /// Errors of scale and count.
    pub errors: EncoderErrors,
    /// From the angle to its count (s); 0..=[`LONGEST`].
    pub delay: f64,
    /// Samples from one count to the next; 1 or more.
    pub every: usize,
    /// Half width of the sampling instant's jitter (s); 0..=[`LONGEST`].
    pub jitter: f64,
}

impl EncoderParams {
    /// Rounding to counts is the only error.
    pub const fn of_bits(bits: u32) -> Self {
        let errors = EncoderErrors { waves: [Wave::NONE; WAVES], noise: 0.0 };
        Self { bits, lost_bits: 0, errors, delay: 0.0, every: 1, jitter: 0.0 }
    }

    /// Builds it for a sample every `dt` (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the name of the first parameter that is; `dt` unless positive.
    pub fn build(&self, dt: f64) -> Result<Encoder, Error> {
        require(dt.is_finite() && dt > 0.0, "dt")?;
        require((1..=32).contains(&self.bits), "bits")?;
        require(self.lost_bits < self.bits, "lost_bits")?;
        require(is_size(self.errors.noise), "noise")?;
        require((0.0..=LONGEST).contains(&self.delay), "delay")?;
        require(self.every > 0, "every")?;
        require((0.0..=LONGEST).contains(&self.jitter), "jitter")?;
        let samples = self.delay / dt;
        let whole = (samples + LEAST_FRACTION).floor();
        Ok(Encoder {
            bits: self.bits - self.lost_bits,
            lost: self.lost_bits,
            errors: self.errors,
            jitter: self.jitter,
            delay: whole as usize,
            fraction: Some(samples - whole).filter(|fraction| *fraction > LEAST_FRACTION),
            every: self.every,
        })
    }
}

/// Built encoder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encoder {
    /// Without those that are lost.
    bits: u32,
    lost: u32,
    errors: EncoderErrors,
    jitter: f64,
    /// In whole samples.
    delay: usize,
    /// And a fraction of one.
    fraction: Option<f64>,
    every: usize,
}

/// Counts on their way, and what was read; the default has had no sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EncoderState {
    /// Delayed counts, the newest last.
    coming: VecDeque<u32>,
    /// Angle of the last sample.
    before: Option<Angle<f64>>,
    samples: usize,
    count: Option<u32>,
}

/// What an encoder shows at a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncoderReading {
    /// The last count that has come, 0..2^bits; before the first that of the first sample.
    pub count: u32,
    /// It came in this sample.
    pub is_new: bool,
}

impl EncoderReading {
    /// The count where it came in this sample.
    pub fn new_count(self) -> Option<u32> {
        self.is_new.then_some(self.count)
    }
}

impl Encoder {
    /// The reading of a motion, dt after the last one.
    pub fn step(
        &self,
        state: &mut EncoderState,
        truth: Motion<f64>,
        random: &mut ChaCha8Rng,
    ) -> EncoderReading {
        let sampled = self.sample(state, truth, random);
        state.coming.push_back(sampled);
        let arrived = if state.coming.len() > self.delay { state.coming.pop_front() } else { None };
        let arrived = arrived.filter(|_| state.samples.is_multiple_of(self.every));
        state.samples += 1;
        state.count = arrived.or(state.count).or(Some(sampled));
        EncoderReading { count: state.count.unwrap_or(sampled), is_new: arrived.is_some() }
    }

    /// The count of this sample, which is on its way.
    fn sample(&self, state: &mut EncoderState, truth: Motion<f64>, random: &mut ChaCha8Rng) -> u32 {
        let before = state.before.replace(truth.angle).unwrap_or(truth.angle);
        let mut angle = truth.angle;
        if let Some(fraction) = self.fraction {
            angle = angle.plus(fraction * before.minus(angle));
        }
        if self.jitter > 0.0 {
            angle = angle.plus(truth.velocity * random.random_range(-self.jitter..=self.jitter));
        }
        self.count(angle, random)
    }

    /// The count of an angle.
    fn count(&self, angle: Angle<f64>, random: &mut ChaCha8Rng) -> u32 {
        let width = 2f64.powi(self.bits.cast_signed());
        let mut shown = angle;
        if self.errors.any() {
            shown = shown.plus(self.errors.at(angle));
        }
        if self.errors.noise > 0.0 {
            let noise = self.errors.noise;
            shown = shown.plus(random.random_range(-noise..=noise) * TAU / width);
        }
        encoder_count(shown.plus(PI / width), self.bits) << self.lost
    }
}

#[cfg(test)]
mod tests;
