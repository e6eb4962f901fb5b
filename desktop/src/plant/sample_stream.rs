//! Random numbers of one row of the unknowns: a stream of its own, which follows from the seed and the row's name.

use std::f64::consts::PI;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::sensor::Wave;

/// Random numbers of one row.
pub struct SampleStream(ChaCha8Rng);

impl SampleStream {
    /// Of a row's name, for a seed.
    pub fn new(seed: u64, name: &str) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        // FNV-1a. The box has stream 0, the clock and the encoders of a bench the next few.
        let hash = name.bytes().fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
        });
        random.set_stream(hash | 1 << 63);
        Self(random)
    }

    /// Even from one end to the other.
    pub(super) fn within(&mut self, from: f64, to: f64) -> f64 {
        self.0.random_range(from..=to)
    }

    /// 1 +- `span`.
    pub(super) fn about_one(&mut self, span: f64) -> f64 {
        self.within(1.0 - span, 1.0 + span)
    }

    /// Even over the logarithm.
    pub(super) fn factor(&mut self, from: f64, to: f64) -> f64 {
        self.within(from.ln(), to.ln()).exp()
    }

    /// Of a whole revolution (rad).
    pub(super) fn phase(&mut self) -> f64 {
        self.within(-PI, PI)
    }

    /// A whole number, both ends included.
    pub(super) fn whole(&mut self, from: u32, to: u32) -> u32 {
        self.0.random_range(from..=to)
    }

    /// A wave of at most this amplitude.
    pub(super) fn wave(&mut self, order: u32, most: f64) -> Wave {
        Wave { order, amplitude: self.within(0.0, most), phase: self.phase() }
    }
}
