//! What STM32 chips share as joint controllers.
//!
//! A board names its clocks in a [`Chip`], brings its pins, its USART and its SPI up with its HAL or device crate, and writes
//! [`controller!`](crate::controller!); the rest is here. The control timer is TIM2, the watchdog the independent one: both have the same
//! registers, TIM2 the same address and interrupt, too, on an STM32F4, an STM32G4 and an STM32H7 (ST RM0090, RM0440 and RM0433).
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
pub mod spi;
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
/// TIM2 is at the address that [`timer`] names and the independent watchdog at `WATCHDOG`, and nothing else uses them. What
/// `RELEASE` and `RESET_FLAGS` name are those registers.
pub unsafe trait Chip: 'static {
    /// Clock of the core (Hz).
    const CORE_CLOCK: u32;
    /// Clock of TIM2 (Hz).
    const TIMER_CLOCK: u32;
    /// Address of the set-and-reset register of the port of the drive's enable, and what takes the enable low there.
    const RELEASE: (usize, u32);
    /// Address of the independent watchdog.
    const WATCHDOG: usize;
    /// The causes of a reset.
    const RESET_FLAGS: reset::Flags;
}
