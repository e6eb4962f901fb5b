//! Payload: what is attached to the output and stands in no gear file.
//!
//! ```text
//! J_fs' = J_fs + J_p,     J_p = inertia + m*l^2,     tau_gravity = -m*g*l*sin(theta - theta_hanging)
//! ```
//!
//! m is a point mass on a lever of length l. The structural damping of the gear is a constant of the gear, and stays as it is.
//! Units: kg m^2, N m, rad.

use strainwave::gear::GearParams;

use super::Sides;
use super::load_side::LoadParams;

/// Standard gravity (m/s^2).
pub const GRAVITY: f64 = 9.806_65;

/// A payload, rigid with the output flange.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Payload {
    /// J_p (kg m^2).
    pub inertia: f64,
    /// m*g*l (N m).
    pub gravity: f64,
    /// theta_hanging, the output angle at which the mass hangs below the axis (rad).
    pub hanging: f64,
}

impl Payload {
    /// Without anything attached.
    pub const NONE: Self = Self { inertia: 0.0, gravity: 0.0, hanging: 0.0 };

    /// A point mass (kg) on a lever (m), which hangs at an output angle (rad), and inertia without weight (kg m^2).
    pub fn new(inertia: f64, [mass, lever]: [f64; 2], hanging: f64) -> Self {
        Self { inertia: inertia + mass * lever * lever, gravity: mass * GRAVITY * lever, hanging }
    }

    /// The same where the output angle counts from another zero (rad).
    #[must_use]
    pub fn counted_from(self, zero: f64) -> Self {
        Self { hanging: self.hanging - zero, ..self }
    }

    /// A gear's parameters with it.
    pub fn on(&self, params: &GearParams<f64>) -> GearParams<f64> {
        GearParams { flexspline_inertia: params.flexspline_inertia + self.inertia, ..*params }
    }

    /// Ideal sides but for its weight.
    pub fn sides(&self) -> Sides {
        let load = LoadParams { link: None, gravity: self.gravity, hanging: self.hanging };
        Sides { load, ..Sides::IDEAL }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::joint::firmware_gear_params;
    use crate::io::gear_file::GearFile;
    use crate::plant::{Plant, plant_params};

    #[test]
    fn mass_and_lever_make_inertia_and_weight() {
        let payload = Payload::new(0.1, [5.0, 0.4], 1.0);
        assert!((payload.inertia - 0.9).abs() < 1e-12 && (payload.gravity - 19.6133).abs() < 1e-9);
        assert_eq!(payload.counted_from(0.25).hanging, 0.75);
        assert_eq!(Payload::NONE.sides(), Sides::IDEAL);
    }

    /// With the motor held the output swings at sqrt((K1 + G)/J) about where it hangs.
    #[test]
    fn a_joint_with_a_payload_swings_slower() {
        let mut file = GearFile::default_gear();
        // Free of what damps.
        for friction in [&mut file.friction.input, &mut file.friction.output] {
            (friction.coulomb, friction.static_level, friction.viscous) = (Some(1e-6), Some(1e-6), Some(0.0));
        }
        file.hysteresis.width_arcmin = 0.0;
        let params = firmware_gear_params(&file).unwrap();
        let frequency = |payload: Payload| {
            let params = payload.on(&params);
            let mut plant = Plant::condensed_between(&plant_params(&params), &payload.sides()).unwrap();
            let mut crossings = Vec::new();
            let mut before = 0.0;
            for period in 0..4000 {
                // A push, then nothing.
                plant.step_blocked(if period < 50 { 5.0 } else { 0.0 }).unwrap();
                let angle = plant.output().angle.to_radians();
                if period > 1000 && before < 0.0 && angle >= 0.0 {
                    crossings.push(f64::from(period) - angle / (angle - before));
                }
                before = angle;
            }
            let (first, last) = (crossings[0], crossings[crossings.len() - 1]);
            (crossings.len() - 1) as f64 / (last - first)
        };
        let alone = frequency(Payload::NONE);
        for inertia in [0.4, 2.0] {
            let ratio = frequency(Payload { inertia, ..Payload::NONE }) / alone;
            let expected = (params.flexspline_inertia / (params.flexspline_inertia + inertia)).sqrt();
            assert!((ratio / expected - 1.0).abs() < 0.01, "{inertia}: {ratio}, expected {expected}");
        }
    }
}
