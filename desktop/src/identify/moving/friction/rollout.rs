//! The friction block of the gear file, simulated over a measured motion.
//!
//! ```text
//! tau_motor = M*J*a + w + F(v, w, theta) + waves        w = r*tau_out where measured, else
//! w = g0 + g1*r*theta + M*r^2*J_fs*a + r*F_out(r*v)     J = J_wg + r^2*J_fs; where w is measured J_wg
//! ```
//!
//! F is [`strainwave::friction::JointFriction`] in f64, the law of the firmware; w, what the motor bears of the load, is what its
//! load factors act on. F_out is the output's friction as the base gear has it.

use strainwave::Error;
use strainwave::friction::{FrictionModel, FrictionParams, JointFriction, JointFrictionState, Slip};

use super::motion::{Motion, STEP, STEPS_A_ROW, Step};
use super::spectrum::direction;
use super::unknowns::{Change, Unknown};
use crate::io::gear_file::friction_params::joint_friction_params;
use crate::io::gear_file::{Friction, GearFile};

/// A joint over a motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rollout<'a> {
    /// What the unknowns change.
    pub gear: &'a GearFile,
    /// Over which.
    pub motion: &'a Motion,
    /// The motor moved forwards, and backwards.
    pub directions: [bool; 2],
}

/// Unknowns beside the block.
#[derive(Clone, Copy, Debug, Default)]
struct Beside {
    offset: f64,
    slope: f64,
    inertia: f64,
    start: f64,
}

impl Rollout<'_> {
    /// The side that these unknowns make.
    pub fn side(&self, unknowns: &[Unknown], z: &[f64]) -> Friction {
        let mut side = self.gear.friction.input.clone();
        Change::of(unknowns, z).put_into(&mut side, self.directions);
        side
    }

    /// Torque of the motor in every row (N m).
    ///
    /// # Errors
    /// When the block cannot be built.
    pub fn torques(&self, unknowns: &[Unknown], z: &[f64]) -> Result<Vec<f64>, Error> {
        let side = self.side(unknowns, z);
        let params = joint_friction_params::<f64>(&side).ok_or(Error::OutOfRange("friction.input.model"))?;
        let model = params.build()?;
        let beside = self.beside(unknowns, z);
        let waves = waves(unknowns, z, self.gear.friction.input.coulomb.unwrap_or_default());
        let mut state = started(&model, beside.start * params.presliding);
        let mut torques = Vec::with_capacity(self.motion.steps.len() / STEPS_A_ROW);
        for (k, step) in self.motion.steps.iter().enumerate() {
            let (inertial, load) = self.load(&beside, step);
            let slip = Slip { wave_generator: step.heading, ..Slip::new(step.speed, STEP) };
            let friction = model.step(&mut state, &slip.under(0.0, load)).force;
            if k % STEPS_A_ROW == STEPS_A_ROW - 1 {
                torques.push(inertial + load + friction + waves.iter().map(|wave| wave(step)).sum::<f64>());
            }
        }
        Ok(torques)
    }

    /// Torque of the inertia that is not in the load, and the load (N m).
    fn load(&self, beside: &Beside, step: &Step) -> (f64, f64) {
        let r: f64 = self.gear.gear.signed_ratio().value();
        let inertia = &self.gear.inertia;
        let turned = beside.inertia * step.acceleration;
        let load = if step.reflected.is_finite() {
            step.reflected
        } else {
            beside.slope * step.output + turned * r * r * inertia.flexspline + step.output_friction
        };
        (turned * inertia.wave_generator, beside.offset + load)
    }

    fn beside(&self, unknowns: &[Unknown], z: &[f64]) -> Beside {
        let r: f64 = self.gear.gear.signed_ratio().value();
        let weight = r.abs() * self.gear.gear.peak_torque;
        let mut beside = Beside { inertia: 1.0, ..Beside::default() };
        for (unknown, z) in unknowns.iter().zip(z) {
            match unknown {
                Unknown::Offset => beside.offset += weight * z,
                Unknown::Slope => beside.slope += weight * z,
                Unknown::Inertia => beside.inertia += z,
                Unknown::Start => beside.start += z,
                Unknown::Of(_) | Unknown::Sine(_) | Unknown::Cosine(_) => {}
            }
        }
        beside
    }
}

/// A contact that has come from one without tension by a stroke (rad).
fn started(model: &JointFriction<f64>, stroke: f64) -> JointFrictionState<f64> {
    let mut state = JointFrictionState::default();
    model.step(&mut state, &Slip::new(stroke, 1.0));
    state
}

/// Torque of each wave (N m).
fn waves<'a>(unknowns: &'a [Unknown], z: &'a [f64], scale: f64) -> Vec<impl Fn(&Step) -> f64 + use<'a>> {
    let wave = move |(unknown, z): (&Unknown, &f64)| {
        let (wave, cosine) = match *unknown {
            Unknown::Sine(wave) => (wave, false),
            Unknown::Cosine(wave) => (wave, true),
            _ => return None,
        };
        let amplitude = z * scale;
        Some(move |step: &Step| {
            let (sine, other) = (f64::from(wave.order) * step.angle).sin_cos();
            let sign = if wave.reverses { direction(step) } else { 1.0 };
            amplitude * sign * if cosine { other } else { sine }
        })
    };
    unknowns.iter().zip(z).filter_map(wave).collect()
}
