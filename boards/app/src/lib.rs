//! The joint controller's application: what every board runs.
//!
//! A board implements [`Board`] and is otherwise wiring: its 10 kHz interrupt calls
//! [`Control::tick`], its idle loop [`Log::drain`]. Nothing here touches hardware, so the same
//! code runs on the host, where it is tested.
#![no_std]

pub mod control;
pub mod frame;
#[cfg(target_os = "none")]
pub mod logger;
mod stand_in;
pub mod telemetry;

/// Constants of the joint, generated from its gear file.
pub mod joint {
    include!(env!("STRAINWAVE_JOINT_FILE"));
}

pub use control::{Board, Control, control_step};
pub use joint::JOINT;
pub use stand_in::{Compensator, State};
pub use strainwave::Error;
pub use strainwave::compensator::{Input, Output};
pub use telemetry::{Log, Record, Telemetry};
