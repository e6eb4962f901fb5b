//! What runs on the joint controller, once every 0.1 ms.

use crate::angle::Angle;
use crate::real::Real;

/// What the joint's sensors report to one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensors<R> {
    /// Motor (wave-generator) encoder, raw count within the turn.
    pub motor_encoder: u32,
    /// Output (flexspline) encoder, raw count within the turn.
    pub output_encoder: Option<u32>,
    /// Torque of the motor at its shaft [N m].
    pub motor_torque: R,
    /// Torque through the flexspline from a strain gauge [N m].
    pub output_torque: Option<R>,
}

/// Where the output should be, with the derivatives that the feed-forward uses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Setpoint<R> {
    /// Output angle.
    pub position: Angle<R>,
    /// Output speed [rad/s].
    pub velocity: R,
    /// Output acceleration [rad/s^2].
    pub acceleration: R,
    /// Output jerk [rad/s^3].
    pub jerk: R,
}

/// How much of each correction is applied, 0..=1; changed at run time without a step in the output.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shares<R> {
    /// The cascaded feedback.
    pub feedback: R,
    /// Inertia of motor and load.
    pub inertia: R,
    /// Friction of both sides.
    pub friction: R,
    /// Wind-up: torsion, with hysteresis.
    pub wind_up: R,
    /// Kinematic error.
    pub kinematic_error: R,
}

/// What one step reads.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Input<R> {
    /// The joint's sensors.
    pub sensors: Sensors<R>,
    /// The outer controller's wish.
    pub setpoint: Setpoint<R>,
    /// What is switched on.
    pub shares: Shares<R>,
}

/// What the observer believes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate<R> {
    /// Output angle.
    pub output_position: Angle<R>,
    /// Output speed [rad/s].
    pub output_velocity: R,
    /// Torsion of the flexspline [rad].
    pub torsion: R,
    /// Torque through the flexspline [N m].
    pub transmitted_torque: R,
    /// Friction at the wave generator [N m].
    pub input_friction: R,
    /// Friction at the flexspline [N m].
    pub output_friction: R,
    /// External torque on the flexspline [N m].
    pub external_torque: R,
}

/// What one step writes: finite and bounded for any input bits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Output<R> {
    /// Torque command to the motor [N m].
    pub motor_torque: R,
    /// The part of it that is feed-forward [N m].
    pub feed_forward_torque: R,
    /// Where the motor should be.
    pub motor_reference: Angle<R>,
    /// The observer's estimates.
    pub estimate: Estimate<R>,
    /// What is wrong, by name.
    pub faults: Faults,
}

/// A set of named faults.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Faults(pub u32);

impl<R: Real> Input<R> {}
