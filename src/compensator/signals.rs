//! Signals of the control step: what its inputs and outputs are made of.

use crate::angle::Angle;
use crate::constants::constants;
use crate::real::Real;

/// Setpoint of the output, with the derivatives that the feed-forward uses.
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

/// Gains of the compensation functions, 0..=1 each; changed at run time without a step in the output.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CompensationGains<R> {
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
    /// Output feedback: damping of the torsional vibration.
    pub output_feedback: R,
    /// Learnt factors; 0 also stops the learning.
    pub adaptation: R,
    /// Learnt ripple; 0 also stops the learning.
    pub ripple: R,
}

impl<R: Real> CompensationGains<R> {
    /// All gains 1.
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

/// Status of a reading as the board reports it, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Status(pub u32);

impl Status {
    /// No condition: readings are valid and the drive is on.
    pub const FINE: Self = Self(0);
    /// The motor encoder's frame had a wrong check sum or an error bit: its count is refused.
    pub const MOTOR_ENCODER_INVALID: Self = Self(1);
    /// The same of the output encoder.
    pub const OUTPUT_ENCODER_INVALID: Self = Self(1 << 1);
    /// The last control step lasted into this period.
    pub const OVERRUN: Self = Self(1 << 2);
    /// The first reading after a restart by the watchdog or after a fault.
    pub const RESTARTED: Self = Self(1 << 3);
    /// The drive is kept off from outside, a brake may hold the motor: the joint is watched, not moved.
    pub const DRIVE_OFF: Self = Self(1 << 4);

    /// All of `other` is set.
    #[inline(always)]
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Any of `other` is set.
    #[inline(always)]
    pub const fn intersects(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// The intersection with `others`.
    #[inline(always)]
    #[must_use]
    pub const fn among(self, others: Self) -> Self {
        Self(self.0 & others.0)
    }

    /// Both.
    #[must_use]
    pub const fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

/// Estimates of the observer: motion and external torque at the end of its period, torsion and torques at its
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
    /// Their standard deviations.
    pub deviation: EstimateDeviation<R>,
}

/// Standard deviations of an [`Estimate`], as [`super::estimate::observer::deviation`] declares them.
#[constants]
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
