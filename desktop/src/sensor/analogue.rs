//! Analogue path of a sensor, from the true value to the reading.
//!
//! ```text
//! y       = low pass of gain*x at f_c                       (low_pass.rs)
//! reading = limited(rounded(y + offset + drift + noise))    (drift.rs, noise.rs)
//! rounded to whole multiples of `resolution`, limited to +-range
//! ```
//!
//! Sign: that of x for a positive gain. Units: x of the true value, offset, drift, noise, range and resolution of the reading, f_c (Hz). Discretisation: exact
//! for an x that is linear between two samples. Random numbers of a step: drift, then noise, each only where there is one.

use rand_chacha::ChaCha8Rng;
use strainwave::Error;

use super::drift::{Drift, DriftParams};
use super::low_pass::{LowPass, LowPassState};
use super::noise::{Noise, White};
use super::{is_size, require};

/// Analogue path; [`Self::IDEAL`] with what differs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnalogueParams {
    /// Reading over true value; finite.
    pub gain: f64,
    /// Reading of a true value of 0; finite.
    pub offset: f64,
    /// Drift of that reading.
    pub drift: DriftParams,
    /// f_c, where the amplitude is 3 dB lower (Hz); positive. None for a sensor that follows at once.
    pub bandwidth: Option<f64>,
    /// Noise of the samples.
    pub noise: Noise,
    /// Largest reading either way; positive. None without a limit.
    pub range: Option<f64>,
    /// A count of the reading; 0 for a reading that is not rounded.
    pub resolution: f64,
}

impl AnalogueParams {
    /// The reading is the true value.
    pub const IDEAL: Self = Self {
        gain: 1.0,
        offset: 0.0,
        drift: DriftParams { deviation: 0.0, time: 0.0 },
        bandwidth: None,
        noise: Noise::None,
        range: None,
        resolution: 0.0,
    };

    /// Builds it for a sample every `dt` (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the name of the first parameter that is; `dt` unless positive.
    pub fn build(&self, dt: f64) -> Result<Analogue, Error> {
        require(dt.is_finite() && dt > 0.0, "dt")?;
        require(self.gain.is_finite(), "gain")?;
        require(self.offset.is_finite(), "offset")?;
        require(is_size(self.resolution), "resolution")?;
        require(self.range.is_none_or(|range| range > 0.0), "range")?;
        Ok(Analogue {
            gain: self.gain,
            offset: self.offset,
            drift: self.drift.build(dt)?,
            low_pass: LowPass::build(self.bandwidth, dt)?,
            noise: self.noise.build(dt)?,
            range: self.range.unwrap_or(f64::INFINITY),
            resolution: self.resolution,
        })
    }
}

/// Built analogue path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Analogue {
    gain: f64,
    offset: f64,
    drift: Drift,
    low_pass: LowPass,
    noise: White,
    range: f64,
    resolution: f64,
}

/// What a path remembers of the samples before; the default has had none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AnalogueState {
    low_pass: LowPassState,
    zero: f64,
}

impl Analogue {
    /// The reading of `truth`, dt after the last one. A value that is no number counts as the last one.
    pub fn step(&self, state: &mut AnalogueState, truth: f64, random: &mut ChaCha8Rng) -> f64 {
        let followed = self.low_pass.step(&mut state.low_pass, self.gain * truth);
        let zero = self.offset + self.drift.step(&mut state.zero, random);
        let reading = followed + zero + self.noise.step(random);
        self.rounded(reading).clamp(-self.range, self.range)
    }

    fn rounded(&self, reading: f64) -> f64 {
        if self.resolution > 0.0 { (reading / self.resolution).round() * self.resolution } else { reading }
    }
}

#[cfg(test)]
mod tests;
