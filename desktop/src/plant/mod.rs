//! Plant: motor, gear in the reference build, load and encoders, at 10 kHz from outside.
//!
//! ```text
//! J_wg * domega_wg = tau_motor - (tau_wg - J_wg*domega_wg)        the gear's two-port gives the bracket
//! ```
//!
//! Motor torque and load are held over a control period (zero-order hold) and integrated in
//! micro-steps of semi-implicit Euler, as many as keep the mesh below its stable step. The power
//! that enters both ports is accounted for micro-step by micro-step.
//!
//! For thousands of runs the mesh is condensed ([`Plant::condensed`]): the same links reduced to one
//! law in f64, exact in harmonic 0 ([`strainwave::flexspline::reduced`]), and all else as it is. What is left to
//! resolve are the torsion mode and the presliding of friction, below 1000 rad/s, so a control period takes
//! [`CONDENSED_STEPS`] micro-steps.
//!
//! A real joint has more on both sides than this: a drive that is late and a motor that cogs, a load that is flexible and
//! hangs. [`Sides`] has all of it; [`Sides::IDEAL`] has none, and costs nothing but a few comparisons. What a plant may be
//! off by, and how it is drawn, stands in [`unknowns`]. A tooth belt may lie between motor and wave generator ([`driving_belt`]).

pub mod belt;
pub mod box_sample;
pub mod clock;
pub mod cogging;
pub(crate) mod curve;
pub mod divergence;
pub mod drive;
pub mod driving_belt;
pub mod friction;
pub mod link;
pub mod load_side;
pub mod measured;
pub mod mesh_size;
pub mod payload;
pub mod sample;
pub mod sample_stream;
pub mod settled;
pub mod two_port;
pub mod unknowns;
pub mod vectorised;

use strainwave::Error;
use strainwave::compensator::MESH;
use strainwave::flexspline::{Flexspline, FlexsplineParams, Mesh, Reduced};
use strainwave::friction::{JointFriction, JointFrictionState};
use strainwave::gear::{Applied, Gear, GearParams, GearState, Motion, Torques};

use crate::plant::divergence::{Diverged, may_go_on};
use crate::plant::vectorised::Vectorised;
use cogging::Cogging;
use drive::{Drive, DriveParams};
use driving_belt::{DrivingBelt, DrivingBeltParams, Spans};
use friction::{PlantFriction, PlantFrictionParams, PlantFrictionState};
use load_side::{Load, LoadParams};
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Nodes around and along the axis of the plant's mesh.
pub const NODES: (usize, usize) = (36, 4);
/// Levels of the reference hysteresis.
pub const LEVELS: usize = 64;
/// Turning points that it remembers.
pub const MEMORY: usize = 128;
/// Largest micro-step as a fraction of the mesh's stable step.
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

/// Energy balance since the start (J).
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

/// A gear whose friction may be of any structure.
type PlantGear<F> = Gear<f64, F, PlantFriction, LEVELS, MEMORY>;
type PlantState<F> = GearState<f64, <F as Flexspline<f64>>::State, PlantFrictionState, MEMORY>;

/// Drive, motor and load: the sides in front of the gear and behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sides {
    /// The drive.
    pub drive: DriveParams,
    /// The motor.
    pub motor: Cogging,
    /// The load.
    pub load: LoadParams,
}

impl Sides {
    /// The motor gives what is commanded, and the load is rigid with the flange.
    pub const IDEAL: Self = Self {
        drive: DriveParams::IDEAL,
        motor: Cogging::NONE,
        load: LoadParams { link: None, gravity: 0.0, hanging: 0.0 },
    };
}

/// The gear's parameters with the friction of a plant.
pub type PlantParams = GearParams<f64, PlantFrictionParams>;

/// The same gear with other friction on both sides.
pub fn with_friction<P, Q>(
    params: &GearParams<f64, P>,
    [input_friction, output_friction]: [Q; 2],
) -> GearParams<f64, Q> {
    GearParams {
        ratio: params.ratio,
        rated_torque: params.rated_torque,
        flexspline: params.flexspline,
        hysteresis_width: params.hysteresis_width,
        hysteresis_table: params.hysteresis_table,
        kinematic_error: params.kinematic_error,
        input_friction,
        output_friction,
        wave_generator_inertia: params.wave_generator_inertia,
        flexspline_inertia: params.flexspline_inertia,
    }
}

/// The gear with its own friction as a plant has it.
pub fn plant_params(params: &GearParams<f64>) -> PlantParams {
    let input = PlantFrictionParams::of(params.input_friction, params.wave_generator_inertia);
    with_friction(params, [input, PlantFrictionParams::of(params.output_friction, params.flexspline_inertia)])
}

/// A micro-step under way: what acts before anything moves.
pub(crate) struct MicroStep {
    /// Torque of the motor on its shaft (N m).
    motor: f64,
    /// Torque of the load on the flange (N m).
    load: f64,
    /// Torques in the gear.
    torques: Torques<f64>,
}

impl MicroStep {
    /// Torque of the gear on its flange, tau_t - tau_fric_out (N m).
    pub(crate) fn on_flange(&self) -> f64 {
        self.torques.transmitted - self.torques.output_friction
    }

    /// The micro-steps of the period may go on.
    pub(crate) fn may_go_on(&self) -> bool {
        may_go_on(&self.torques)
    }
}

/// Motor, gear and load around a flexspline.
#[derive(Clone)]
pub struct Plant<F: Flexspline<f64> = PlantMesh> {
    gear: PlantGear<F>,
    state: PlantState<F>,
    drive: Drive,
    motor: Cogging,
    /// Belt in front of the wave generator, and its motor.
    belt: Option<DrivingBelt>,
    load: Load,
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
        Self::between(&plant_params(params), &Sides::IDEAL)
    }

    /// The same between what a motor and a load have.
    ///
    /// # Errors
    /// As [`GearParams::build`].
    pub fn between(params: &PlantParams, sides: &Sides) -> Result<Self, Error> {
        Self::within(params, sides, None)
    }

    /// The same with micro-steps no longer than `longest` (s).
    pub(crate) fn within(params: &PlantParams, sides: &Sides, longest: Option<f64>) -> Result<Self, Error> {
        let Reference { mesh, dt, steps } = Reference::build(&params.flexspline, longest)?;
        Self::around(params, mesh, [dt, steps as f64], sides)
    }
}

impl Plant<CondensedMesh> {
    /// The same with its mesh condensed, some hundred times as fast.
    ///
    /// # Errors
    /// As [`GearParams::build`].
    pub fn condensed(params: &GearParams<f64>) -> Result<Self, Error> {
        Self::condensed_between(&plant_params(params), &Sides::IDEAL)
    }

    /// The same between what a motor and a load have.
    ///
    /// # Errors
    /// As [`GearParams::build`].
    pub fn condensed_between(params: &PlantParams, sides: &Sides) -> Result<Self, Error> {
        let mesh = Reduced::build(&params.flexspline, params.rated_torque)?;
        let steps = CONDENSED_STEPS as f64;
        Self::around(params, mesh, [CONTROL_PERIOD / steps, steps], sides)
    }
}

impl<F: Flexspline<f64>> Plant<F> {
    fn around(
        params: &PlantParams,
        flexspline: F,
        [dt, steps]: [f64; 2],
        sides: &Sides,
    ) -> Result<Self, Error> {
        let mut on_flange = *params;
        on_flange.flexspline_inertia = sides.load.rigid(params.flexspline_inertia);
        let gear: PlantGear<F> = on_flange.build(flexspline, dt)?;
        let mut plant = Self {
            state: gear.rest(),
            gear,
            drive: Drive::new(&sides.drive, dt),
            motor: sides.motor,
            belt: None,
            load: Load::new(&sides.load, params.flexspline_inertia),
            dt,
            steps: steps as usize,
            taken: 0,
            wave_generator: Motion::default(),
            flange: Motion::default(),
            wave_generator_inertia: params.wave_generator_inertia,
            flexspline_inertia: on_flange.flexspline_inertia,
            energy: Energy::default(),
            energy_at_rest: 0.0,
            torques: Torques::default(),
        };
        plant.energy_at_rest = plant.stored();
        Ok(plant)
    }

    /// The same with its motor in front of a belt; the inertia of the wave generator is that of the driven pulley.
    ///
    /// # Errors
    /// As [`DrivingBelt::build`].
    pub fn driven_by(self, belt: &DrivingBeltParams, spans: Spans) -> Result<Self, Error> {
        let belt = DrivingBelt::build(belt, spans, self.dt)?;
        Ok(Self { wave_generator_inertia: belt.wave_generator_inertia(), belt: Some(belt), ..self })
    }

    /// One control period under a torque command to the drive and an external torque on the output (N m).
    ///
    /// # Errors
    /// When the mesh has diverged.
    pub fn step(&mut self, motor_torque: f64, load: f64) -> Result<(), Diverged> {
        self.command(motor_torque, 0.0);
        self.go_on(self.steps, load)
    }

    /// Gives the drive a torque command (N m), `after` so many micro-steps from now, less than 1.
    pub fn command(&mut self, motor_torque: f64, after: f64) {
        self.drive.command(motor_torque, after);
    }

    /// So many micro-steps under an external torque on the output (N m).
    ///
    /// # Errors
    /// When the mesh has diverged.
    pub fn go_on(&mut self, steps: usize, load: f64) -> Result<(), Diverged> {
        for _ in 0..steps {
            let step = self.begin(load);
            self.end(&step, step.load, self.gear.flange_acceleration(&step.torques, step.load));
            if !step.may_go_on() {
                break;
            }
        }
        self.check()
    }

    /// Begins a micro-step: motor torque and torques in the gear under an external torque on the output (N m).
    pub(crate) fn begin(&mut self, load: f64) -> MicroStep {
        let on_shaft = self.drive.step();
        let motor = self.motor.torque(on_shaft, self.motor().angle);
        let motor = match &mut self.belt {
            Some(belt) => belt.step(Some(motor), &self.wave_generator),
            None => motor,
        };
        let (torques, load) = self.torques(motor, load);
        MicroStep { motor, load, torques }
    }

    /// Ends it with this acceleration of the flange (rad/s^2), which is that under this torque of the load (N m).
    pub(crate) fn end(&mut self, step: &MicroStep, load: f64, flange_acceleration: f64) {
        let acceleration = (step.motor - step.torques.wave_generator) / self.wave_generator_inertia;
        self.micro_step(&step.torques, [acceleration, flange_acceleration], step.motor, load);
    }

    /// The torque of the load on the flange that makes it accelerate so: J_fs*d2theta_fs - tau_t + tau_fric_out (N m).
    pub(crate) fn load_of(&self, step: &MicroStep, flange_acceleration: f64) -> f64 {
        self.flexspline_inertia * flange_acceleration - step.on_flange()
    }

    /// One control period with the motor held by a brake, without current.
    ///
    /// # Errors
    /// When the mesh has diverged.
    pub fn step_blocked(&mut self, load: f64) -> Result<(), Diverged> {
        self.drive.rest();
        if self.belt.is_none() {
            self.wave_generator.velocity = 0.0;
        }
        for _ in 0..self.steps {
            let pull = self.belt.as_mut().map(|belt| belt.step(None, &self.wave_generator));
            let (torques, load) = self.torques(pull.unwrap_or(0.0), load);
            let on_shaft = pull.unwrap_or(torques.wave_generator);
            let driven = (on_shaft - torques.wave_generator) / self.wave_generator_inertia;
            let accelerations = [driven, self.gear.flange_acceleration(&torques, load)];
            self.micro_step(&torques, accelerations, on_shaft, load);
            if !may_go_on(&torques) {
                break;
            }
        }
        self.check()
    }

    /// Torques in the gear under the motor's (N m), and the torque of the load on its flange (N m).
    fn torques(&mut self, motor: f64, load: f64) -> (Torques<f64>, f64) {
        let load = self.load.step(load, &self.flange, self.taken as f64 * self.dt, self.dt);
        let applied = Applied { motor, load };
        (self.gear.torques(&mut self.state, &self.wave_generator, &self.flange, applied), load)
    }

    /// The mesh has not diverged.
    ///
    /// # Errors
    /// When it has.
    pub(crate) fn check(&self) -> Result<(), Diverged> {
        let time = self.taken as f64 * self.dt;
        Diverged::check(time, self.gear.flexspline(), self.state.flexspline(), &self.torques)
    }

    /// `accelerations` of wave generator and flange (rad/s^2).
    fn micro_step(&mut self, torques: &Torques<f64>, accelerations: [f64; 2], motor_torque: f64, load: f64) {
        let dt = self.dt;
        let before = (self.wave_generator.velocity, self.flange.velocity);
        self.wave_generator.advance(accelerations[0], dt);
        self.flange.advance(accelerations[1], dt);
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

    /// Energy balance since the start.
    pub fn energy(&self) -> Energy {
        self.energy
    }

    /// Power balance since the start: what is missing, as a fraction of the energy moved.
    pub fn imbalance(&self) -> f64 {
        let energy = &self.energy;
        let came = energy.from_motor + energy.from_load;
        let went = self.stored() - self.energy_at_rest + energy.friction + energy.damping + energy.hysteresis;
        ((came - went) / energy.moved.max(f64::MIN_POSITIVE)).abs()
    }

    /// Motion of the motor.
    pub fn motor(&self) -> Motion<f64> {
        self.belt.as_ref().map_or(self.wave_generator, DrivingBelt::motor)
    }

    /// Motion of the wave generator.
    pub fn wave_generator(&self) -> Motion<f64> {
        self.wave_generator
    }

    /// Motion of the output.
    pub fn output(&self) -> Motion<f64> {
        self.flange
    }

    /// Torque of the motor as its drive measures it, by the nominal constant (N m).
    pub fn measured_motor_torque(&self) -> f64 {
        self.drive.measured()
    }

    /// Micro-step (s).
    pub fn micro_step_time(&self) -> f64 {
        self.dt
    }

    /// Micro-steps in a control period.
    pub fn micro_steps(&self) -> usize {
        self.steps
    }

    /// Torques of the last micro-step.
    pub fn last_torques(&self) -> &Torques<f64> {
        &self.torques
    }
}
