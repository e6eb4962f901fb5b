//! Accelerometer of one axis.
//!
//! ```text
//! reading = path of f,   f = (acceleration - gravity)*axis           specific force
//! gain = 1 + sensitivity_error
//! ```
//!
//! At rest with its axis upwards it reads +g, in free fall 0. Units: m/s^2, Hz. Discretisation and order of the random numbers as
//! in [`super::analogue`].

use serde::Deserialize;
use strainwave::Error;

use super::analogue::{Analogue, AnalogueParams};
use super::drift::DriftParams;
use super::noise::Noise;

/// Words of an accelerometer's datasheet; the default has no errors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AccelerometerParams {
    /// Sensitivity over the nominal one, less 1.
    pub sensitivity_error: f64,
    /// Reading without acceleration (m/s^2).
    #[serde(rename = "bias_m_per_s2")]
    pub bias: f64,
    /// Instability of that bias: its standard deviation long after the start (m/s^2).
    #[serde(rename = "bias_drift_m_per_s2")]
    pub bias_drift: f64,
    /// And its time constant (s).
    #[serde(rename = "bias_drift_time_s")]
    pub bias_drift_time: f64,
    /// Frequency of -3 dB (Hz); none for one that follows at once.
    #[serde(rename = "bandwidth_hz")]
    pub bandwidth: Option<f64>,
    /// One-sided noise density [m/s^2/sqrt(Hz)].
    #[serde(rename = "noise_density_m_per_s2_per_sqrt_hz")]
    pub noise_density: f64,
    /// Largest reading either way (m/s^2).
    #[serde(rename = "range_m_per_s2")]
    pub range: Option<f64>,
    /// A count (m/s^2); 0 for a reading that is not rounded.
    #[serde(rename = "resolution_m_per_s2")]
    pub resolution: f64,
}

/// Built accelerometer: specific force (m/s^2) in, reading (m/s^2) out.
pub type Accelerometer = Analogue;

impl AccelerometerParams {
    /// Builds it for a sample every `dt` (s).
    ///
    /// # Errors
    /// As [`AnalogueParams::build`].
    pub fn build(&self, dt: f64) -> Result<Accelerometer, Error> {
        let path = AnalogueParams {
            gain: 1.0 + self.sensitivity_error,
            offset: self.bias,
            drift: DriftParams { deviation: self.bias_drift, time: self.bias_drift_time },
            bandwidth: self.bandwidth,
            noise: Noise::of_density(self.noise_density),
            range: self.range,
            resolution: self.resolution,
        };
        path.build(dt)
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::super::AnalogueState;
    use super::*;

    #[test]
    fn its_words_are_in_the_reading() {
        let params = AccelerometerParams {
            sensitivity_error: 0.02,
            bias: 0.3,
            range: Some(40.0),
            resolution: 0.01,
            ..AccelerometerParams::default()
        };
        let (sensor, mut state) = (params.build(1e-4).unwrap(), AnalogueState::default());
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let readings =
            [0.0, 9.81, -9.81, 100.0, -100.0].map(|force| sensor.step(&mut state, force, &mut random));
        let expected = [0.3, 10.31, -9.71, 40.0, -40.0];
        assert!(readings.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{readings:?}");
    }
}
