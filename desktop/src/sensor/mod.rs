//! Sensors with the errors that their datasheets state.
//!
//! | sensor | true value | reading |
//! | --- | --- | --- |
//! | [`encoder`] | motion: angle (rad) and speed (rad/s) | counts |
//! | [`accelerometer`] | specific force along its axis (m/s^2) | m/s^2 |
//! | [`gauge_bridge`] | strain, without unit | voltage behind its amplifier (V) |
//! | [`torque_sensor`] | torque (N m) | N m |
//! | [`motor_current`] | torque of the nominal torque constant (N m) | A |
//!
//! All have one shape: parameters in the datasheet's words, SI; `build(dt)` checks each once and names the first that is out of
//! range; `step(&self, &mut State, true value, random)` gives the reading of the sample, dt after the one before. The last four are one analogue
//! path with different words ([`analogue`]). A sensor without errors reads the true value, bit for bit.

pub mod accelerometer;
pub mod analogue;
mod drift;
pub mod encoder;
pub mod gauge_bridge;
mod low_pass;
pub mod motor_current;
mod noise;
pub mod torque_sensor;
mod wave;

pub use accelerometer::{Accelerometer, AccelerometerParams};
pub use analogue::{Analogue, AnalogueParams, AnalogueState};
pub use drift::DriftParams;
pub use encoder::{Encoder, EncoderErrors, EncoderParams, EncoderReading, EncoderState};
pub use gauge_bridge::{GaugeBridge, GaugeBridgeParams};
pub use motor_current::{MotorCurrent, MotorCurrentParams};
pub use noise::Noise;
pub use torque_sensor::{TorqueSensor, TorqueSensorParams};
pub use wave::Wave;

use strainwave::Error;

/// `Ok` when `holds`, else the error that names the parameter.
fn require(holds: bool, name: &'static str) -> Result<(), Error> {
    if holds { Ok(()) } else { Err(Error::OutOfRange(name)) }
}

/// Finite, and not below 0.
fn is_size(value: f64) -> bool {
    value.is_finite() && value >= 0.0
}
