//! Processing of raw sensor values: finite, bounded, unwrapped.

pub mod clock;
pub mod encoder;
pub mod motor_encoder;
pub(super) mod motor_torque;
pub mod output_zero;
pub mod pulleys;
pub mod rotor;
pub(super) mod validation;
