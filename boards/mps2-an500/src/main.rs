//! The joint controller on Arm's MPS2+ AN500 (Cortex-M7), emulated by QEMU. Wiring only.
#![no_std]
#![no_main]

use strainwave_mps::{Machine, Timer, Uart, Watchdog};

/// Clock of every peripheral (Hz).
const CLOCK: u32 = 25_000_000;

/// Arm's MPS2+ with image AN500: its peripherals (Arm DAI 0500: memory map, interrupt assignments).
struct An500;

// SAFETY: the addresses are those of CMSDK timer 0, UART 0 and the watchdog.
unsafe impl Machine for An500 {
    const TIMER: Timer = Timer::Cmsdk { address: 0x4000_0000, clock: CLOCK, interrupt: 8 };
    const UART: Uart = Uart { address: 0x4000_4000 };
    const WATCHDOG: Watchdog = Watchdog { address: 0x4000_8000, clock: CLOCK };
}

strainwave_mps::controller!(An500);
