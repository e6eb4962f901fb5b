//! The independent watchdog: resets the chip when the control misses its periods (ST RM0090, chapter 21).
//!
//! A reset leaves the drive's enable pin floating: it has to be pulled down outside.

use stm32f4xx_hal::pac::{IWDG, iwdg};

const UNLOCK: u16 = 0x5555;
const RELOAD: u16 = 0xaaaa;
const START: u16 = 0xcccc;

/// 16 counts of the low-speed clock / 4: 2 ms at its nominal 32 kHz, 1.4 to 3.8 ms over its 17..47 kHz.
const COUNTS: u16 = 16;

/// Starts the countdown, which nothing but a reset stops.
pub fn start(watchdog: &IWDG) {
    key(watchdog, START);
    key(watchdog, UNLOCK);
    while watchdog.sr().read().bits() != 0 {}
    watchdog.pr().write(|w| w.pr().divide_by4());
    watchdog.rlr().write(|w| w.rl().set(COUNTS - 1));
    while watchdog.sr().read().bits() != 0 {}
    feed();
}

/// Restarts the countdown.
pub fn feed() {
    // SAFETY: a write of the key register is all that happens, and the last one counts.
    key(unsafe { &*IWDG::ptr() }, RELOAD);
}

fn key(watchdog: &iwdg::RegisterBlock, key: u16) {
    // SAFETY: the keys above are the ones that the register knows.
    watchdog.kr().write(|w| unsafe { w.key().bits(key) });
}
