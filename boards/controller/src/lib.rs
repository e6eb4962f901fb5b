//! What real boards share as joint controllers.
//!
//! A board names its clock, its control timer and its watchdog in a [`Chip`], brings its pins, its serial port and its SPI up with its HAL
//! or device crate, and writes [`controller!`](crate::controller!); the rest is here.
#![no_std]

mod board;
mod chip;
pub mod clock;
#[cfg(feature = "can")]
pub mod commanded;
pub mod control;
mod delay;
mod encoder;
pub mod fault;
mod idle;
pub mod joint;
pub mod keys;
#[cfg(feature = "served")]
pub mod line;
mod macros;
#[cfg(feature = "served")]
pub mod served;
pub mod spi;
mod torque_code;

pub use board::{Board, Drive};
pub use chip::{Chip, Timer, Watchdog};
pub use delay::CycleDelay;
pub use encoder::{MotorEncoder, Part, lost};
pub use torque_code::TorqueCode;

pub use static_cell;
pub use strainwave_app;
