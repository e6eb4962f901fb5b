//! What goes into the compensator in each step, and what comes out of it.
//!
//! What goes in may be any bits: [`super::sense::validation`] makes it finite and bounded. What comes out is. Units: rad, rad/s,
//! N m; signs as in [`crate::gear`].

use crate::angle::Angle;
use crate::compensator::actuate::mode::Mode;
use crate::compensator::adapt::parameters::Factors;
use crate::compensator::{Command, Directions, Faults};
use crate::real::Real;

/// What the joint's sensors report to one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensors<R> {
    /// Motor (wave-generator) encoder, raw count within the turn.
    pub motor_encoder: u32,
    /// Output (flexspline) encoder, raw count within the turn.
    pub output_encoder: Option<u32>,
    /// Torque of the motor at its shaft (N m).
    pub motor_torque: R,
    /// Torque through the flexspline from a strain gauge (N m).
    pub output_torque: Option<R>,
}

/// Where the output should be, with the derivatives that the feed-forward uses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Setpoint<R> {
    /// Output angle.
    pub position: Angle<R>,
    /// Output speed (rad/s).
    pub velocity: R,
    /// Output acceleration (rad/s^2).
    pub acceleration: R,
    /// Output jerk (rad/s^3).
    pub jerk: R,
    /// Output snap (rad/s^4).
    pub snap: R,
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
    /// Output feedback: the torsional vibration's damping.
    pub output_feedback: R,
    /// Factors that have been learnt; 0 also stops the learning.
    pub adaptation: R,
    /// Ripple that has been learnt; 0 also stops the learning.
    pub ripple: R,
}

impl<R: Real> Shares<R> {
    /// Everything on.
    pub const ALL: Self = Self {
        feedback: R::ONE,
        inertia: R::ONE,
        friction: R::ONE,
        wind_up: R::ONE,
        kinematic_error: R::ONE,
        output_feedback: R::ONE,
        adaptation: R::ONE,
        ripple: R::ONE,
    };
}

/// What one step reads.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Input<R> {
    /// The joint's sensors.
    pub sensors: Sensors<R>,
    /// The outer controller's wish: read once a round ([`crate::compensator::schedule::SLOW_PERIODS`] control periods).
    pub command: Command<R>,
    /// What is switched on, for either direction of the output.
    pub shares: Directions<R>,
    /// Time since the sensors of the last step were read (s); 0 where it is not measured: then one control period.
    pub elapsed: R,
    /// Age of the command (s); 0 where it is fresh or nobody knows.
    pub setpoint_age: R,
    /// What the board knows of this reading.
    pub status: Status,
}

/// What the board itself knows of a reading, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Status(pub u32);

impl Status {
    /// Nothing to tell: all is well, and the drive is on.
    pub const FINE: Self = Self(0);
    /// The motor encoder's frame had a wrong check sum, or its status bits say so: its count is refused.
    pub const MOTOR_ENCODER_INVALID: Self = Self(1);
    /// The same of the output encoder.
    pub const OUTPUT_ENCODER_INVALID: Self = Self(1 << 1);
    /// The last control step lasted into this period.
    pub const OVERRUN: Self = Self(1 << 2);
    /// The first reading after a restart by the watchdog or after a fault.
    pub const RESTARTED: Self = Self(1 << 3);
    /// The drive is kept off from outside, a brake may hold the motor: the joint is watched, not moved.
    pub const DRIVE_OFF: Self = Self(1 << 4);

    /// All of `other` is told.
    #[inline(always)]
    pub const fn tells(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Both.
    #[must_use]
    pub const fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

/// What the observer estimates: motion and external torque at the end of its period, torsion and torques at its
/// beginning ([`crate::compensator::schedule::OBSERVER_PERIODS`] control periods before).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate<R> {
    /// Output angle.
    pub output_position: Angle<R>,
    /// Output speed (rad/s).
    pub output_velocity: R,
    /// Torsion of the flexspline (rad).
    pub torsion: R,
    /// Torque through the flexspline (N m).
    pub transmitted_torque: R,
    /// Friction at the wave generator (N m).
    pub input_friction: R,
    /// Friction at the flexspline (N m).
    pub output_friction: R,
    /// External torque on the flexspline (N m).
    pub external_torque: R,
    /// How far off they may be.
    pub deviation: EstimateDeviation<R>,
}

/// Standard deviations of an [`Estimate`], as [`super::estimate::observer::deviation`] declares them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EstimateDeviation<R> {
    /// Of the output angle (rad).
    pub output_position: R,
    /// Of the output speed (rad/s).
    pub output_velocity: R,
    /// Of the torsion (rad).
    pub torsion: R,
    /// Of the torque through the flexspline (N m).
    pub transmitted_torque: R,
    /// Of the friction at the wave generator (N m).
    pub input_friction: R,
    /// Of the friction at the flexspline (N m).
    pub output_friction: R,
    /// Of the external torque on the flexspline (N m).
    pub external_torque: R,
}

/// What one step commands: finite and bounded for any input bits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Commanded<R> {
    /// Torque command to the motor (N m).
    pub motor_torque: R,
    /// What is wrong, by name.
    pub faults: Faults,
    /// Whether the drive may be on.
    pub mode: Mode,
}

/// The same with what it rested on: finite and bounded for any input bits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Output<R: Real> {
    /// Torque command to the motor (N m).
    pub motor_torque: R,
    /// The part of it that is feed-forward (N m).
    pub feed_forward_torque: R,
    /// Where the motor should be.
    pub motor_reference: Angle<R>,
    /// The observer's estimates, from its last turn.
    pub estimate: Estimate<R>,
    /// The observer's turn was in this step.
    pub observed: bool,
    /// What has been learnt of the joint, as far as it is applied.
    pub factors: Factors<R>,
    /// What is wrong, by name.
    pub faults: Faults,
    /// Whether the drive may be on.
    pub mode: Mode,
}
