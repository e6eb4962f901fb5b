//! Where the commands of a joint come from.

use strainwave::compensator::{Sensors, Status};

use crate::{Input, Output};

/// An operator, or a controller above the joint. Called from the control interrupt alone.
pub trait CommandSource {
    /// Sets `input` to the encoder's count, `None` where it was not read, and to the command of this period.
    fn input(&mut self, count: Option<u32>, input: &mut Input<f32>);
    /// The drive was given this torque (N m).
    fn commanded(&mut self, torque: f32);
    /// Takes a step's outputs, computed on request only.
    fn report(&mut self, output: impl FnOnce() -> Output<f32>);
    /// A request to leave Safe, once for each time.
    fn reset_requested(&mut self) -> bool {
        false
    }
    /// The control was reset: the joint is wherever it is.
    fn reset(&mut self);
}

/// Sensors of a joint with a motor encoder alone, and their status: its count, `None` where it was not read, and the torque of the drive (N m).
#[inline(always)]
pub(crate) fn sensors(count: Option<u32>, motor_torque: f32) -> (Sensors<f32>, Status) {
    // Of a failed reading the compensator makes its own prediction, for a while.
    let (motor_encoder, status) = match count {
        Some(count) => (count, Status::FINE),
        None => (0, Status::MOTOR_ENCODER_INVALID),
    };
    (Sensors { motor_encoder, output_encoder: None, motor_torque, output_torque: None }, status)
}
