//! What STM32 chips share as joint controllers.
//!
//! The control timer is TIM2, the watchdog the independent one: both have the same registers, TIM2 the same address and interrupt, too, on
//! an STM32F4, an STM32G4 and an STM32H7 (ST RM0090, RM0440 and RM0433).
#![no_std]

#[cfg(feature = "can")]
pub mod fdcan;
#[cfg(feature = "served")]
pub mod flash;
#[cfg(feature = "served")]
pub mod linked;
#[path = "../../register.rs"]
mod register;
pub mod reset;
mod timer;
pub mod usart;
mod watchdog;

pub use timer::Tim2;
pub use watchdog::IndependentWatchdog;

/// An STM32 that controls a joint.
///
/// # Safety
/// TIM2 is at the address that [`Tim2`] knows and the independent watchdog at `WATCHDOG`, and nothing else uses them. What
/// `RESET_FLAGS` names is that register.
pub unsafe trait Stm32: 'static {
    /// Clock of TIM2 (Hz).
    const TIMER_CLOCK: u32;
    /// Address of the independent watchdog.
    const WATCHDOG: usize;
    /// The causes of a reset.
    const RESET_FLAGS: reset::Flags;
}
