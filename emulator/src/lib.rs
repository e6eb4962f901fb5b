//! Cross-build, set-up, QEMU, lockstep, counting and proofs on the firmware image.

pub mod any_input;
pub mod artifact;
pub mod budget;
pub mod chips;
pub mod counting;
pub mod firmware;
pub mod flash;
pub mod gauges;
pub mod interrupt;
mod lock;
pub mod machine;
pub mod pil;
mod process;
pub mod rerun;
mod scratch;
pub mod served;
pub mod setup;
mod sources;
pub mod target;
pub mod telemetry;
pub mod verify;

pub use firmware::Firmware;
pub use machine::{Ending, Machine};
