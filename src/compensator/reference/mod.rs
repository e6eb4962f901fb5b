//! From the command to where the motor should be, and with what torque.

mod approach;
pub mod command;
pub mod directions;
pub mod feed_forward;
pub mod measured_feedback;
pub(in crate::compensator) mod motor_reference;
pub mod output_feedback;
