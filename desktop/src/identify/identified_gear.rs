//! What is identified from held joints' logs ([`super::joint`]).

use super::covariance::Covariance;
use super::line::LIMITS;
use super::start::Start;
use super::{Excitation, HELD_LOG, NotIdentified};
use crate::io::gear_file::GearFile;

/// Identified gear, with its prediction errors.
#[derive(Clone, Debug, PartialEq)]
pub struct IdentifiedGear {
    /// The base gear with what was identified.
    pub gear: GearFile,
    /// K1, K2, K3 over the base gear's.
    pub stiffness_factor: f64,
    /// Relative standard error of the stiffness, the hysteresis being that of the base gear.
    pub stiffness_deviation: f64,
    /// Offset and start state of each log.
    pub starts: Vec<Start>,
    /// The weights; `None` where those of the base gear stay, as the torque of no log goes both ways.
    pub table: Option<IdentifiedTable>,
    /// Rms residual of the trained torsions (rad).
    pub training_rms: f64,
    /// The same of the torsions held out; `None` without any.
    pub held_out_rms: Option<f64>,
    /// Rms error of the base gear on them, its starts fitted to the trained part.
    pub base_held_out_rms: Option<f64>,
    /// c + phi at every sample of each log (rad).
    pub predicted: Vec<Vec<f64>>,
    /// The same of the base gear.
    pub base_predicted: Vec<Vec<f64>>,
    /// Samples of each log that trained.
    pub training: Vec<usize>,
    /// Of the stiffness factor, and where the weights were identified of their sum and the offsets.
    pub covariance: Covariance,
}

/// How the weights were found.
#[derive(Clone, Debug, PartialEq)]
pub struct IdentifiedTable {
    /// Rows of the table.
    pub levels: usize,
    /// lambda.
    pub smoothing: f64,
    /// Rms over the pieces that the cross-validation left out (rad).
    pub validation_rms: f64,
    /// Cells that the trained part moved.
    pub excitation: Excitation,
}

impl IdentifiedGear {
    /// What the logs do not show.
    pub fn not_identified(&self) -> Vec<NotIdentified> {
        let why = "the torque does not go both ways far enough";
        let hysteresis = || NotIdentified { what: "hysteresis".into(), why, helps: HELD_LOG };
        self.table.is_none().then(hysteresis).into_iter().collect()
    }

    /// Key of the stiffness where it ends at a limit of its search; with the factor on the base gear's.
    pub fn limits(&self) -> Vec<(&'static str, f64)> {
        let factor = self.stiffness_factor;
        let ends = LIMITS.contains(&factor.recip());
        ends.then_some(("stiffness.k1_nm_per_rad", factor)).into_iter().collect()
    }
}
