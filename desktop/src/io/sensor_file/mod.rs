//! The sensor file: one TOML file with the sensors of a joint and of the link behind it.
//!
//! Each sensor is a table of its own and may be left out; its keys are the words of its datasheet with their unit, and what is left out
//! is ideal. It is read like a gear file: an unknown or missing key, a wrong type and a value out of range are refused by one line that names
//! the file, the key, the value and what is allowed (`keys.rs`).

mod keys;

use std::path::Path;

use serde::Deserialize;

use crate::io::file::{self, BadInput};
use crate::io::keyed_file::key::Schema;
use crate::io::keyed_file::{self, KeyedFile, LONGEST_FILE};
use crate::sensor::{
    AccelerometerParams, EncoderErrors, EncoderParams, GaugeBridgeParams, MotorCurrentParams,
    TorqueSensorParams, Wave,
};
pub use keys::KEYS;

/// The example, as a file.
pub const EXAMPLE: &str = include_str!("../../../../examples/sensors/joint.toml");

/// A sensor file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorFile {
    /// Name and seed.
    pub sensor_set: SetSection,
    /// At the motor.
    pub motor_encoder: Option<EncoderSection>,
    /// At the output, or at the joint of a link.
    pub output_encoder: Option<EncoderSection>,
    /// Behind the gear, or at the joint of a link.
    pub torque_sensor: Option<TorqueSensorParams>,
    /// Of the motor.
    pub motor_current: Option<MotorCurrentParams>,
    /// At the tip of the link, across it.
    pub accelerometer: Option<AccelerometerParams>,
    /// On the link.
    pub gauge_bridge: Option<BridgeSection>,
}

/// `[sensor_set]`
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SetSection {
    /// Name of the set.
    pub name: String,
    /// Of all random numbers.
    #[serde(default)]
    pub seed: u64,
}

/// `[motor_encoder]`, `[output_encoder]`
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EncoderSection {
    /// A revolution.
    pub bits: u32,
    /// Error once a revolution (rad).
    #[serde(rename = "eccentricity_rad", default)]
    pub eccentricity: f64,
    /// Its phase (rad).
    #[serde(rename = "eccentricity_phase_rad", default)]
    pub eccentricity_phase: f64,
    /// Error twice a revolution (rad).
    #[serde(rename = "tilt_rad", default)]
    pub tilt: f64,
    /// Its phase (rad).
    #[serde(rename = "tilt_phase_rad", default)]
    pub tilt_phase: f64,
    /// Error once a signal period (rad).
    #[serde(rename = "interpolation_rad", default)]
    pub interpolation: f64,
    /// Its phase (rad).
    #[serde(rename = "interpolation_phase_rad", default)]
    pub interpolation_phase: f64,
    /// Signal periods a revolution.
    pub signal_periods: Option<u32>,
    /// Half width of the noise (counts).
    #[serde(rename = "noise_counts", default)]
    pub noise: f64,
    /// From the angle to its count (s).
    #[serde(rename = "delay_s", default)]
    pub delay: f64,
    /// Half width of the sampling instant's jitter (s).
    #[serde(rename = "jitter_s", default)]
    pub jitter: f64,
    /// Control periods from one count to the next.
    #[serde(default = "one")]
    pub update_periods: usize,
}

fn one() -> usize {
    1
}

/// `[gauge_bridge]`
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct BridgeSection {
    /// Place of the gauges (m from the joint).
    #[serde(rename = "at_m")]
    pub at: f64,
    /// Gauges, bridge and amplifier.
    #[serde(flatten)]
    pub bridge: GaugeBridgeParams,
}

impl EncoderSection {
    /// The encoder.
    pub fn params(&self) -> EncoderParams {
        let wave = |order, amplitude, phase| Wave { order, amplitude, phase };
        let waves = [
            wave(1, self.eccentricity, self.eccentricity_phase),
            wave(2, self.tilt, self.tilt_phase),
            wave(self.signal_periods.unwrap_or_default(), self.interpolation, self.interpolation_phase),
        ];
        EncoderParams {
            errors: EncoderErrors { waves, noise: self.noise },
            delay: self.delay,
            every: self.update_periods,
            jitter: self.jitter,
            ..EncoderParams::of_bits(self.bits)
        }
    }
}

impl KeyedFile for SensorFile {
    const SCHEMA: Schema = keys::SCHEMA;
    const DEFAULT: &'static str = EXAMPLE;

    /// There is a sensor, and what needs another key has it.
    fn conditions(&self, damaged: &[&str]) -> Vec<String> {
        if damaged.is_empty() && self.names().is_empty() {
            let sections = Self::SCHEMA.optional_sections.join("], [");
            return vec![format!("no sensor; allowed: one at least of [{sections}]")];
        }
        let sound = |section: &str| !damaged.contains(&section);
        self.needs()
            .into_iter()
            .filter(|(section, ..)| sound(section))
            .filter(|(.., holds)| !holds)
            .map(|(section, key, needed_by, _)| {
                format!("missing key {section}.{key}; {section}.{needed_by} needs it")
            })
            .chain(self.arms().filter(|_| sound("gauge_bridge")))
            .collect()
    }
}

impl SensorFile {
    /// Names of the sensors that there are, as its tables are called.
    pub fn names(&self) -> Vec<&'static str> {
        let there = [
            self.motor_encoder.is_some(),
            self.output_encoder.is_some(),
            self.torque_sensor.is_some(),
            self.motor_current.is_some(),
            self.accelerometer.is_some(),
            self.gauge_bridge.is_some(),
        ];
        let sections = keys::SCHEMA.optional_sections.iter().zip(there);
        sections.filter(|(_, there)| *there).map(|(name, _)| *name).collect()
    }

    /// Section, key, the key that needs it, and whether that is so.
    fn needs(&self) -> Vec<(&'static str, &'static str, &'static str, bool)> {
        let encoder = |name, section: &Option<EncoderSection>| {
            let holds = section.is_none_or(|it| it.interpolation == 0.0 || it.signal_periods.is_some());
            (name, "signal_periods", "interpolation_rad", holds)
        };
        let drifts = |deviation: f64, time: f64| deviation == 0.0 || time > 0.0;
        let torque = self.torque_sensor.is_none_or(|it| drifts(it.zero_drift, it.zero_drift_time));
        let bias = self.accelerometer.is_none_or(|it| drifts(it.bias_drift, it.bias_drift_time));
        let zero = self.gauge_bridge.is_none_or(|it| drifts(it.bridge.zero_drift, it.bridge.zero_drift_time));
        vec![
            encoder("motor_encoder", &self.motor_encoder),
            encoder("output_encoder", &self.output_encoder),
            ("torque_sensor", "zero_drift_time_s", "zero_drift_nm", torque),
            ("accelerometer", "bias_drift_time_s", "bias_drift_m_per_s2", bias),
            ("gauge_bridge", "zero_drift_time_s", "zero_drift_v_per_v", zero),
        ]
    }

    fn arms(&self) -> impl Iterator<Item = String> + use<> {
        let three = self.gauge_bridge.filter(|it| it.bridge.active_arms == 3);
        three
            .into_iter()
            .map(|_| "gauge_bridge.active_arms = 3 is out of range; allowed: 1, 2 or 4".to_owned())
    }

    /// Reads and checks `path`.
    ///
    /// # Errors
    /// One line that names the file, the key, its value and what is allowed.
    pub fn read(path: &Path) -> Result<Self, BadInput> {
        Self::parse(path, &file::read(path, LONGEST_FILE)?)
    }

    /// The sensor file in `bytes`; `path` is only named in errors.
    ///
    /// # Errors
    /// As [`SensorFile::read`].
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Self, BadInput> {
        keyed_file::parse(path, bytes)
    }

    /// Reads and checks `path`, and tells everything that is wrong with it.
    ///
    /// # Errors
    /// An error for each fault, as [`SensorFile::read`] has it for the first.
    pub fn faultless(path: &Path) -> Result<Self, Vec<BadInput>> {
        keyed_file::faultless(path)
    }

    /// The example, `examples/sensors/joint.toml`.
    pub fn example() -> Self {
        Self::parse(Path::new("joint.toml"), EXAMPLE.as_bytes()).expect("the example is tested")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(text: &str) -> String {
        SensorFile::parse("s.toml".as_ref(), text.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn every_key_is_in_the_example_or_one_like_it() {
        let example: toml::Table = EXAMPLE.parse().unwrap();
        let has = |path: &str| {
            let (section, name) = path.split_once('.').unwrap();
            example[section].as_table().unwrap().contains_key(name)
        };
        for key in KEYS.iter().filter(|key| !key.path.contains("encoder")) {
            assert!(has(key.path), "{}", key.path);
        }
        for (section, table) in &example {
            for name in table.as_table().unwrap().keys() {
                assert!(KEYS.iter().any(|key| key.path == format!("{section}.{name}")), "{section}.{name}");
            }
        }
        assert_eq!(SensorFile::example().gauge_bridge.unwrap().bridge.active_arms, 2);
    }

    #[test]
    fn what_is_wrong_is_named_with_key_value_and_range() {
        for (from, to, line) in [
            (
                "bits = 17",
                "bits = 40",
                "s.toml: motor_encoder.bits = 40 is out of range; allowed: a whole number from 4 to 32",
            ),
            (
                "bandwidth_hz = 500.0",
                "bandwidth_hz = 0.0",
                "s.toml: gauge_bridge.bandwidth_hz = 0.0 is out of range; allowed: a number from 0.1 to 1e7 Hz",
            ),
            (
                "gauge_factor = 2.05\n",
                "",
                "s.toml: missing key gauge_bridge.gauge_factor; allowed: a number from 0.1 to 1000",
            ),
            (
                "active_arms = 2",
                "active_arms = 3",
                "s.toml: gauge_bridge.active_arms = 3 is out of range; allowed: 1, 2 or 4",
            ),
            (
                "signal_periods = 2048",
                "",
                "s.toml: missing key output_encoder.signal_periods; output_encoder.interpolation_rad needs it",
            ),
            (
                "zero_drift_time_s = 600.0",
                "",
                "s.toml: missing key torque_sensor.zero_drift_time_s; torque_sensor.zero_drift_nm needs it",
            ),
            (
                "noise_a = 0.02",
                "noise = 0.02",
                "s.toml: unknown key motor_current.noise = 0.02; the nearest known key is ",
            ),
        ] {
            assert!(EXAMPLE.contains(from), "{from}");
            let found = refusal(&EXAMPLE.replacen(from, to, 1));
            assert!(found.starts_with(line), "{found}");
        }
        let none = refusal("[sensor_set]\nname = \"a\"\n");
        assert!(
            none.starts_with("s.toml: no sensor; allowed: one at least of [motor_encoder], [out"),
            "{none}"
        );
    }
}
