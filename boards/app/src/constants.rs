//! Whether the joint's constants in RAM are still those of the image.
//!
//! A bit of RAM can change while the joint moves, and the control step would go on with another gain. So the words are summed while it runs, a part
//! of them a control period, and compared with what the compiler has summed. A sum, where start-up checks by a CRC: one changed bit changes it,
//! and it costs some cycles a word.

use crate::joint::WORDS;

/// Parts, of which one is summed in a control period.
pub const PARTS: usize = 2;
/// Words of a part; the last may have fewer.
const PART: usize = WORDS.len().div_ceil(PARTS);
/// Words that are read before they are added: back to back a read costs a cycle, and two alone.
const ROW: usize = 4;

const SUMS: [u32; PARTS] = sums();

const fn sums() -> [u32; PARTS] {
    let (mut sums, mut at) = ([0u32; PARTS], 0);
    while at < WORDS.len() {
        sums[at / PART] = sums[at / PART].wrapping_add(WORDS[at]);
        at += 1;
    }
    sums
}

/// Whether this part of the words, of [`PARTS`], is as it was built.
pub fn is_unchanged(words: &[u32; WORDS.len()], part: usize) -> bool {
    words.chunks(PART).zip(SUMS).nth(part).is_none_or(|(words, sum)| self::sum(words) == sum)
}

fn sum(words: &[u32]) -> u32 {
    let (rows, rest) = words.as_chunks::<ROW>();
    let rows = rows.iter().map(|row| row.each_ref().map(read));
    rows.flatten().chain(rest.iter().map(read)).fold(0, u32::wrapping_add)
}

/// Volatile: for the compiler the words cannot change, and their sum is known.
fn read(word: &u32) -> u32 {
    // SAFETY: a reference is valid.
    unsafe { core::ptr::from_ref(word).read_volatile() }
}
