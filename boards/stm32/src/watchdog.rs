//! The independent watchdog: resets the chip when the control misses its periods (ST RM0090, chapter 21; RM0440, chapter 42).
//!
//! A reset leaves the drive's enable pin floating: it has to be pulled down outside.

use crate::Chip;
use crate::register::Register;

const ADDRESS: usize = 0x4000_3000;
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

fn register(offset: usize) -> Register {
    // SAFETY: `Chip` promises the watchdog at the address, and the offsets are those of its registers.
    unsafe { Register::at(ADDRESS, offset) }
}

/// Starts the countdown, which nothing but a reset stops.
pub fn start<C: Chip>() {
    register(KEY).write(START);
    register(KEY).write(UNLOCK);
    settle();
    register(PRESCALER).write(DIVIDE_BY_4);
    register(RELOAD).write(COUNTS - 1);
    settle();
    feed::<C>();
}

/// Waits for what was written last to be taken over.
fn settle() {
    while register(STATUS).read() != 0 {}
}

/// Restarts the countdown.
pub fn feed<C: Chip>() {
    register(KEY).write(REFRESH);
}
