//! The compensator: the control step of the joint controller, run once every 0.1 ms.
//!
//! ```text
//! sense -> estimate -> reference -> adapt -> actuate -> torque command
//! ```
//!
//! | module | contents |
//! | --- | --- |
//! | [`sense`] | validation of the inputs, encoders, pulleys of a belt, motor torque, balance of the rotor |
//! | [`estimate`] | observer, external load |
//! | [`mod@reference`] | command, feed-forward, motor reference, output feedback |
//! | [`adapt`] | parameter factors, ripple |
//! | [`actuate`] | cascade, fallback, mode, protection of the gear |
//! | `control`, [`schedule`] | the step, and the multi-rate schedule of its stages |
//! | [`tuned`] | tuned constants, one table |
//! | [`words`] | the built compensator as constants of an image |
//!
//! The model runs by a multi-rate [`schedule`], so that no control period takes the time of the whole of it. From one
//! plan of the feed-forward to the next the motor reference is extrapolated by the planned acceleration and jerk: it is
//! smooth to the third order. Angles that are compared in every period are kept relative to the motor's encoder: small
//! numbers, which an f32 resolves.
//!
//! Firmware reads a compensator that the host has built: [`Compensator::from_words`]. In the examples `JOINT` is a
//! [`JointParams`], as it is generated from a gear file: `examples/joint/hd25_100.rs`.
//!
//! [`Compensator::control`] is total: for any input bits every output is finite and bounded, and faults are reported
//! as [`Faults`] by name. Units: rad, rad/s, N m; signs as in [`crate::gear`].

pub mod actuate;
pub mod adapt;
mod control;
pub mod estimate;
pub mod faults;
mod interface;
mod joint_params;
pub mod limits;
mod real_time_gear;
pub mod reference;
pub mod schedule;
pub mod sense;
mod signals;
mod start;
mod state;
pub mod tolerances;
pub mod tuned;
pub mod words;

pub use actuate::mode::Mode;
pub use control::Compensator;
pub use faults::Faults;
pub use interface::{Commanded, Input, Output, Sensors};
pub use joint_params::JointParams;
pub use limits::Limits;
pub use real_time_gear::{HYSTERESIS_LEVELS, HYSTERESIS_MEMORY, MESH, RealTimeFlexspline, RealTimeGear};
pub use reference::command::Command;
pub use reference::directions::Directions;
pub use signals::{CompensationGains, Estimate, EstimateDeviation, Setpoint, Status};
pub use state::State;
pub use tolerances::Tolerances;
