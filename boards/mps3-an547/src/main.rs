//! The joint controller on Arm's MPS3 AN547 (Cortex-M55), in its secure state, emulated by QEMU. Wiring only.
#![no_std]
#![no_main]

use strainwave_mps::{Machine, Timer, Uart, Watchdog};

/// Arm's MPS3 with image AN547: its peripherals by their secure addresses (Arm DAI 0547: memory map, interrupt
/// assignments; Arm 101773, the SSE-300: watchdogs).
struct An547;

// SAFETY: the addresses are those of UART 0 and of the watchdog of the slow clock, the only watchdog that QEMU has here.
unsafe impl Machine for An547 {
    const TIMER: Timer = Timer::SysTick { clock: 32_000_000 };
    const UART: Uart = Uart { address: 0x5930_3000 };
    const WATCHDOG: Watchdog = Watchdog { address: 0x5802_e000, clock: 32_000 };
}

strainwave_mps::controller!(An547, SysTick);
