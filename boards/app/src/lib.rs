//! The joint controller's application: what every board runs.
//!
//! A board implements [`Board`] and is otherwise wiring: its 10 kHz interrupt calls
//! [`Slot::tick`], its idle loop [`Log::drain`]. Nothing here touches hardware, so the same
//! code runs on the host, where it is tested.
#![no_std]

pub mod command_source;
#[cfg(feature = "can")]
pub mod commanded;
pub mod constants;
pub mod control;
pub mod elementary_functions;
pub mod frame;
pub mod jog;
pub mod literal_mesh;
#[cfg(target_os = "none")]
pub mod logger;
pub mod operated;
#[cfg(target_os = "none")]
mod panic;
#[cfg(feature = "served")]
pub mod served;
pub mod slot;
pub mod telemetry;
pub mod torque_gauges;
pub mod worst_case;

/// The joint that this firmware controls: `strainwave export` has built its compensator.
pub mod joint {
    include!(env!("STRAINWAVE_JOINT_FILE"));
}

/// Resolution of the motor encoder that the joint's gear file asks for: 2^bits counts a revolution. A board whose encoder has fewer must not
/// compile; `strainwave_drivers::Scaled` sees to it. Not a constant, which every board would evaluate: one that takes counts as they are
/// refuses a joint of another layout when it starts.
pub const fn motor_encoder_bits() -> u32 {
    compensator::words::motor_encoder_bits(&joint::WORDS)
}

pub use control::{Board, Control, control_step};
pub use strainwave::Error;
pub use strainwave::compensator::{self, Input, Output};

/// The compensator as firmware runs it.
pub type Compensator = strainwave::compensator::Compensator<f32>;
/// State of the compensator.
pub type State = strainwave::compensator::State<f32>;
pub use slot::Slot;
pub use telemetry::{Log, Record, Telemetry};
