//! Task of a joint: its demand over time, and the smooth move that tasks are made of.

use strainwave::Angle;
use strainwave::compensator::Setpoint;
use strainwave::compensator::schedule::CONTROL_PERIOD;

use crate::design::capability::Capability;

/// Demand of a scenario at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Demand {
    /// Output angle (rad).
    pub position: f64,
    /// (rad/s)
    pub velocity: f64,
    /// (rad/s^2)
    pub acceleration: f64,
    /// (rad/s^3)
    pub jerk: f64,
    /// (rad/s^4)
    pub snap: f64,
    /// External torque on the output (N m).
    pub load: f64,
}

impl Demand {
    /// As the compensator takes it, in f32.
    pub fn setpoint(&self) -> Setpoint<f32> {
        Setpoint {
            position: Angle::from_radians_f64(self.position),
            velocity: self.velocity as f32,
            acceleration: self.acceleration as f32,
            jerk: self.jerk as f32,
            snap: self.snap as f32,
        }
    }

    /// A demand on the default gear, as it is on this joint; its load stays.
    pub(crate) fn scaled(self, capability: &Capability) -> Self {
        let size = capability.moves;
        Self {
            position: size * self.position,
            velocity: size * self.velocity,
            acceleration: size * self.acceleration,
            jerk: size * self.jerk,
            snap: size * self.snap,
            load: self.load,
        }
    }
}

/// Task of a joint.
pub trait Task {
    /// Length (s).
    fn duration(&self) -> f64;

    /// Demand at `time` (s) on a joint of this capability.
    fn at(&self, time: f64, capability: &Capability) -> Demand;

    /// The wave generator is held by a brake.
    fn blocked(&self) -> bool {
        false
    }
}

/// Control periods of a task.
pub fn periods(task: &impl Task) -> usize {
    (task.duration() / CONTROL_PERIOD).round() as usize
}

/// A move of `distance` (rad) in `duration` (s) with continuous jerk, then rest.
pub(crate) fn rest_to_rest(time: f64, distance: f64, duration: f64) -> Demand {
    let (w, w1, w2, w3, w4) = smooth(time / duration);
    Demand {
        position: distance * w,
        velocity: distance * w1 / duration,
        acceleration: distance * w2 / duration.powi(2),
        jerk: distance * w3 / duration.powi(3),
        snap: distance * w4 / duration.powi(4),
        load: 0.0,
    }
}

/// The polynomial of 7th order from 0 to 1 with three vanishing derivatives at both ends, and its derivatives up to the
/// fourth; at rest from either end on.
pub(crate) fn smooth(x: f64) -> (f64, f64, f64, f64, f64) {
    if x <= 0.0 || x >= 1.0 {
        return (if x <= 0.0 { 0.0 } else { 1.0 }, 0.0, 0.0, 0.0, 0.0);
    }
    (
        x.powi(4) * (35.0 - 84.0 * x + 70.0 * x * x - 20.0 * x.powi(3)),
        x.powi(3) * (140.0 - 420.0 * x + 420.0 * x * x - 140.0 * x.powi(3)),
        x.powi(2) * (420.0 - 1680.0 * x + 2100.0 * x * x - 840.0 * x.powi(3)),
        x * (840.0 - 5040.0 * x + 8400.0 * x * x - 4200.0 * x.powi(3)),
        840.0 - 10_080.0 * x + 25_200.0 * x * x - 16_800.0 * x.powi(3),
    )
}

/// Integral of the polynomial of [`smooth`] from 0, within 0..=1.
pub(crate) fn integral_of_smooth(x: f64) -> f64 {
    7.0 * x.powi(5) - 14.0 * x.powi(6) + 10.0 * x.powi(7) - 2.5 * x.powi(8)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Without a jump: the slope of the position is the velocity, to `error` (rad/s).
    pub(crate) fn require_one_motion(task: &impl Task, error: f64) {
        for k in 1..periods(task) {
            let time = k as f64 * CONTROL_PERIOD;
            let at = |offset: f64| task.at(time + offset, &Capability::default());
            let slope = (at(1e-6).position - at(-1e-6).position) / 2e-6;
            assert!((slope - at(0.0).velocity).abs() < error, "{time}");
        }
    }
}
