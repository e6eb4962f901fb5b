//! Processing of raw sensor values: finite, bounded, unwrapped.

pub mod clock;
pub mod encoder;
pub mod motor_encoder;
pub mod motor_torque;
pub mod rotor;
pub mod validation;
