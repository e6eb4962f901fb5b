//! The independent watchdog: resets the chip when the control misses its periods (ST RM0090, chapter 21; RM0440, chapter 42;
//! RM0433, chapter 45).

use crate::Stm32;
use crate::register::Register;
use core::marker::PhantomData;
use strainwave_controller::Watchdog;

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

/// For the time of [`IndependentWatchdog::patiently`]: 4 s at the nominal 32 kHz, 2.7 to 7.5 s on an STM32F4.
#[cfg(feature = "served")]
const LONG_COUNTS: u32 = 4000;
#[cfg(feature = "served")]
const DIVIDE_BY_32: u32 = 3;

fn register<C: Stm32>(offset: usize) -> Register {
    // SAFETY: `Stm32` promises the watchdog there, and the offsets are those of its registers.
    unsafe { Register::at(C::WATCHDOG, offset) }
}

/// The independent watchdog of a chip. Nothing but a reset stops it.
pub struct IndependentWatchdog<C>(PhantomData<C>);

impl<C: Stm32> Watchdog for IndependentWatchdog<C> {
    fn start() {
        register::<C>(KEY).write(START);
        count_from::<C>(DIVIDE_BY_4, COUNTS);
    }

    fn feed() {
        register::<C>(KEY).write(REFRESH);
    }
}

#[cfg(feature = "served")]
impl<C: Stm32> IndependentWatchdog<C> {
    /// Does what takes longer than the control's periods, with a watchdog that waits for it, but not for ever. Nothing else may feed it
    /// meanwhile: interrupts are masked, and the drive is off. Either change takes up to 0.3 ms.
    pub fn patiently<T>(long: impl FnOnce() -> T) -> T {
        count_from::<C>(DIVIDE_BY_32, LONG_COUNTS);
        let done = long();
        count_from::<C>(DIVIDE_BY_4, COUNTS);
        done
    }
}

/// Has it count from there.
fn count_from<C: Stm32>(prescaler: u32, counts: u32) {
    register::<C>(KEY).write(UNLOCK);
    settle::<C>();
    register::<C>(PRESCALER).write(prescaler);
    register::<C>(RELOAD).write(counts - 1);
    settle::<C>();
    IndependentWatchdog::<C>::feed();
}

/// Waits for what was written last to be taken over.
fn settle<C: Stm32>() {
    while register::<C>(STATUS).read() != 0 {}
}
