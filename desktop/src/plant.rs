//! The plant: motor, gear in the reference build, load and encoders, at 10 kHz from outside.
//!
//! ```text
//! J_wg * domega_wg = tau_motor - (tau_wg - J_wg*domega_wg)        the gear's two-port gives the bracket
//! ```
//!
//! Motor torque and load are held over a control period (zero-order hold) and integrated in
//! micro-steps of semi-implicit Euler, as many as keep the mesh below its stable step. The power
//! that enters both ports is accounted for micro-step by micro-step.
//!
//! Where thousands of runs are asked for, the mesh is condensed ([`Plant::condensed`]): the same links reduced to one
//! law in f64, exact in harmonic 0 ([`strainwave::flexspline::reduced`]), and all else as it is. What is left to
//! resolve are the torsion mode and the presliding of friction, below 1000 rad/s, so a control period takes
//! [`CONDENSED_STEPS`] micro-steps.

use strainwave::compensator::MESH;
use strainwave::flexspline::{Flexspline, FlexsplineParams, Mesh, Reduced};
use strainwave::friction::{JointFriction, JointFrictionState};
use strainwave::gear::{Applied, Gear, GearParams, GearState, Motion, Torques};
use strainwave::{Angle, Error};

use crate::divergence::{Diverged, may_go_on};
use crate::joint::CONTROL_PERIOD;
use crate::vectorised::Vectorised;

/// Nodes around and along the axis of the plant's mesh.
pub const NODES: (usize, usize) = (36, 4);
/// Levels of the reference hysteresis.
pub const LEVELS: usize = 64;
/// Turning points that it remembers.
pub const MEMORY: usize = 128;
/// Largest micro-step as a share of the mesh's stable step.
pub const STEP_SHARE: f64 = 0.95;

/// Micro-steps of a control period with the mesh condensed.
pub const CONDENSED_STEPS: usize = 4;

/// A reference flexspline, f64 and literal eq. (6), with this processor's vector instructions.
pub type FastMesh<const N: usize, const M: usize> = Vectorised<Mesh<f64, N, M>>;
/// A reference gear around a flexspline.
pub type ReferenceGear<F> = Gear<f64, F, JointFriction<f64>, LEVELS, MEMORY>;
/// Its state.
pub type ReferenceState<F> = GearState<f64, <F as Flexspline<f64>>::State, JointFrictionState<f64>, MEMORY>;

/// A reference mesh and the micro-steps that it takes in a control period.
pub struct Reference<const N: usize, const M: usize> {
    /// The mesh, stepped by `dt`.
    pub mesh: FastMesh<N, M>,
    /// Micro-step (s).
    pub dt: f64,
    /// Micro-steps in a control period.
    pub steps: usize,
}

impl<const N: usize, const M: usize> Reference<N, M> {
    /// Builds the mesh with the longest micro-step that divides the control period and is no longer than `longest`
    /// (s), or than [`STEP_SHARE`] of the stable one.
    ///
    /// # Errors
    /// As [`Mesh::build`].
    pub fn build(params: &FlexsplineParams<f64>, longest: Option<f64>) -> Result<Self, Error> {
        params.check()?;
        let longest = longest.unwrap_or_else(|| STEP_SHARE * Mesh::<f64, N, M>::stable_step(params));
        let steps = micro_steps(longest);
        let dt = CONTROL_PERIOD / steps;
        Ok(Self { mesh: Vectorised::new(Mesh::build(params, dt)?), dt, steps: steps as usize })
    }
}

/// The fewest equal steps of a control period that are no longer than `longest` (s), which a period that is a
/// multiple of it may exceed by its rounding.
pub fn micro_steps(longest: f64) -> f64 {
    (CONTROL_PERIOD / longest * (1.0 - 1e-12)).ceil()
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

/// The plant's mesh as it is.
pub type PlantMesh = FastMesh<{ NODES.0 }, { NODES.1 }>;
/// The mesh condensed to one law, which is that of every mesh.
pub type CondensedMesh = Reduced<f64, { MESH.0 }, { MESH.1 }>;

/// Motor, gear and load around a flexspline.
#[derive(Clone)]
pub struct Plant<F: Flexspline<f64> = PlantMesh> {
    gear: ReferenceGear<F>,
    state: ReferenceState<F>,
    /// Micro-step (s) and how many of them a control period has.
    dt: f64,
    steps: usize,
    /// Micro-steps since the start.
    taken: u64,
    wave_generator: Motion<f64>,
    flange: Motion<f64>,
    wave_generator_inertia: f64,
    flexspline_inertia: f64,
    energy: Energy,
    energy_at_rest: f64,
    torques: Torques<f64>,
}

impl Plant {
    /// The reference at rest at the zero angle.
    ///
    /// # Errors
    /// As [`GearParams::build`].
    pub fn build(params: &GearParams<f64>) -> Result<Self, Error> {
        let Reference { mesh, dt, steps } = Reference::build(&params.flexspline, None)?;
        Self::around(params, mesh, dt, steps)
    }
}

impl Plant<CondensedMesh> {
    /// The same with its mesh condensed, some hundred times as fast.
    ///
    /// # Errors
    /// As [`GearParams::build`].
    pub fn condensed(params: &GearParams<f64>) -> Result<Self, Error> {
        let mesh = Reduced::build(&params.flexspline, params.rated_torque)?;
        Self::around(params, mesh, CONTROL_PERIOD / CONDENSED_STEPS as f64, CONDENSED_STEPS)
    }
}

impl<F: Flexspline<f64>> Plant<F> {
    fn around(params: &GearParams<f64>, flexspline: F, dt: f64, steps: usize) -> Result<Self, Error> {
        let gear: ReferenceGear<F> = params.build(flexspline, dt)?;
        let mut plant = Self {
            state: gear.rest(),
            gear,
            dt,
            steps,
            taken: 0,
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
    ///
    /// # Errors
    /// When the mesh has diverged.
    pub fn step(&mut self, motor_torque: f64, load: f64) -> Result<(), Diverged> {
        let inertia = self.wave_generator_inertia;
        let applied = Applied { motor: motor_torque, load };
        self.period(applied, |resistance| (motor_torque, (motor_torque - resistance) / inertia))
    }

    /// One control period with the wave generator held by a brake.
    ///
    /// # Errors
    /// When the mesh has diverged.
    pub fn step_blocked(&mut self, load: f64) -> Result<(), Diverged> {
        self.wave_generator.velocity = 0.0;
        self.period(Applied { motor: 0.0, load }, |resistance| (resistance, 0.0))
    }

    /// One control period; `motor` answers to what resists it (N m) with its torque (N m) and acceleration (rad/s^2).
    fn period(&mut self, applied: Applied<f64>, motor: impl Fn(f64) -> (f64, f64)) -> Result<(), Diverged> {
        for _ in 0..self.steps {
            let torques = self.gear.torques(&mut self.state, &self.wave_generator, &self.flange, applied);
            let (motor_torque, acceleration) = motor(torques.wave_generator);
            self.micro_step(&torques, acceleration, motor_torque, applied.load);
            if !may_go_on(&torques) {
                break;
            }
        }
        let time = self.taken as f64 * self.dt;
        Diverged::check(time, self.gear.flexspline(), self.state.flexspline(), &self.torques)
    }

    fn micro_step(&mut self, torques: &Torques<f64>, acceleration: f64, motor_torque: f64, load: f64) {
        let dt = self.dt;
        let before = (self.wave_generator.velocity, self.flange.velocity);
        self.wave_generator.advance(acceleration, dt);
        self.flange.advance(self.gear.flange_acceleration(torques, load), dt);
        self.torques = *torques;
        self.taken += 1;
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
        0.5 * kinetic + self.gear.flexspline_energy(&self.state, &self.wave_generator, &self.flange)
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
