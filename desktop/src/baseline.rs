//! The baselines: what a joint controller does today, in f64 on the desktop.
//!
//! B0 is the motor-side cascade alone, tuned as in [`crate::joint::feedback_params`]. B1 adds what
//! practitioners feed forward: the inertia of a rigid joint, Coulomb and viscous friction.
//!
//! ```text
//! tau_ff = (J_wg/r + r*J_fs)*ddq + Fc_in*sign(dq/r) + r*Fc_out*sign(dq) + (Fv_in/r + r*Fv_out)*dq
//! ```

use strainwave::compensator::actuate::cascade::{Feedback, FeedbackState, Wanted};
use strainwave::compensator::sense::encoder::{Encoder, EncoderParams, EncoderState, Reading};
use strainwave::compensator::{Command, Input};
use strainwave::friction::JointFrictionParams;
use strainwave::gear::GearParams;
use strainwave::{Angle, Error, Ratio, Real};

use crate::gear_file::GearFile;
use crate::joint::{CONTROL_PERIOD, feedback_params, firmware_gear_params};

/// A baseline controller.
#[derive(Clone)]
pub struct Baseline {
    ratio: Ratio,
    encoder: Encoder,
    encoder_state: EncoderState,
    feedback: Feedback<f64>,
    feedback_state: FeedbackState<f64>,
    feed_forward: Option<GearParams<f64>>,
    torque_limit: f64,
    limited: bool,
}

impl Baseline {
    /// B0: the cascade alone.
    ///
    /// # Errors
    /// As the builds of encoder and cascade.
    pub fn b0(file: &GearFile) -> Result<Self, Error> {
        let speed_limit = 2.0 * file.motor.rotor_speed_limit;
        Ok(Self {
            ratio: file.gear.signed_ratio(),
            encoder: EncoderParams { bits: file.sensors.motor_encoder_bits, speed_limit }
                .build(CONTROL_PERIOD)?,
            encoder_state: EncoderState::default(),
            feedback: feedback_params(file).build(CONTROL_PERIOD)?,
            feedback_state: FeedbackState::default(),
            feed_forward: None,
            torque_limit: file.motor.peak_torque,
            limited: false,
        })
    }

    /// B1: B0 with the feed-forward of a rigid joint.
    ///
    /// # Errors
    /// As [`Baseline::b0`] and [`firmware_gear_params`].
    pub fn b1(file: &GearFile) -> Result<Self, Error> {
        Ok(Self { feed_forward: Some(firmware_gear_params(file)?), ..Self::b0(file)? })
    }

    /// Torque command for one control period (N m); it follows positions alone.
    pub fn step(&mut self, input: &Input<f32>) -> f64 {
        let Reading { angle: motor, moved, .. } =
            self.encoder.step(&mut self.encoder_state, input.sensors.motor_encoder);
        let Command::Position(setpoint) = input.command else { return 0.0 };
        let position = Angle { counts: setpoint.position.counts, rest: f64::from(setpoint.position.rest) };
        let reference = Wanted {
            ahead: self.ratio.undo(position).minus(motor),
            velocity: f64::from(setpoint.velocity) * f64::from(self.ratio.n()),
            acceleration: 0.0,
        };
        let feedback =
            self.feedback.step(&mut self.feedback_state, moved / elapsed(input), &reference, self.limited);
        let wanted = feedback + self.rigid_body(setpoint.velocity.into(), setpoint.acceleration.into());
        let limited = wanted.clamp(-self.torque_limit, self.torque_limit);
        self.limited = limited != wanted;
        limited
    }

    fn rigid_body(&self, velocity: f64, acceleration: f64) -> f64 {
        let Some(gear) = &self.feed_forward else { return 0.0 };
        let (r, n): (f64, f64) = (self.ratio.value(), self.ratio.n().into());
        let (input, output) = (
            rigid_friction(&gear.input_friction, velocity * n),
            rigid_friction(&gear.output_friction, velocity),
        );
        (gear.wave_generator_inertia * n + r * gear.flexspline_inertia) * acceleration + input + r * output
    }
}

/// Time since the last step (s).
fn elapsed(input: &Input<f32>) -> f64 {
    if input.elapsed > 0.0 { f64::from(input.elapsed) } else { CONTROL_PERIOD }
}

/// Coulomb and viscous friction of a side at a velocity (rad/s).
fn rigid_friction(side: &JointFrictionParams<f64>, velocity: f64) -> f64 {
    let contact = if velocity < 0.0 { &side.backward } else { &side.forward };
    contact.coulomb * Real::sign(velocity) + contact.viscous * velocity
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear_file::Arrangement;
    use strainwave::compensator::Setpoint;

    fn file(arrangement: Arrangement) -> GearFile {
        let mut file = GearFile::default_gear();
        file.gear.arrangement = arrangement;
        file
    }

    /// At the motor's shaft the feed-forward supplies what inertia and friction take, at either sign of r.
    #[test]
    fn the_rigid_joints_torque_supplies_its_power() {
        for arrangement in [Arrangement::CircularSplineFixed, Arrangement::FlexsplineFixed] {
            let file = file(arrangement);
            let (baseline, n) = (Baseline::b1(&file).unwrap(), f64::from(file.gear.signed_ratio().n()));
            let gear = baseline.feed_forward.unwrap();
            let (input, output) = (gear.input_friction.forward, gear.output_friction.forward);
            for (velocity, acceleration) in [(0.3, 0.0), (-0.3, 0.0), (0.3, 5.0), (-0.3, 5.0)] {
                let motor_velocity = n * velocity;
                let kinetic = (file.inertia.wave_generator * n * n + file.inertia.flexspline) * acceleration;
                let friction = input.coulomb * motor_velocity.abs()
                    + input.viscous * motor_velocity.powi(2)
                    + output.coulomb * f64::abs(velocity)
                    + output.viscous * f64::powi(velocity, 2);
                let supplied = baseline.rigid_body(velocity, acceleration) * motor_velocity;
                let wanted = kinetic * velocity + friction;
                assert!((supplied - wanted).abs() < 1e-12, "{supplied} W, wanted {wanted} W");
            }
        }
    }

    #[test]
    fn b0_feeds_nothing_forward_and_b1_nothing_at_rest() {
        let file = file(Arrangement::CircularSplineFixed);
        assert_eq!(Baseline::b0(&file).unwrap().rigid_body(0.3, 5.0), 0.0);
        assert_eq!(Baseline::b1(&file).unwrap().rigid_body(0.0, 0.0), 0.0);
    }

    /// The cascade turns the motor against the setpoint's sign when r is negative.
    #[test]
    fn the_motor_is_driven_to_where_the_output_should_be() {
        for (arrangement, sign) in
            [(Arrangement::CircularSplineFixed, -1.0), (Arrangement::FlexsplineFixed, 1.0)]
        {
            let mut baseline = Baseline::b0(&file(arrangement)).unwrap();
            let setpoint = Setpoint { position: Angle::from_radians(1e-4), ..Setpoint::default() };
            let input = Input { command: setpoint.into(), ..Input::default() };
            let torque = baseline.step(&input);
            assert!(torque * sign > 0.0, "{torque}");
        }
    }
}
