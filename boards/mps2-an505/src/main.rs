//! The joint controller on Arm's MPS2+ AN505 (Cortex-M33), in its secure state, emulated by QEMU. Wiring only.
#![no_std]
#![no_main]

use strainwave_mps::{Machine, Timer, Uart, Watchdog};

/// Clock of every peripheral (Hz).
const CLOCK: u32 = 20_000_000;

/// Arm's MPS2+ with image AN505: its peripherals by their secure addresses (Arm DAI 0505: memory map, interrupt
/// assignments; Arm 101104, the IoT Kit: timers and watchdogs).
struct An505;

// SAFETY: the addresses are those of CMSDK timer 0, UART 0 and the secure watchdog.
unsafe impl Machine for An505 {
    const TIMER: Timer = Timer::Cmsdk { address: 0x5000_0000, clock: CLOCK, interrupt: 3 };
    const UART: Uart = Uart { address: 0x5020_0000 };
    const WATCHDOG: Watchdog = Watchdog { address: 0x5008_1000, clock: CLOCK };
}

strainwave_mps::controller!(An505);
