//! Noise of a sensor's samples: white and normal.
//!
//! ```text
//! sigma = n*sqrt(1/(2*dt))        of the noise density n, one-sided, up to half of the sampling rate
//! ```
//!
//! Density n in the unit over sqrt(Hz), as a datasheet has it, at the output: the bandwidth of the sensor does not lessen it. Or
//! sigma itself, where the datasheet gives the rms of the samples. Of the same stream of random numbers the samples are the same numbers times sigma.

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use strainwave::Error;

use super::{is_size, require};

/// How large the noise is, in one of two words.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Noise {
    /// None; draws no random number.
    #[default]
    None,
    /// One-sided density (unit/sqrt(Hz)); not negative.
    Density(f64),
    /// Standard deviation of the samples (unit); not negative. Draws one of 0 too.
    Rms(f64),
}

impl Noise {
    /// A density, or none.
    pub fn of_density(density: f64) -> Self {
        if density == 0.0 { Self::None } else { Self::Density(density) }
    }

    /// A standard deviation, or none.
    pub fn of_rms(deviation: f64) -> Self {
        if deviation == 0.0 { Self::None } else { Self::Rms(deviation) }
    }

    /// Sampled every `dt` (s).
    pub(crate) fn build(self, dt: f64) -> Result<White, Error> {
        let deviation = match self {
            Self::None => return Ok(White(None)),
            Self::Density(density) => density * (0.5 / dt).sqrt(),
            Self::Rms(deviation) => deviation,
        };
        require(is_size(deviation), "noise")?;
        Ok(White(Some(Normal::new(0.0, deviation).map_err(|_| Error::OutOfRange("noise"))?)))
    }
}

/// Built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct White(Option<Normal<f64>>);

impl White {
    pub fn step(&self, random: &mut ChaCha8Rng) -> f64 {
        self.0.map_or(0.0, |normal| normal.sample(random))
    }
}
