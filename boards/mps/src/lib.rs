//! What Arm's MPS2+ and MPS3 boards share, as QEMU emulates them.
//!
//! A board says where its peripherals are, in a [`Machine`], and writes [`controller!`](crate::controller!); the rest is here.
//! Its images run in the state in which the core starts: on an Armv8-M that is the secure one, and the addresses are
//! those of the secure aliases.
#![no_std]

mod control;
pub mod counted;
pub mod fault;
#[cfg(feature = "served")]
mod flash_file;
pub mod link;
mod macros;
#[path = "../../register.rs"]
mod register;
#[cfg(feature = "served")]
pub mod serial;
#[cfg(feature = "served")]
pub mod served;
mod stack;
pub mod timer;
pub mod uart;
mod watchdog;

pub use control::{Board, start};
pub use timer::Timer;
pub use uart::Uart;
pub use watchdog::Watchdog;

pub use cortex_m_rt;
pub use defmt;
pub use static_cell;
pub use strainwave_app;

/// Peripherals of a board that the controller uses.
///
/// # Safety
/// At the addresses must be the registers of the peripherals that they are given for, and nothing else may use them.
pub unsafe trait Machine: 'static {
    /// Timer of the control interrupt.
    const TIMER: Timer;
    /// UART of the telemetry.
    const UART: Uart;
    /// Watchdog that fires the non-maskable interrupt.
    const WATCHDOG: Watchdog;
}
