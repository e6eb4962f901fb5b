//! A log for tests: a motor on the default gear that moves by strokes of many sizes and speeds, its friction that of other parameters.

use strainwave::compensator::schedule::CONTROL_PERIOD;

use super::fit::Fit;
use super::motion::Motion;
use super::rollout::Rollout;
use super::unknowns::{Parameter, Unknown};
use crate::identify::replay::ReplayRow;
use crate::io::gear_file::GearFile;

/// The motion, and the motor's torque (N m) in every row of a fit.
pub(super) struct Strokes {
    gear: GearFile,
    motion: Motion,
    torque: Vec<f64>,
}

impl Strokes {
    /// Standard deviation of a row's torque (N m).
    pub const NOISE: f64 = 5e-3;
    /// Of the joint that was logged.
    const TRUTH: [(Parameter, f64); 2] = [(Parameter::Coulomb, 0.4), (Parameter::Stribeck, 0.5)];

    pub fn new() -> Self {
        let gear = GearFile::default_gear();
        let angle = |t: f64| (0.1 + t * t) * (2.0 * t).sin();
        let row = |k: u32| ReplayRow { motor: angle(f64::from(k) * CONTROL_PERIOD), ..ReplayRow::default() };
        let motion = Motion::of(&gear, &(0..60_000).map(row).collect::<Vec<_>>()).unwrap();
        let (unknowns, z): (Vec<_>, Vec<_>) =
            Self::TRUTH.map(|(of, z)| (Unknown::Of(of), z)).into_iter().unzip();
        let rollout = Rollout { gear: &gear, motion: &motion, directions: [true; 2] };
        let modelled = rollout.torques(&unknowns, &z).unwrap().into_iter().enumerate();
        let torque =
            modelled.map(|(k, torque)| torque + Self::NOISE * (9e3 * (k as f64).sin()).sin()).collect();
        Self { gear, motion, torque }
    }

    /// A fit of some unknowns to it.
    pub fn fit<'a>(&'a self, unknowns: &'a [Unknown]) -> Fit<'a> {
        let rollout = Rollout { gear: &self.gear, motion: &self.motion, directions: [true; 2] };
        Fit { rollout, torque: &self.torque, unknowns }
    }
}
