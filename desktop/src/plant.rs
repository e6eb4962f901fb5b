//! The plant: motor, gear in the reference build, load and encoders, at 10 kHz from outside.
//!
//! ```text
//! J_wg * domega_wg = tau_motor - (tau_wg - J_wg*domega_wg)        the gear's two-port gives the bracket
//! ```
//!
//! Motor torque and load are held over a control period (zero-order hold) and integrated in
//! micro-steps of semi-implicit Euler, as many as keep the mesh well below its stable step. The power
//! that enters both ports is accounted for micro-step by micro-step.

use strainwave::flexspline::Mesh;
use strainwave::gear::{Gear, GearParams, GearState, Motion, Torques};
use strainwave::{Angle, Error};

use crate::joint::CONTROL_PERIOD;
use crate::vectorised::Vectorised;

/// Nodes around and along the axis of the reference mesh.
pub const NODES: (usize, usize) = (36, 4);
/// Levels of the reference hysteresis.
pub const LEVELS: usize = 64;
/// Turning points that it remembers.
pub const MEMORY: usize = 128;
/// Largest micro-step as a share of the mesh's stable step.
pub const STEP_SHARE: f64 = 0.95;

/// The reference flexspline: f64, 36 x 4, literal eq. (6).
pub type ReferenceMesh = Mesh<f64, { NODES.0 }, { NODES.1 }>;
/// The same, with this processor's vector instructions.
pub type FastMesh = Vectorised<ReferenceMesh>;
/// The reference gear.
pub type ReferenceGear = Gear<f64, FastMesh, LEVELS, MEMORY>;
/// Its state.
pub type ReferenceState =
    GearState<f64, <ReferenceMesh as strainwave::flexspline::Flexspline<f64>>::State, MEMORY>;

/// A reference gear and the micro-steps that it takes in a control period.
pub struct Reference {
    /// The gear, stepped by `dt`.
    pub gear: ReferenceGear,
    /// Micro-step (s).
    pub dt: f64,
    /// Micro-steps in a control period.
    pub steps: usize,
}

impl Reference {
    /// Builds the mesh with a micro-step that divides the control period.
    ///
    /// # Errors
    /// As [`GearParams::build`].
    pub fn build(params: &GearParams<f64>) -> Result<Self, Error> {
        params.flexspline.check()?;
        let stable = ReferenceMesh::stable_step(&params.flexspline);
        let steps = (CONTROL_PERIOD / (STEP_SHARE * stable)).ceil();
        let dt = CONTROL_PERIOD / steps;
        let mesh = Vectorised::new(ReferenceMesh::build(&params.flexspline, dt)?);
        let gear = params.build(mesh, dt)?;
        Ok(Self { gear, dt, steps: steps as usize })
    }
}

/// Where the energy went since the start (J).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// In through the motor shaft.
    pub from_motor: f64,
    /// In through the load.
    pub from_load: f64,
    /// Sum of the magnitudes of what passed both ports.
    pub moved: f64,
    /// Lost in friction, both sides.
    pub friction: f64,
    /// Lost in the flexspline's damping.
    pub damping: f64,
    /// Taken by the hysteresis: lost, and stored until the loop closes.
    pub hysteresis: f64,
}

/// Motor, gear and load.
pub struct Plant {
    reference: Reference,
    state: ReferenceState,
    wave_generator: Motion<f64>,
    flange: Motion<f64>,
    wave_generator_inertia: f64,
    flexspline_inertia: f64,
    energy: Energy,
    energy_at_rest: f64,
    torques: Torques<f64>,
}

impl Plant {
    /// A plant at rest at the zero angle.
    ///
    /// # Errors
    /// As [`GearParams::build`].
    pub fn build(params: &GearParams<f64>) -> Result<Self, Error> {
        let reference = Reference::build(params)?;
        let state = reference.gear.rest();
        let mut plant = Self {
            reference,
            state,
            wave_generator: Motion::default(),
            flange: Motion::default(),
            wave_generator_inertia: params.wave_generator_inertia,
            flexspline_inertia: params.flexspline_inertia,
            energy: Energy::default(),
            energy_at_rest: 0.0,
            torques: Torques::default(),
        };
        plant.energy_at_rest = plant.stored();
        Ok(plant)
    }

    /// One control period under a motor torque and an external torque on the output (N m).
    pub fn step(&mut self, motor_torque: f64, load: f64) {
        for _ in 0..self.reference.steps {
            let torques = self.torques();
            let acceleration = (motor_torque - torques.wave_generator) / self.wave_generator_inertia;
            self.micro_step(&torques, acceleration, motor_torque, load);
        }
    }

    /// One control period with the wave generator held by a brake.
    pub fn step_blocked(&mut self, load: f64) {
        self.wave_generator.velocity = 0.0;
        for _ in 0..self.reference.steps {
            let torques = self.torques();
            self.micro_step(&torques, 0.0, torques.wave_generator, load);
        }
    }

    fn torques(&mut self) -> Torques<f64> {
        self.reference.gear.torques(&mut self.state, &self.wave_generator, &self.flange)
    }

    fn micro_step(&mut self, torques: &Torques<f64>, acceleration: f64, motor_torque: f64, load: f64) {
        let dt = self.reference.dt;
        let before = (self.wave_generator.velocity, self.flange.velocity);
        self.wave_generator.advance(acceleration, dt);
        self.flange.advance(self.reference.gear.flange_acceleration(torques, load), dt);
        self.torques = *torques;
        // Mean speeds make the kinetic part of the balance exact.
        let motor = 0.5 * dt * (before.0 + self.wave_generator.velocity);
        let output = 0.5 * dt * (before.1 + self.flange.velocity);
        let energy = &mut self.energy;
        energy.from_motor += motor_torque * motor;
        energy.from_load += load * output;
        energy.moved += (motor_torque * motor).abs() + (load * output).abs();
        energy.friction += torques.input_friction * motor + torques.output_friction * output;
        energy.damping += torques.damping_loss * dt;
        energy.hysteresis += torques.hysteresis * (torques.slope * motor - output);
    }

    /// Energy stored now, elastic and kinetic (J); the hysteresis' own is part of [`Energy::hysteresis`].
    fn stored(&self) -> f64 {
        let kinetic = self.wave_generator_inertia * self.wave_generator.velocity.powi(2)
            + self.flexspline_inertia * self.flange.velocity.powi(2);
        0.5 * kinetic + self.reference.gear.flexspline_energy(&self.state, &self.wave_generator, &self.flange)
    }

    /// Where the energy went since the start.
    pub fn energy(&self) -> Energy {
        self.energy
    }

    /// Power balance since the start: what is missing, as a share of the energy moved.
    pub fn imbalance(&self) -> f64 {
        let energy = &self.energy;
        let came = energy.from_motor + energy.from_load;
        let went = self.stored() - self.energy_at_rest + energy.friction + energy.damping + energy.hysteresis;
        ((came - went) / energy.moved.max(f64::MIN_POSITIVE)).abs()
    }

    /// Motion of the motor.
    pub fn motor(&self) -> Motion<f64> {
        self.wave_generator
    }

    /// Motion of the output.
    pub fn output(&self) -> Motion<f64> {
        self.flange
    }

    /// Torques of the last micro-step.
    pub fn last_torques(&self) -> &Torques<f64> {
        &self.torques
    }
}

/// Raw count of an encoder of 2^bits counts a turn.
pub fn encoder_count(angle: Angle<f64>, bits: u32) -> u32 {
    angle.phase() >> (32 - bits)
}
