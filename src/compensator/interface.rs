//! Inputs and outputs of the control step.
//!
//! Inputs may be any bits: [`super::sense::validation`] makes them finite and bounded. Outputs always are. Units: rad,
//! rad/s, N m; signs as in [`crate::gear`].

use crate::angle::Angle;
use crate::compensator::actuate::mode::Mode;
use crate::compensator::adapt::parameters::Factors;
use crate::compensator::signals::{Estimate, Status};
use crate::compensator::{Command, Directions, Faults};
use crate::real::Real;

/// Sensor readings of one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensors<R> {
    /// Motor (wave-generator) encoder, raw count within the revolution.
    pub motor_encoder: u32,
    /// Output (flexspline) encoder, raw count within the revolution.
    pub output_encoder: Option<u32>,
    /// Torque of the motor at its shaft (N m).
    pub motor_torque: R,
    /// Torque through the flexspline from a strain gauge (N m).
    pub output_torque: Option<R>,
}

/// Input of one control step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Input<R> {
    /// The joint's sensors.
    pub sensors: Sensors<R>,
    /// Command of the outer controller, read once a round ([`crate::compensator::schedule::SLOW_PERIODS`] control
    /// periods).
    pub command: Command<R>,
    /// Gains of the compensation functions, for either direction of the output.
    pub gains: Directions<R>,
    /// Time since the sensors of the last step were read (s); 0 where it is not measured: then one control period.
    pub elapsed: R,
    /// Age of the command (s); 0 where it is fresh or unknown.
    pub setpoint_age: R,
    /// Status of this reading, from the board.
    pub status: Status,
}

/// Command of one step: finite and bounded for any input bits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Commanded<R> {
    /// Torque command to the motor (N m).
    pub motor_torque: R,
    /// Faults of the step.
    pub faults: Faults,
    /// Whether the drive may be on.
    pub mode: Mode,
}

/// Command, references and estimates of one step: finite and bounded for any input bits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Output<R: Real> {
    /// Torque command to the motor (N m).
    pub motor_torque: R,
    /// Feed-forward part of it (N m).
    pub feed_forward_torque: R,
    /// Reference angle of the motor.
    pub motor_reference: Angle<R>,
    /// Estimates of the observer's last slot.
    pub estimate: Estimate<R>,
    /// This step was a slot of the observer.
    pub observed: bool,
    /// Learnt factors of the joint as applied, times the adaptation's gain.
    pub factors: Factors<R>,
    /// Faults of the step.
    pub faults: Faults,
    /// Whether the drive may be on.
    pub mode: Mode,
}
