//! Peripherals of the board (Arm DAI 0386: memory map, interrupt assignments).

use strainwave_mps::{Machine, Timer, Uart, Watchdog};

/// Clock of every peripheral (Hz).
const CLOCK: u32 = 25_000_000;

/// Arm's MPS2+ with image AN386.
pub struct An386;

// SAFETY: the addresses are those of CMSDK timer 0, UART 0 and the watchdog.
unsafe impl Machine for An386 {
    const TIMER: Timer = Timer::Cmsdk { address: 0x4000_0000, clock: CLOCK, interrupt: 8 };
    const UART: Uart = Uart { address: 0x4000_4000 };
    const WATCHDOG: Watchdog = Watchdog { address: 0x4000_8000, clock: CLOCK };
}
