//! The independent watchdog: resets the chip when the control misses its periods (ST RM0090, chapter 21; RM0440, chapter 42;
//! RM0433, chapter 45).
//!
//! A reset leaves the drive's enable pin floating: it has to be pulled down outside.

use crate::Chip;
use crate::register::Register;

const KEY: usize = 0x0;
const PRESCALER: usize = 0x4;
const RELOAD: usize = 0x8;
const STATUS: usize = 0xc;

const UNLOCK: u32 = 0x5555;
const REFRESH: u32 = 0xaaaa;
const START: u32 = 0xcccc;

/// Counts of the low-speed clock / 4: 2 ms at its nominal 32 kHz. On an STM32F4, whose clock has 17..47 kHz, 1.4 to 3.8 ms.
const COUNTS: u32 = 16;
const DIVIDE_BY_4: u32 = 0;

fn register<C: Chip>(offset: usize) -> Register {
    // SAFETY: `Chip` promises the watchdog there, and the offsets are those of its registers.
    unsafe { Register::at(C::WATCHDOG, offset) }
}

/// Starts the countdown, which nothing but a reset stops.
pub fn start<C: Chip>() {
    register::<C>(KEY).write(START);
    register::<C>(KEY).write(UNLOCK);
    settle::<C>();
    register::<C>(PRESCALER).write(DIVIDE_BY_4);
    register::<C>(RELOAD).write(COUNTS - 1);
    settle::<C>();
    feed::<C>();
}

/// Waits for what was written last to be taken over.
fn settle<C: Chip>() {
    while register::<C>(STATUS).read() != 0 {}
}

/// Restarts the countdown.
pub fn feed<C: Chip>() {
    register::<C>(KEY).write(REFRESH);
}
