//! `[friction.input]` and `[friction.output]`: one vocabulary of keys for every friction model of the library.
//!
//! `model` chooses, each side for itself. [`ModelName::needs`] tells which keys a model needs, [`ModelName::may_have`] which
//! others it reads; `strainwave report` has both as a table. All other keys may stay in the file, so that one changed word
//! compares two models. Every key in the file is checked, read or not. [`strainwave::friction::data`] has the symbols, and the
//! value that a key has when it is left out.
//!
//! `load_driving` and `load_driven` are the level that each N m through the contact adds while the motor drives the load,
//! and while the load drives the motor. `ripple_cosines` and `ripple_sines` are fractions of the level, of orders 1 and 2 a revolution
//! of the wave generator. What `[friction.*.backward]` leaves out is as forwards; it has `coulomb_nm`, `static_nm`, `stribeck_rad_per_s`,
//! `viscous_nm_s_per_rad`, `ripple_cosines` and `ripple_sines` of motion backwards.
//!
//! `state_space` is Bliman and Sorine's eq. (8) with general A, B, C: an entry of the list for each of 1 to
//! [`strainwave::friction::data::MOST_STATES`] states, with its row of A and its entries of B and C.

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use strainwave::friction::ModelName;

/// `[friction.input]` and `[friction.output]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BothFrictions {
    /// At the wave generator.
    pub input: Friction,
    /// At the output.
    pub output: Friction,
}

/// Friction of one side.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Friction {
    /// Which model.
    #[serde(serialize_with = "serialize_name", deserialize_with = "deserialize_name")]
    pub model: ModelName,
    /// Fc (N m).
    #[serde(rename = "coulomb_nm", skip_serializing_if = "Option::is_none")]
    pub coulomb: Option<f64>,
    /// Fs >= Fc (N m).
    #[serde(rename = "static_nm", skip_serializing_if = "Option::is_none")]
    pub static_level: Option<f64>,
    /// vs (rad/s).
    #[serde(rename = "stribeck_rad_per_s", skip_serializing_if = "Option::is_none")]
    pub stribeck_velocity: Option<f64>,
    /// delta, 1 or 2.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stribeck_exponent: Option<u32>,
    /// Fv (N m s/rad).
    #[serde(rename = "viscous_nm_s_per_rad", skip_serializing_if = "Option::is_none")]
    pub viscous: Option<f64>,
    /// eps, presliding distance (rad).
    #[serde(rename = "presliding_rad", skip_serializing_if = "Option::is_none")]
    pub presliding: Option<f64>,
    /// eta, ratio of the two presliding distances of the second order.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub presliding_ratio: Option<f64>,
    /// DV, below which a body counts as standing (rad/s).
    #[serde(rename = "dead_band_rad_per_s", skip_serializing_if = "Option::is_none")]
    pub dead_band: Option<f64>,
    /// tau_L, by which the Stribeck effect lags behind the speed (s).
    #[serde(rename = "frictional_memory_s", skip_serializing_if = "Option::is_none")]
    pub frictional_memory: Option<f64>,
    /// gamma, in which static friction rises by half (s).
    #[serde(rename = "dwell_s", skip_serializing_if = "Option::is_none")]
    pub dwell: Option<f64>,
    /// i, shape exponent of Dahl's presliding; 0, 1 or 2.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dahl_exponent: Option<u32>,
    /// sigma1 (N m s/rad).
    #[serde(rename = "micro_damping_nm_s_per_rad", skip_serializing_if = "Option::is_none")]
    pub micro_damping: Option<f64>,
    /// Level over torque while the motor drives the load.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub load_driving: Option<f64>,
    /// Level over torque while the load drives the motor.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub load_driven: Option<f64>,
    /// Fractions a_1, a_2 of the level.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ripple_cosines: Option<Vec<f64>>,
    /// Fractions b_1, b_2 of the level.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ripple_sines: Option<Vec<f64>>,
    /// Parameters of backward motion where they differ.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub backward: Option<Backward>,
    /// Rows of eq. (8).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub state_space: Option<Vec<StateRow>>,
}

/// `[friction.*.backward]`: what is left out is as forwards.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Backward {
    /// Fc (N m).
    #[serde(rename = "coulomb_nm", skip_serializing_if = "Option::is_none")]
    pub coulomb: Option<f64>,
    /// Fs >= Fc (N m).
    #[serde(rename = "static_nm", skip_serializing_if = "Option::is_none")]
    pub static_level: Option<f64>,
    /// vs (rad/s).
    #[serde(rename = "stribeck_rad_per_s", skip_serializing_if = "Option::is_none")]
    pub stribeck_velocity: Option<f64>,
    /// Fv (N m s/rad).
    #[serde(rename = "viscous_nm_s_per_rad", skip_serializing_if = "Option::is_none")]
    pub viscous: Option<f64>,
    /// Fractions a_1, a_2 of the level.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ripple_cosines: Option<Vec<f64>>,
    /// Fractions b_1, b_2 of the level.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ripple_sines: Option<Vec<f64>>,
}

/// One state of `[[friction.*.state_space]]`, dx_i/ds = sum of a_ij x_j + b_i sign(v), F = sum of c_i x_i.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StateRow {
    /// Row of A (1/rad).
    #[serde(rename = "a_per_rad")]
    pub a: Vec<f64>,
    /// Entry of B (1/rad).
    #[serde(rename = "b_per_rad")]
    pub b: f64,
    /// Entry of C (N m).
    #[serde(rename = "c_nm")]
    pub c: f64,
}

fn serialize_name<S: Serializer>(name: &ModelName, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(name.word())
}

fn deserialize_name<'de, D: Deserializer<'de>>(deserializer: D) -> Result<ModelName, D::Error> {
    let word = String::deserialize(deserializer)?;
    ModelName::of_word(&word).ok_or_else(|| D::Error::unknown_variant(&word, ModelName::WORDS))
}

impl Friction {
    /// The same with the values of motion backwards.
    #[must_use]
    pub fn backwards(&self) -> Self {
        let backward = self.backward.clone().unwrap_or_default();
        Self {
            coulomb: backward.coulomb.or(self.coulomb),
            static_level: backward.static_level.or(self.static_level),
            stribeck_velocity: backward.stribeck_velocity.or(self.stribeck_velocity),
            viscous: backward.viscous.or(self.viscous),
            ripple_cosines: backward.ripple_cosines.or_else(|| self.ripple_cosines.clone()),
            ripple_sines: backward.ripple_sines.or_else(|| self.ripple_sines.clone()),
            ..self.clone()
        }
    }
}
