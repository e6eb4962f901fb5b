//! Keys of an operator: `+` and `-` move the joint's target, `0` moves it back.

use core::sync::atomic::{AtomicI32, Ordering};
use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;
use strainwave_app::jog::FARTHEST;

/// Priority of their interrupt: below the control, whose 0 is the highest.
const PRIORITY: u8 = 0x80;

/// Step of the target by a key [mrad at the output].
const STEP: i32 = 10;
const FARTHEST_STEPS: i32 = (FARTHEST * 1e3) as i32;

/// Target of the operator, relative to the start [mrad].
static TARGET: AtomicI32 = AtomicI32::new(0);

/// Target of the operator, relative to the start (rad).
pub fn target() -> f32 {
    TARGET.load(Ordering::Relaxed) as f32 * 1e-3
}

/// Lets the port of the keys interrupt.
pub fn listen(interrupts: &mut NVIC, port: impl InterruptNumber) {
    // SAFETY: no critical section relies on priorities, and all that the handler uses is a static.
    unsafe {
        interrupts.set_priority(port, PRIORITY);
        NVIC::unmask(port);
    }
}

/// Takes a key, in the one interrupt that receives them.
pub fn take(key: u8) {
    // That interrupt is the only writer: a load and a store make no race.
    TARGET.store(moved(TARGET.load(Ordering::Relaxed), key), Ordering::Relaxed);
}

fn moved(target: i32, key: u8) -> i32 {
    let moved = match key {
        b'+' => target + STEP,
        b'-' => target - STEP,
        b'0' => 0,
        _ => target,
    };
    moved.clamp(-FARTHEST_STEPS, FARTHEST_STEPS)
}
