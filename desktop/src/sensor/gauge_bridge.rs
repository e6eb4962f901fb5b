//! Strain gauges in a Wheatstone bridge, and its amplifier.
//!
//! ```text
//! x    = k*epsilon                         relative change of a gauge's resistance
//! ratio = x/(4 + 2*x)                      one active arm of the four
//! ratio = x/2                              two neighbours, one stretched as the other is pressed
//! ratio = x                                four arms, two stretched as two are pressed
//! reading = path of amplification*excitation*ratio,   gain = 1 + gain_error
//! ```
//!
//! Sign: positive where the gauge is stretched. Units: V; strain and ratio (V/V) without. Zero, drift and noise are those of the ratio, as a datasheet has
//! them, and pass the amplifier; range and resolution are those of the converter behind it. Discretisation and order of the random numbers as in
//! [`super::analogue`].
//!
//! K. Hoffmann, "An introduction to measurements using strain gages", 1989, chapter 5.

use rand_chacha::ChaCha8Rng;
use serde::Deserialize;
use strainwave::Error;

use super::analogue::{Analogue, AnalogueParams, AnalogueState};
use super::drift::DriftParams;
use super::noise::Noise;
use super::require;

/// Least 4 + 2*x of one arm: a gauge that is pressed to half of its resistance counts as that.
const LEAST_ARMS: f64 = 3.0;

/// Words of the datasheets of gauges, bridge and amplifier.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default)]
pub struct GaugeBridgeParams {
    /// k of the gauges; positive.
    pub gauge_factor: f64,
    /// Arms with a gauge: 1, 2 or 4.
    pub active_arms: u32,
    /// Voltage across the bridge (V); positive.
    #[serde(rename = "excitation_v")]
    pub excitation: f64,
    /// Gain of the amplifier; positive.
    pub amplification: f64,
    /// Gain over the nominal one, less 1: gauges, glue and amplifier.
    pub gain_error: f64,
    /// Ratio without strain (V/V).
    #[serde(rename = "zero_v_per_v")]
    pub zero: f64,
    /// Drift of that zero: its standard deviation long after the start (V/V).
    #[serde(rename = "zero_drift_v_per_v")]
    pub zero_drift: f64,
    /// And its time constant (s).
    #[serde(rename = "zero_drift_time_s")]
    pub zero_drift_time: f64,
    /// Frequency of -3 dB (Hz); none for one that follows at once.
    #[serde(rename = "bandwidth_hz")]
    pub bandwidth: Option<f64>,
    /// One-sided noise density in front of the amplifier [V/sqrt(Hz)].
    #[serde(rename = "noise_density_v_per_sqrt_hz")]
    pub noise_density: f64,
    /// Largest reading either way (V).
    #[serde(rename = "range_v")]
    pub range: Option<f64>,
    /// A count (V); 0 for a reading that is not rounded.
    #[serde(rename = "resolution_v")]
    pub resolution: f64,
}

impl Default for GaugeBridgeParams {
    /// Four gauges of factor 2 at 5 V, without amplifier and errors.
    fn default() -> Self {
        Self {
            gauge_factor: 2.0,
            active_arms: 4,
            excitation: 5.0,
            amplification: 1.0,
            gain_error: 0.0,
            zero: 0.0,
            zero_drift: 0.0,
            zero_drift_time: 0.0,
            bandwidth: None,
            noise_density: 0.0,
            range: None,
            resolution: 0.0,
        }
    }
}

/// Built bridge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaugeBridge {
    gauge_factor: f64,
    active_arms: u32,
    /// Voltage behind the amplifier of a ratio of 1 (V).
    full: f64,
    path: Analogue,
}

impl GaugeBridgeParams {
    /// Builds it for a sample every `dt` (s).
    ///
    /// # Errors
    /// As [`AnalogueParams::build`]; `gauge_factor`, `active_arms`, `excitation`, `amplification`.
    pub fn build(&self, dt: f64) -> Result<GaugeBridge, Error> {
        let positive = |value: f64| value.is_finite() && value > 0.0;
        require(positive(self.gauge_factor), "gauge_factor")?;
        require([1, 2, 4].contains(&self.active_arms), "active_arms")?;
        require(positive(self.excitation), "excitation")?;
        require(positive(self.amplification), "amplification")?;
        let full = self.excitation * self.amplification;
        let path = AnalogueParams {
            gain: 1.0 + self.gain_error,
            offset: full * self.zero,
            drift: DriftParams { deviation: full * self.zero_drift, time: self.zero_drift_time },
            bandwidth: self.bandwidth,
            noise: Noise::of_density(self.amplification * self.noise_density),
            range: self.range,
            resolution: self.resolution,
        };
        let Self { gauge_factor, active_arms, .. } = *self;
        Ok(GaugeBridge { gauge_factor, active_arms, full, path: path.build(dt)? })
    }
}

impl GaugeBridge {
    /// Voltage behind the amplifier (V) of a strain, without errors.
    pub fn voltage(&self, strain: f64) -> f64 {
        let change = self.gauge_factor * strain;
        let ratio = match self.active_arms {
            1 => change / (4.0 + 2.0 * change).max(LEAST_ARMS),
            2 => 0.5 * change,
            _ => change,
        };
        self.full * ratio
    }

    /// The reading (V) of a strain, dt after the last one.
    pub fn step(&self, state: &mut AnalogueState, strain: f64, random: &mut ChaCha8Rng) -> f64 {
        self.path.step(state, self.voltage(strain), random)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use rand::SeedableRng;

    use super::*;

    const ARMS: [u32; 3] = [1, 2, 4];

    fn bridge(active_arms: u32) -> GaugeBridge {
        GaugeBridgeParams { active_arms, excitation: 10.0, ..GaugeBridgeParams::default() }
            .build(1e-4)
            .unwrap()
    }

    /// Difference of two voltage dividers, (R1, R2) and (R4, R3), of 1 V.
    fn dividers([r1, r2, r3, r4]: [f64; 4]) -> f64 {
        r1 / (r1 + r2) - r4 / (r3 + r4)
    }

    proptest! {
        /// By Kirchhoff's laws, of resistances that change by x each.
        #[test]
        fn a_bridge_is_two_voltage_dividers(strain in -5e-3..5e-3) {
            let x = 2.0 * strain;
            let resistances = [
                [1.0 + x, 1.0, 1.0, 1.0],
                [1.0 + x, 1.0 - x, 1.0, 1.0],
                [1.0 + x, 1.0 - x, 1.0 + x, 1.0 - x],
            ];
            for (arms, resistances) in ARMS.into_iter().zip(resistances) {
                let expected = 10.0 * dividers(resistances);
                prop_assert!((bridge(arms).voltage(strain) - expected).abs() < 1e-14, "{arms}");
            }
        }
    }

    #[test]
    fn its_words_are_in_the_reading() {
        let params = GaugeBridgeParams {
            amplification: 100.0,
            gain_error: 0.1,
            zero: 1e-3,
            range: Some(2.5),
            ..GaugeBridgeParams::default()
        };
        let (sensor, mut state) = (params.build(1e-4).unwrap(), AnalogueState::default());
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let readings = [0.0, 1e-3, -1e-3, 0.1].map(|strain| sensor.step(&mut state, strain, &mut random));
        let expected = [0.5, 1.6, -0.6, 2.5];
        assert!(readings.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{readings:?}");
        let three = GaugeBridgeParams { active_arms: 3, ..params };
        assert_eq!(three.build(1e-4).err(), Some(Error::OutOfRange("active_arms")));
    }
}
