//! The joint's compensator, copied to RAM before `main`.
//!
//! In flash a read costs 4 to 5 wait states on an STM32F4 or STM32G4, and the data cache holds 128 or 256 bytes of the constants that a
//! control step reads. On an STM32H7 it costs 2 of a bus at half the core's clock, and the data cache is off. On an RP2350 the flash is
//! another chip, some 100 cycles away.

use core::sync::atomic::{AtomicUsize, Ordering};
use strainwave_app::constants::{self, PARTS};
use strainwave_app::{Compensator, joint};

/// In the section that the start-up code copies.
// SAFETY: what the section holds is data, and is copied before any code reads it.
#[unsafe(link_section = ".data")]
static WORDS: [u32; joint::WORDS.len()] = joint::WORDS;

/// The compensator, if the copy is sound; else says what is wrong.
pub fn compensator() -> Option<&'static Compensator> {
    let found = Compensator::from_words(&WORDS);
    found.inspect_err(|bad| defmt::error!("joint {=str}: {=str}", joint::GEAR, bad.reason())).ok()
}

/// Whether a bit of the copy has changed, by the part of it that is due: to be called once in a control period, in one interrupt.
pub fn has_changed() -> bool {
    static DUE: AtomicUsize = AtomicUsize::new(0);
    // That interrupt is the only one that uses it: a load and a store make no race.
    let part = DUE.load(Ordering::Relaxed);
    DUE.store(if part + 1 < PARTS { part + 1 } else { 0 }, Ordering::Relaxed);
    !constants::is_unchanged(&WORDS, part)
}
