//! The link file: one TOML file that describes an arm link, and the PZT patch on it where there is one.
//!
//! Keys carry their unit; the fields here are the same numbers in SI units. It is read like a gear file: an unknown or missing key,
//! a wrong type and a value out of range are refused by one line that names the file, the key, the value and what is allowed
//! (`keys.rs`); so are conditions on several keys (`physics.rs`), among them the number of modes that a period of control can
//! carry.

mod keys;
mod physics;

use std::path::Path;

use serde::{Deserialize, Serialize};
use strainwave::Error;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::hysteresis::HysteresisTable;
use strainwave::link::{LinkParams, Span};
use strainwave::piezo::{Piezo, PiezoParams};

use crate::io::file::{self, BadInput};
use crate::io::keyed_file::key::Schema;
use crate::io::keyed_file::{self, KeyedFile, LONGEST_FILE};
pub use keys::KEYS;

/// The example `forearm`, as a file.
pub const EXAMPLE: &str = include_str!("../../../../examples/link/forearm.toml");

/// Modes of a link whose file names no number.
pub const MODES: usize = 2;
/// Levels of a patch's hysteresis, and turning points that it remembers.
pub const LEVELS: usize = 24;
/// Turning points that it remembers.
pub const MEMORY: usize = 28;

/// A link file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LinkFile {
    /// The beam and its payload.
    pub link: LinkSection,
    /// The patch.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub piezo: Option<PiezoSection>,
}

/// `[link]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LinkSection {
    /// Name of the link.
    pub name: String,
    /// Number of modes.
    #[serde(default = "default_modes")]
    pub modes: usize,
    /// L (m).
    #[serde(rename = "length_m")]
    pub length: f64,
    /// EI (N m^2).
    #[serde(rename = "bending_stiffness_nm2")]
    pub bending_stiffness: f64,
    /// mu (kg/m).
    #[serde(rename = "linear_density_kg_per_m")]
    pub linear_density: f64,
    /// From face to face (m).
    #[serde(rename = "thickness_m")]
    pub thickness: f64,
    /// M (kg).
    #[serde(rename = "payload_kg")]
    pub payload: f64,
    /// Rated payload (kg).
    #[serde(rename = "rated_payload_kg", default, skip_serializing_if = "Option::is_none")]
    pub rated_payload: Option<f64>,
    /// J (kg m^2).
    #[serde(rename = "payload_inertia_kg_m2")]
    pub payload_inertia: f64,
    /// zeta of each mode, or of all.
    pub damping_ratios: Vec<f64>,
    /// g in the plane of motion (m/s^2).
    #[serde(rename = "gravity_m_per_s2")]
    pub gravity: f64,
    /// Places of strain gauges (m from the joint).
    #[serde(rename = "gauges_m", default, skip_serializing_if = "Vec::is_empty")]
    pub gauges: Vec<f64>,
}

/// `[piezo]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PiezoSection {
    /// Where the patch starts and ends (m from the joint).
    #[serde(rename = "start_m")]
    pub start: f64,
    /// Its other end (m).
    #[serde(rename = "end_m")]
    pub end: f64,
    /// Width (m).
    #[serde(rename = "width_m")]
    pub width: f64,
    /// Thickness (m).
    #[serde(rename = "thickness_m")]
    pub thickness: f64,
    /// E (Pa).
    #[serde(rename = "youngs_modulus_pa")]
    pub youngs_modulus: f64,
    /// d31 (m/V).
    #[serde(rename = "charge_constant_m_per_v")]
    pub charge_constant: f64,
    /// Permittivity at constant stress (F/m).
    #[serde(rename = "permittivity_f_per_m")]
    pub permittivity: f64,
    /// Largest voltage either way (V).
    #[serde(rename = "voltage_limit_v")]
    pub voltage_limit: f64,
    /// Fastest change of the voltage (V/s).
    #[serde(rename = "rate_limit_v_per_s")]
    pub rate_limit: f64,
    /// Gap of the major loop at 0 V over its span; 0 without the key.
    #[serde(rename = "hysteresis_width", default, skip_serializing_if = "Option::is_none")]
    pub hysteresis: Option<f64>,
    /// Identified weights instead (V), of either sign: row i from j = 0 to i.
    #[serde(rename = "hysteresis_weights_v", default, skip_serializing_if = "Option::is_none")]
    pub weights: Option<Vec<Vec<f64>>>,
    /// Share of the voltage beside them that is without hysteresis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub linear_share: Option<f64>,
}

fn default_modes() -> usize {
    MODES
}

impl KeyedFile for LinkFile {
    const SCHEMA: Schema = keys::SCHEMA;
    const DEFAULT: &'static str = EXAMPLE;

    fn conditions(&self, damaged: &[&str]) -> Vec<String> {
        physics::faults(self, damaged)
    }
}

impl LinkFile {
    /// Reads and checks `path`.
    ///
    /// # Errors
    /// One line that names the file, the key, its value and what is allowed.
    pub fn read(path: &Path) -> Result<Self, BadInput> {
        Self::parse(path, &file::read(path, LONGEST_FILE)?)
    }

    /// The link file in `bytes`; `path` is only named in errors.
    ///
    /// # Errors
    /// As [`LinkFile::read`].
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Self, BadInput> {
        keyed_file::parse(path, bytes)
    }

    /// Reads and checks `path`, and tells everything that is wrong with it.
    ///
    /// # Errors
    /// An error for each fault, as [`LinkFile::read`] has it for the first.
    pub fn faultless(path: &Path) -> Result<Self, Vec<BadInput>> {
        keyed_file::faultless(path)
    }

    /// A payload that is beyond the rating that the file states, a line.
    pub fn warning(&self) -> Option<String> {
        let LinkSection { payload, rated_payload, .. } = self.link;
        let rated = rated_payload.filter(|rated| payload > *rated)?;
        Some(format!("link.payload_kg = {payload} is more than link.rated_payload_kg = {rated}"))
    }

    /// Parameters of the link with `K` modes; of a single damping ratio every mode has it.
    pub fn params<const K: usize>(&self) -> LinkParams<f64, K> {
        let link = &self.link;
        let damping = |mode: usize| link.damping_ratios.get(mode).or(link.damping_ratios.last());
        LinkParams {
            length: link.length,
            bending_stiffness: link.bending_stiffness,
            linear_density: link.linear_density,
            thickness: link.thickness,
            payload_mass: link.payload,
            payload_inertia: link.payload_inertia,
            damping: std::array::from_fn(|mode| damping(mode).copied().unwrap_or_default()),
            gravity: link.gravity,
            patch: self.piezo.as_ref().map(PiezoSection::span),
        }
    }

    /// The patch, where there is one.
    ///
    /// # Errors
    /// As [`PiezoParams::build`].
    pub fn patch(&self) -> Result<Option<Piezo<f64, LEVELS, MEMORY>>, Error> {
        self.piezo.as_ref().map(|piezo| piezo.build(self.link.thickness)).transpose()
    }
}

impl PiezoSection {
    fn span(&self) -> Span<f64> {
        Span { start: self.start, end: self.end }
    }

    fn build(&self, link_thickness: f64) -> Result<Piezo<f64, LEVELS, MEMORY>, Error> {
        let params = PiezoParams {
            span: self.span(),
            width: self.width,
            thickness: self.thickness,
            link_thickness,
            youngs_modulus: self.youngs_modulus,
            charge_constant: self.charge_constant,
            permittivity: self.permittivity,
            voltage_limit: self.voltage_limit,
            rate_limit: self.rate_limit,
            hysteresis: self.hysteresis.unwrap_or(0.0),
        };
        let Some(rows) = &self.weights else { return params.build(CONTROL_PERIOD) };
        let table = HysteresisTable::from_fn(self.voltage_limit, rows.len(), |i, j| rows[i][j]);
        params.build_with(&table.signed_weights()?, self.linear_share.unwrap_or(1.0), CONTROL_PERIOD)
    }
}
