//! The joint's compensator, copied to RAM before `main`.
//!
//! In flash a read costs 4 to 5 wait states on an STM32F4 or STM32G4, and the data cache holds 128 or 256 bytes of the constants that a
//! control step reads. On an STM32H7 it costs 2 of a bus at half the core's clock, and the data cache is off. On an RP2350 the flash is
//! another chip, some 100 cycles away.
//!
//! In RAM a word may change while the joint runs: [`is_unchanged`] is asked once a period, and the drive is off before the change can do much.
//! The start-up code then copies the words anew.

use core::ptr;

use strainwave_app::{Compensator, joint};

/// Sum of the words in flash, which any changed bit changes.
const SUM: u32 = {
    let (mut sum, mut k) = (0u32, 0);
    while k < joint::WORDS.len() {
        sum = sum.wrapping_add(joint::WORDS[k]);
        k += 1;
    }
    sum
};

/// In the section that the start-up code copies.
// SAFETY: what the section holds is data, and is copied before any code reads it.
#[unsafe(link_section = ".data")]
static WORDS: [u32; joint::WORDS.len()] = joint::WORDS;

/// The compensator, if the copy is sound; else says what is wrong.
pub fn compensator() -> Option<&'static Compensator> {
    let found = Compensator::from_words(&WORDS);
    found.inspect_err(|bad| defmt::error!("joint {=str}: {=str}", joint::GEAR, bad.reason())).ok()
}

/// The copy is what it was when the joint was built. Some 3000 cycles.
#[inline(never)]
pub fn is_unchanged() -> bool {
    // SAFETY: a word of a static. Volatile: the compiler takes a static that nobody writes for what it was initialised with.
    let words = WORDS.iter().map(|word| unsafe { ptr::from_ref(word).read_volatile() });
    words.fold(0, u32::wrapping_add) == SUM
}
