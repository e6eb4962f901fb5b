//! The chip as the control sees it.

use strainwave_controller::Chip;

use crate::clock::FULL;
use crate::timer::SysTick;
use crate::watchdog::Ticked;

/// The chip.
pub enum Rp2350 {}

// SAFETY: the register is SIO's that clears outputs.
unsafe impl Chip for Rp2350 {
    const CORE_CLOCK: u32 = FULL;
    // GP14.
    const RELEASE: (usize, u32) = (0xd000_0020, 1 << 14);
    type Timer = SysTick;
    type Watchdog = Ticked;
}
