//! What a chip has to have.

use cortex_m::peripheral::NVIC;

/// A chip that controls a joint.
///
/// # Safety
/// What `RELEASE` names is that register.
pub unsafe trait Chip: 'static {
    /// Clock of the core (Hz).
    const CORE_CLOCK: u32;
    /// Address of a register that changes those outputs alone that are written to it, and what takes the drive's enable low there.
    const RELEASE: (usize, u32);
    /// The control timer.
    type Timer: Timer;
    /// The watchdog.
    type Watchdog: Watchdog;
}

/// A timer whose interrupt is the control, at `strainwave_app::control::RATE`.
pub trait Timer: 'static {
    /// Starts the interrupt, at the highest priority.
    fn start(interrupts: &mut NVIC);
    /// Clears the interrupt that is being served.
    fn acknowledge();
    /// The next interrupt is already waiting.
    fn waiting() -> bool;
}

/// A watchdog that resets the chip when the control misses its periods.
///
/// A reset leaves the drive's enable pin floating: it has to be pulled down outside.
pub trait Watchdog: 'static {
    /// Starts the countdown.
    fn start();
    /// Restarts the countdown.
    fn feed();
}
