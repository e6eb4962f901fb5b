//! Measured current of the motor.
//!
//! ```text
//! reading = path of tau/k_t,   gain = 1 + gain_error          k_t: nominal torque constant
//! ```
//!
//! tau is the motor's torque by its nominal constant, what the drive's current stands for; sign of the torque. Units: A, N m, N m/A.
//! Discretisation and order of the random numbers as in [`super::analogue`].

use rand_chacha::ChaCha8Rng;
use serde::Deserialize;
use strainwave::Error;

use super::analogue::{Analogue, AnalogueParams, AnalogueState};
use super::noise::Noise;
use super::require;

/// Words of a current sensor's datasheet.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MotorCurrentParams {
    /// k_t of the motor (N m/A); positive.
    #[serde(rename = "torque_constant_nm_per_a")]
    pub torque_constant: f64,
    /// Gain over the nominal one, less 1.
    pub gain_error: f64,
    /// Reading without current (A).
    #[serde(rename = "offset_a")]
    pub offset: f64,
    /// Frequency of -3 dB (Hz); none for one that follows at once.
    #[serde(rename = "bandwidth_hz")]
    pub bandwidth: Option<f64>,
    /// Standard deviation of the samples (A).
    #[serde(rename = "noise_a")]
    pub noise: f64,
    /// Largest reading either way (A).
    #[serde(rename = "range_a")]
    pub range: Option<f64>,
    /// A count (A); 0 for a reading that is not rounded.
    #[serde(rename = "resolution_a")]
    pub resolution: f64,
}

impl Default for MotorCurrentParams {
    /// 1 N m/A, without errors.
    fn default() -> Self {
        Self {
            torque_constant: 1.0,
            gain_error: 0.0,
            offset: 0.0,
            bandwidth: None,
            noise: 0.0,
            range: None,
            resolution: 0.0,
        }
    }
}

/// Built current sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorCurrent {
    torque_constant: f64,
    path: Analogue,
}

impl MotorCurrentParams {
    /// A current that is counted as the torque for which it stands, with noise of this standard deviation (N m) and no other
    /// error.
    pub fn as_torque(noise: f64) -> Self {
        Self { noise, ..Self::default() }
    }

    /// Builds it for a sample every `dt` (s). It draws a random number for its noise in every step, noise or not.
    ///
    /// # Errors
    /// As [`AnalogueParams::build`]; `torque_constant`.
    pub fn build(&self, dt: f64) -> Result<MotorCurrent, Error> {
        require(self.torque_constant.is_finite() && self.torque_constant > 0.0, "torque_constant")?;
        let path = AnalogueParams {
            gain: 1.0 + self.gain_error,
            offset: self.offset,
            bandwidth: self.bandwidth,
            noise: Noise::Rms(self.noise),
            range: self.range,
            resolution: self.resolution,
            ..AnalogueParams::IDEAL
        };
        Ok(MotorCurrent { torque_constant: self.torque_constant, path: path.build(dt)? })
    }
}

impl MotorCurrent {
    /// Current (A) of a torque (N m), without errors.
    pub fn current(&self, torque: f64) -> f64 {
        torque / self.torque_constant
    }

    /// The reading (A) of a torque (N m), dt after the last one.
    pub fn step(&self, state: &mut AnalogueState, torque: f64, random: &mut ChaCha8Rng) -> f64 {
        self.path.step(state, self.current(torque), random)
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    #[test]
    fn its_words_are_in_the_reading() {
        let params = MotorCurrentParams {
            torque_constant: 0.1,
            gain_error: 0.05,
            offset: -0.2,
            range: Some(20.0),
            resolution: 0.1,
            ..MotorCurrentParams::default()
        };
        let (sensor, mut state) = (params.build(1e-4).unwrap(), AnalogueState::default());
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let readings = [0.0, 1.0, -0.4, 9.0].map(|torque| sensor.step(&mut state, torque, &mut random));
        let expected = [-0.2, 10.3, -4.4, 20.0];
        assert!(readings.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{readings:?}");
        let none = MotorCurrentParams { torque_constant: 0.0, ..params };
        assert_eq!(none.build(1e-4).err(), Some(Error::OutOfRange("torque_constant")));
    }
}
