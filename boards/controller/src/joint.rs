//! The joint's compensator, copied to RAM before `main`.
//!
//! In flash a read costs 4 to 5 wait states on an STM32F4 or STM32G4, and the data cache holds 128 or 256 bytes of the constants that a
//! control step reads. On an STM32H7 it costs 2 of a bus at half the core's clock, and the data cache is off. On an RP2350 the flash is
//! another chip, some 100 cycles away.

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
