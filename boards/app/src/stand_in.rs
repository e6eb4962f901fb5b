//! A compensator's shape, until the library's own is in: hold the motor where it is.

use strainwave::compensator::{Input, Output};
use strainwave::{Angle, Error};

/// Parameters of the joint.
pub struct JointParams<R> {
    /// Stiffness [N m/rad].
    pub stiffness: R,
}

/// Holds the joint.
pub struct Compensator<R> {
    stiffness: R,
}

/// The last position.
#[derive(Default)]
pub struct State {
    position: Angle<f32>,
}

impl Compensator<f32> {
    /// Checks the parameters.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `stiffness`.
    pub fn build(params: &JointParams<f32>) -> Result<Self, Error> {
        let holds = params.stiffness.is_finite();
        if holds { Ok(Self { stiffness: params.stiffness }) } else { Err(Error::OutOfRange("stiffness")) }
    }

    /// One step.
    pub fn step(&self, state: &mut State, input: &Input<f32>) -> Output<f32> {
        let mut output = Output::default();
        let motor = Angle::from_counts(i64::from(input.sensors.motor_encoder));
        output.estimate.output_velocity = motor.minus(state.position);
        output.motor_torque = input.setpoint.position.minus(motor) * self.stiffness;
        output.motor_reference = input.setpoint.position;
        state.position = motor;
        output
    }
}
