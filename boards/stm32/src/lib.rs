//! What STM32 chips share as joint controllers.
//!
//! A board names its clocks in a [`Chip`], brings its pins, its USART and its SPI up with its HAL, and writes
//! [`controller!`](crate::controller!); the rest is here. The control timer is TIM2, the watchdog the independent one: both have the same registers, addresses and interrupt on an
//! STM32F4 and an STM32G4 (ST RM0090 and RM0440).
#![no_std]

mod board;
pub mod clock;
pub mod control;
mod delay;
mod encoder;
pub mod fault;
mod idle;
pub mod joint;
pub mod keys;
mod macros;
#[path = "../../register.rs"]
mod register;
pub mod reset;
pub mod timer;
mod torque_code;
pub mod watchdog;

pub use board::{Board, Drive};
pub use delay::CycleDelay;
pub use encoder::{MotorEncoder, Part, lost};
pub use torque_code::TorqueCode;

pub use static_cell;
pub use strainwave_app;

/// A chip that controls a joint.
///
/// # Safety
/// TIM2 and the independent watchdog are at the addresses that [`timer`] and [`watchdog`] name, and nothing else uses them. What
/// `RELEASE` and `RESET_FLAGS` name are those registers.
pub unsafe trait Chip: 'static {
    /// Clock of the core (Hz).
    const CORE_CLOCK: u32;
    /// Clock of TIM2 (Hz).
    const TIMER_CLOCK: u32;
    /// Address of the set-and-reset register of the port of the drive's enable, and what takes the enable low there.
    const RELEASE: (usize, u32);
    /// Address of the register with the causes of a reset, and the bit that clears them.
    const RESET_FLAGS: (usize, u32);
}
