//! Plant sample: parameters, structure, sides, sensors and clock that differ from its controller's gear file.
//!
//! Drawn by [`super::unknowns`]; seeds 1 to 999 are for choosing gains, claims are judged from 10 000 on.

use strainwave::Error;
use strainwave::gear::GearParams;

use super::clock::ClockParams;
use super::friction::{Drift, PlantFrictionParams, Structure};
use super::{PlantParams, Sides, with_friction};
use crate::design::joint::firmware_gear_params;
use crate::io::gear_file::GearFile;
use crate::plant::box_sample::BoxSample;
use crate::sensor::EncoderErrors;

/// A plant.
#[derive(Clone, Debug, PartialEq)]
pub struct PlantSample {
    /// From which it is drawn.
    pub seed: u64,
    /// Gear file of its controller, with the bits of this joint's encoders.
    pub known: GearFile,
    /// The gear's true parameters.
    pub params: GearParams<f64>,
    /// The structure of its friction, on both sides.
    pub structure: Structure,
    /// Drift of that friction.
    pub drift: Option<Drift>,
    /// Drive, motor and load.
    pub sides: Sides,
    /// Errors of the motor's and of the output's encoder.
    pub encoders: [EncoderErrors; 2],
    /// When the control step runs.
    pub clock: ClockParams,
}

impl PlantSample {
    /// The plant that a gear file describes, with factors from the box of `seed` (see [`BoxSample::from_seed`]).
    ///
    /// # Errors
    /// As [`firmware_gear_params`].
    pub fn boxed(file: &GearFile, seed: u64) -> Result<Self, Error> {
        Ok(Self {
            seed,
            known: file.clone(),
            params: BoxSample::from_seed(seed).apply(&firmware_gear_params(file)?),
            structure: Structure::default(),
            drift: None,
            sides: Sides::IDEAL,
            encoders: [EncoderErrors::default(); 2],
            clock: ClockParams::default(),
        })
    }

    /// The gear with its true friction.
    pub fn plant_params(&self) -> PlantParams {
        let params = &self.params;
        let flange = self.sides.load.rigid(params.flexspline_inertia);
        let sides =
            [(params.input_friction, params.wave_generator_inertia), (params.output_friction, flange)];
        let friction = sides.map(|(joint, inertia)| PlantFrictionParams {
            structure: self.structure,
            drift: self.drift,
            ..PlantFrictionParams::of(joint, inertia)
        });
        with_friction(params, friction)
    }
}
