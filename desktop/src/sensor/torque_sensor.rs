//! Torque sensor.
//!
//! ```text
//! reading = path of tau,   gain = 1 + sensitivity_error
//! ```
//!
//! Sign and unit of the torque that it carries (N m). Its datasheet states noise as the rms of its samples. Discretisation and order of the random
//! numbers as in [`super::analogue`].

use serde::Deserialize;
use strainwave::Error;

use super::analogue::{Analogue, AnalogueParams};
use super::drift::DriftParams;
use super::noise::Noise;

/// Words of a torque sensor's datasheet; the default has no errors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TorqueSensorParams {
    /// Sensitivity over the nominal one, less 1.
    pub sensitivity_error: f64,
    /// Reading without torque (N m).
    #[serde(rename = "zero_nm")]
    pub zero: f64,
    /// Drift of that zero: its standard deviation long after the start (N m).
    #[serde(rename = "zero_drift_nm")]
    pub zero_drift: f64,
    /// And its time constant (s).
    #[serde(rename = "zero_drift_time_s")]
    pub zero_drift_time: f64,
    /// Frequency of -3 dB (Hz); none for one that follows at once.
    #[serde(rename = "bandwidth_hz")]
    pub bandwidth: Option<f64>,
    /// Standard deviation of the samples (N m).
    #[serde(rename = "noise_nm")]
    pub noise: f64,
    /// Largest reading either way (N m).
    #[serde(rename = "range_nm")]
    pub range: Option<f64>,
    /// A count (N m); 0 for a reading that is not rounded.
    #[serde(rename = "resolution_nm")]
    pub resolution: f64,
}

/// Built torque sensor: torque (N m) in, reading (N m) out.
pub type TorqueSensor = Analogue;

impl TorqueSensorParams {
    /// Noise of this standard deviation (N m) and no other error.
    pub fn of_noise(noise: f64) -> Self {
        Self { noise, ..Self::default() }
    }

    /// Its path from torque to reading.
    pub fn path(&self) -> AnalogueParams {
        AnalogueParams {
            gain: 1.0 + self.sensitivity_error,
            offset: self.zero,
            drift: DriftParams { deviation: self.zero_drift, time: self.zero_drift_time },
            bandwidth: self.bandwidth,
            noise: Noise::Rms(self.noise),
            range: self.range,
            resolution: self.resolution,
        }
    }

    /// Builds it for a sample every `dt` (s). It draws a random number for its noise in every step, noise or not.
    ///
    /// # Errors
    /// As [`AnalogueParams::build`].
    pub fn build(&self, dt: f64) -> Result<TorqueSensor, Error> {
        self.path().build(dt)
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, Normal};

    use super::super::AnalogueState;
    use super::*;

    /// Torque and one normal number a step: bit for bit.
    #[test]
    fn noise_alone_is_added_as_it_is_drawn() {
        let (mut random, mut drawn) = (ChaCha8Rng::seed_from_u64(7), ChaCha8Rng::seed_from_u64(7));
        for deviation in [0.0, 0.67] {
            let normal = Normal::new(0.0, deviation).unwrap();
            let (sensor, mut state) =
                (TorqueSensorParams::of_noise(deviation).build(1e-4).unwrap(), AnalogueState::default());
            for torque in [0.0, -0.0, 1.0 / 3.0, -45.6] {
                let expected: f64 = torque + normal.sample(&mut drawn);
                assert_eq!(sensor.step(&mut state, torque, &mut random).to_bits(), expected.to_bits());
            }
        }
    }

    #[test]
    fn its_words_are_in_the_reading() {
        let params = TorqueSensorParams {
            sensitivity_error: -0.01,
            zero: 0.2,
            range: Some(100.0),
            ..TorqueSensorParams::default()
        };
        let (sensor, mut state) = (params.build(1e-4).unwrap(), AnalogueState::default());
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let readings = [0.0, 50.0, -200.0].map(|torque| sensor.step(&mut state, torque, &mut random));
        let expected = [0.2, 49.7, -100.0];
        assert!(readings.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{readings:?}");
    }
}
