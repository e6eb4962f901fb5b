//! Feed-forward of practitioners: the torque of a rigid joint.
//!
//! ```text
//! tau_ff = (J_wg/r + r*J_fs)*ddq + s_f*(fric_in(dq/r) + r*fric_out(dq)),    fric(v) = Fc*sign(v) + Fv*v
//! ```
//!
//! q is the setpoint of the output, s_f the gain of the friction. Units: rad, N m at the motor's shaft.

use strainwave::friction::JointFrictionParams;
use strainwave::gear::GearParams;
use strainwave::{Ratio, Real};

use super::Commanded;

/// Inertia, Coulomb and viscous friction of a joint without compliance.
#[derive(Clone)]
pub(crate) struct RigidBody {
    ratio: Ratio,
    wave_generator_inertia: f64,
    flexspline_inertia: f64,
    input: JointFrictionParams<f64>,
    output: JointFrictionParams<f64>,
    friction_gain: f64,
}

impl RigidBody {
    pub fn new(ratio: Ratio, gear: &GearParams<f64>, friction_gain: f64) -> Self {
        Self {
            ratio,
            wave_generator_inertia: gear.wave_generator_inertia,
            flexspline_inertia: gear.flexspline_inertia,
            input: gear.input_friction,
            output: gear.output_friction,
            friction_gain,
        }
    }

    /// Torque at the motor (N m).
    pub fn torque(&self, commanded: &Commanded) -> f64 {
        let (r, n): (f64, f64) = (self.ratio.value(), self.ratio.n().into());
        let [input, output] = self.friction(commanded.velocity);
        (self.wave_generator_inertia * n + r * self.flexspline_inertia) * commanded.acceleration
            + input
            + r * output
    }

    /// The friction that is fed forward on the motor's and on the output's side, at an output speed
    /// (rad/s).
    pub fn friction(&self, velocity: f64) -> [f64; 2] {
        let motor = velocity * f64::from(self.ratio.n());
        [(&self.input, motor), (&self.output, velocity)]
            .map(|(side, velocity)| self.friction_gain * coulomb_and_viscous(side, velocity))
    }
}

/// Coulomb and viscous friction of a side at a velocity (rad/s).
fn coulomb_and_viscous(side: &JointFrictionParams<f64>, velocity: f64) -> f64 {
    let contact = if velocity < 0.0 { &side.backward } else { &side.forward };
    contact.coulomb * Real::sign(velocity) + contact.viscous * velocity
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::joint::firmware_gear_params;
    use crate::io::gear_file::{Arrangement, GearFile};

    fn of(file: &GearFile) -> RigidBody {
        RigidBody::new(file.gear.signed_ratio(), &firmware_gear_params(file).unwrap(), 1.0)
    }

    /// At the motor's shaft the feed-forward supplies what inertia and friction take, at either sign of r.
    #[test]
    fn the_rigid_joints_torque_supplies_its_power() {
        for arrangement in [Arrangement::CircularSplineFixed, Arrangement::FlexsplineFixed] {
            let mut file = GearFile::default_gear();
            file.gear.arrangement = arrangement;
            let (body, n) = (of(&file), f64::from(file.gear.signed_ratio().n()));
            let (input, output) = (body.input.forward, body.output.forward);
            for (velocity, acceleration) in [(0.3, 0.0), (-0.3, 0.0), (0.3, 5.0), (-0.3, 5.0)] {
                let motor_velocity = n * velocity;
                let kinetic = (file.inertia.wave_generator * n * n + file.inertia.flexspline) * acceleration;
                let friction = input.coulomb * motor_velocity.abs()
                    + input.viscous * motor_velocity.powi(2)
                    + output.coulomb * f64::abs(velocity)
                    + output.viscous * f64::powi(velocity, 2);
                let commanded = Commanded { velocity, acceleration, ..Commanded::default() };
                let supplied = body.torque(&commanded) * motor_velocity;
                let expected = kinetic * velocity + friction;
                assert!((supplied - expected).abs() < 1e-12, "{supplied} W, expected {expected} W");
            }
        }
    }

    #[test]
    fn nothing_is_fed_forward_at_rest() {
        assert_eq!(of(&GearFile::default_gear()).torque(&Commanded::default()), 0.0);
    }
}
