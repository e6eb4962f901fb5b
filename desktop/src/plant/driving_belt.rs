//! Tooth belt between the plant's motor and its wave generator.
//!
//! ```text
//! J_rotor * d2theta_m  = tau_motor - tau_1
//! J_wg    * d2theta_wg = tau_belt - (tau_wg - J_wg*d2theta_wg)
//! ```
//!
//! tau_1 and tau_belt are the torques of the belt on its pulleys, as [`strainwave::belt`] has them, of spans of [`NODES`] nodes each or
//! of massless ones; the inertias have the belt that moves with them. Friction is that of the gear, at the wave generator.
//!
//! Discretisation: semi-implicit Euler, so many steps in a micro-step of the plant as take `STEP_SHARE` of the chain's stable step; the wave
//! generator goes on at its speed meanwhile and feels the mean torque. The plant's micro-step has to take the mode of motor and wave
//! generator on the belt in four a radian.

use strainwave::Error;
use strainwave::belt::{Belt, BeltParams, BeltState};
use strainwave::friction::{FrictionModel, Viscous, ViscousParams};
use strainwave::gear::{Applied, Motion};

/// Nodes of either span.
pub const NODES: usize = 8;
/// Longest step as a fraction of the chain's stable one.
const STEP_SHARE: f64 = 0.5;
/// Longest micro-step of the plant, in radians of the belt's mode.
const LONGEST_ANGLE: f64 = 0.25;

/// Belt with frictionless pulleys.
pub type DrivingBeltParams = BeltParams<f64, ViscousParams<f64>>;

/// Whether the spans have a mass of their own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Spans {
    /// A chain of [`NODES`] masses each.
    #[default]
    Chain,
    /// Massless.
    Massless,
}

/// A belt of spans of `N` nodes, as it is now.
#[derive(Clone)]
struct Stepped<const N: usize> {
    belt: Belt<f64, Viscous<f64>, N>,
    state: BeltState<f64, <Viscous<f64> as FrictionModel<f64>>::State, N>,
}

/// Motor and belt of a plant.
#[derive(Clone)]
pub struct DrivingBelt {
    spans: Built,
    motor: Motion<f64>,
    motor_inertia: f64,
    wave_generator_inertia: f64,
    /// Step of the belt (s), and how many a micro-step has.
    dt: f64,
    steps: usize,
    /// Work of the motor's shaft and of the belt on the wave generator, and what the belt's dampers took (J).
    energy: [f64; 3],
}

#[derive(Clone)]
enum Built {
    Chain(Box<Stepped<NODES>>),
    Massless(Box<Stepped<0>>),
}

/// Torques of a step on motor and wave generator (N m), and the power that the dampers take (W).
struct Pull {
    motor: f64,
    wave_generator: f64,
    loss: f64,
}

impl<const N: usize> Stepped<N> {
    fn build(params: &DrivingBeltParams, dt: f64) -> Result<Self, Error> {
        let belt = params.build::<N>(dt)?;
        Ok(Self { state: belt.rest(), belt })
    }

    fn step(&mut self, motor: &Motion<f64>, wave_generator: &Motion<f64>) -> Pull {
        let torques = self.belt.torques(&mut self.state, motor, wave_generator, Applied::default());
        Pull { motor: torques.motor, wave_generator: torques.transmitted, loss: torques.damping_loss }
    }

    fn stored(&self, motor: &Motion<f64>, wave_generator: &Motion<f64>) -> f64 {
        self.belt.chain().energy(&self.state.chain, &self.belt.ends(motor, wave_generator))
    }
}

impl DrivingBelt {
    /// At rest, for a plant of this micro-step (s).
    ///
    /// # Errors
    /// As [`BeltParams::build`]; `dt` where the micro-step is too long for the mode of motor and wave generator on the belt.
    pub fn build(params: &DrivingBeltParams, spans: Spans, micro_step: f64) -> Result<Self, Error> {
        let nodes = if spans == Spans::Chain { NODES } else { 0 };
        let [motor_inertia, wave_generator_inertia] =
            [&params.motor, &params.output].map(|pulley| params.inertia(pulley, nodes));
        let ratio = params.radius(&params.motor) / params.radius(&params.output);
        let inverse_inertia = 1.0 / wave_generator_inertia + ratio * ratio / motor_inertia;
        if micro_step * (params.torsional_stiffness() * inverse_inertia).sqrt() > LONGEST_ANGLE {
            return Err(Error::OutOfRange("dt"));
        }
        let steps = (micro_step / (STEP_SHARE * params.stable_step(nodes))).ceil();
        let dt = micro_step / steps;
        Ok(Self {
            spans: match spans {
                Spans::Chain => Built::Chain(Box::new(Stepped::build(params, dt)?)),
                Spans::Massless => Built::Massless(Box::new(Stepped::build(params, dt)?)),
            },
            motor: Motion::default(),
            motor_inertia,
            wave_generator_inertia,
            dt,
            steps: steps as usize,
            energy: [0.0; 3],
        })
    }

    /// J_wg with its pulley and the belt that moves with it (kg m^2).
    pub fn wave_generator_inertia(&self) -> f64 {
        self.wave_generator_inertia
    }

    /// Motion of the motor.
    pub fn motor(&self) -> Motion<f64> {
        self.motor
    }

    /// A micro-step under a torque on the motor's shaft (N m), none where a brake holds it; the mean torque on the wave generator (N m).
    pub fn step(&mut self, shaft: Option<f64>, wave_generator: &Motion<f64>) -> f64 {
        let mut at = *wave_generator;
        let mut sum = 0.0;
        for _ in 0..self.steps {
            let pull = match &mut self.spans {
                Built::Chain(stepped) => stepped.step(&self.motor, &at),
                Built::Massless(stepped) => stepped.step(&self.motor, &at),
            };
            let before = self.motor.velocity;
            match shaft {
                Some(torque) => self.motor.advance((torque - pull.motor) / self.motor_inertia, self.dt),
                None => self.motor.velocity = 0.0,
            }
            let [from_motor, to_gear, lost] = &mut self.energy;
            *from_motor += shaft.unwrap_or(0.0) * 0.5 * (before + self.motor.velocity) * self.dt;
            *to_gear += pull.wave_generator * at.velocity * self.dt;
            *lost += pull.loss * self.dt;
            at.advance(0.0, self.dt);
            sum += pull.wave_generator;
        }
        sum / self.steps as f64
    }

    /// Work of the motor since the start, and what of it is missing among the work on the wave generator, what the belt's dampers took
    /// and what motor and belt have stored (J).
    pub fn balance(&self, wave_generator: &Motion<f64>, at_rest: f64) -> [f64; 2] {
        let [from_motor, to_gear, lost] = self.energy;
        [from_motor, from_motor - to_gear - lost - (self.stored(wave_generator) - at_rest)]
    }

    /// Energy of motor and belt (J).
    pub fn stored(&self, wave_generator: &Motion<f64>) -> f64 {
        let kinetic = 0.5 * self.motor_inertia * self.motor.velocity.powi(2);
        kinetic
            + match &self.spans {
                Built::Chain(stepped) => stepped.stored(&self.motor, wave_generator),
                Built::Massless(stepped) => stepped.stored(&self.motor, wave_generator),
            }
    }
}
