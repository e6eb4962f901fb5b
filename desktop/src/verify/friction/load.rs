//! The load-dependent level with the factors identified on a measured actuator (`erob80/erob80_100_m*.json`).

use serde::Deserialize;
use strainwave::friction::{LoadDependenceParams, LoadedLevel};

use crate::io::data;
use crate::io::file::{self, BadInput};
use crate::verify::bounds;
use crate::verify::{Measured, largest};

/// Longest file (bytes).
const LONGEST: u64 = 1 << 16;
/// Torque of the motor and external torque (N m), speed (rad/s).
const POINTS: [(f64, f64, f64); 4] =
    [(0.0, 0.0, 0.0), (10.0, 5.0, 0.1), (30.0, -20.0, 0.5), (50.0, 0.0, 2.0)];
/// Friction at these points (N m), by the identified models' own program, to 6 decimals.
const MODELS: [(&str, [f64; 4]); 3] = [
    ("erob80/erob80_100_m3.json", [4.832281, 5.572185, 12.231325, 12.231325]),
    ("erob80/erob80_100_m4.json", [4.381795, 5.211843, 12.485421, 4.506848]),
    ("erob80/erob80_100_m6.json", [5.226901, 5.970871, 8.632241, 4.462183]),
];

/// Identified parameters; what a model lacks is zero (N m), (rad/s), (1/(N m)).
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Identified {
    friction_base: f64,
    friction_stribeck: f64,
    load_friction_base: f64,
    load_friction_stribeck: f64,
    load_friction_motor: f64,
    load_friction_external: f64,
    load_friction_motor_stribeck: f64,
    load_friction_external_stribeck: f64,
    load_friction_motor_quad: f64,
    load_friction_external_quad: f64,
    dtheta_stribeck: f64,
    alpha: f64,
}

impl Identified {
    /// The library's parameters: a model without direction has one factor for both torques.
    pub fn params(&self) -> LoadDependenceParams<f64> {
        LoadDependenceParams {
            sliding: LoadedLevel {
                unloaded: self.friction_base,
                motor: self.load_friction_base + self.load_friction_motor,
                external: self.load_friction_base + self.load_friction_external,
            },
            stribeck: LoadedLevel {
                unloaded: self.friction_stribeck,
                motor: self.load_friction_stribeck + self.load_friction_motor_stribeck,
                external: self.load_friction_stribeck + self.load_friction_external_stribeck,
            },
            motor_squared: self.load_friction_motor_quad,
            external_squared: self.load_friction_external_quad,
        }
    }

    /// w(v): 0 for a model without Stribeck effect.
    fn stribeck_weight(&self, speed: f64) -> f64 {
        if self.dtheta_stribeck > 0.0 {
            (-(speed / self.dtheta_stribeck).powf(self.alpha)).exp()
        } else {
            0.0
        }
    }

    /// Largest distance from these values at [`POINTS`] (N m).
    fn distance(&self, expected: &[f64; 4]) -> Result<f64, strainwave::Error> {
        let model = self.params().build()?;
        let levels =
            POINTS.map(|(motor, external, speed)| model.level(motor, external, self.stribeck_weight(speed)));
        Ok(largest(levels.iter().zip(expected).map(|(level, expected)| (level - expected).abs())))
    }
}

pub(super) fn measure() -> Result<Measured, BadInput> {
    let mut distances = Vec::new();
    for (name, expected) in &MODELS {
        let Some(path) = data::find(name) else {
            return Ok(Measured::skipped(format!("friction.load.*: skipped: no data ({name})")));
        };
        let bytes = file::read(&path, LONGEST)?;
        let identified: Identified =
            serde_json::from_slice(&bytes).map_err(|error| BadInput::new(&path, error))?;
        distances.push(identified.distance(expected).map_err(|error| BadInput::new(&path, error))?);
    }
    Ok(vec![bounds::figure("friction.load.erob80", largest(distances))].into())
}
