//! Wait states of a path through code in the flash of an STM32F405 at 168 MHz.
//!
//! ```text
//! line: 16 bytes          read from flash: 1 + 5 cycles          I-cache: 64 lines          D-cache: 8 lines
//! ```
//!
//! An instruction whose line is the one in use, in the I-cache or prefetched costs no more; else the core waits for its line, which the
//! cache then keeps in the place of the one that was used longest ago. While the core is in a line the next one is prefetched, unless the
//! cache has it; where the core is there first, it waits for the rest. A prefetched line is not kept. A constant beside the code comes
//! through the D-cache in the same way. The caches are empty at first: the idle loop and other interrupts have had them.
//!
//! The lines are those of the image that was counted, linked for another board: this chip's image has the same code at other addresses.
//!
//! Taken to be free: data in RAM, where this chip's image has the joint's constants, and the loads from tables in flash, whose addresses a path
//! does not tell; 5 cycles each at most. Not in the model: that a constant and a prefetch want the flash at once. A model by the
//! manual, not compared with silicon.
//!
//! Reference: ST RM0090, 3.5.1 (wait states) and 3.5.2 (ART accelerator).

use crate::artifact::Image;
use crate::artifact::disassembly::{Instruction, PC};
use crate::counting::path;

/// Bytes of a line.
const LINE: u32 = 16;
/// Wait states of a read.
const WAIT_STATES: u64 = 5;
/// Lines of the caches.
const INSTRUCTION_LINES: usize = 64;
const DATA_LINES: usize = 8;

/// Cycles of `path` through `image` with the wait states, by the [`cycle_table`](super::cycle_table); `None` where an instruction has no
/// cost.
pub fn cycles(image: &Image, path: &[u32]) -> Option<u64> {
    let mut accelerator = Accelerator::default();
    for (address, cycles) in path::costs(image, path)? {
        let code = image.instructions();
        let instruction = &code[code.binary_search_by_key(&address, |i| i.address).ok()?];
        accelerator.fetch(address / LINE);
        accelerator.fetch((instruction.next() - 1) / LINE);
        if let Some(address) = literal(instruction) {
            accelerator.load(address / LINE);
        }
        accelerator.time += cycles;
    }
    Some(accelerator.time)
}

/// Address of a constant beside the code.
fn literal(instruction: &Instruction) -> Option<u32> {
    let (base, index, displacement) = instruction.memory()?;
    let here = instruction.address.wrapping_add(4) & !3;
    (base == PC && index.is_none()).then(|| here.wrapping_add_signed(displacement))
}

#[derive(Debug, Default)]
struct Accelerator {
    /// Cycles so far.
    time: u64,
    line: Option<u32>,
    /// The line that is prefetched, and when it is there.
    prefetched: Option<(u32, u64)>,
    instructions: Cache<INSTRUCTION_LINES>,
    data: Cache<DATA_LINES>,
}

impl Accelerator {
    fn fetch(&mut self, line: u32) {
        if self.line == Some(line) {
            return;
        }
        if !self.instructions.has(line) {
            match self.prefetched {
                Some((prefetched, ready)) if prefetched == line => self.time = self.time.max(ready),
                _ => {
                    self.time += WAIT_STATES;
                    self.instructions.keep(line);
                }
            }
        }
        self.line = Some(line);
        let next = line + 1;
        self.prefetched = (!self.instructions.holds(next)).then_some((next, self.time + 1 + WAIT_STATES));
    }

    fn load(&mut self, line: u32) {
        if !self.data.has(line) {
            self.time += WAIT_STATES;
            self.data.keep(line);
        }
    }
}

/// The lines of a cache, the one that was used last at the end.
#[derive(Debug, Default)]
struct Cache<const N: usize>(Vec<u32>);

impl<const N: usize> Cache<N> {
    fn holds(&self, line: u32) -> bool {
        self.0.contains(&line)
    }

    /// It holds a line, which is then used.
    fn has(&mut self, line: u32) -> bool {
        let place = self.0.iter().position(|held| *held == line);
        if let Some(place) = place {
            self.0[place..].rotate_left(1);
        }
        place.is_some()
    }

    fn keep(&mut self, line: u32) {
        if self.0.len() == N {
            self.0.remove(0);
        }
        self.0.push(line);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Instructions of a cycle in these lines, one after the other.
    fn time_of(lines: &[u32]) -> u64 {
        let mut accelerator = Accelerator::default();
        for line in lines {
            accelerator.fetch(*line);
            accelerator.time += 1;
        }
        accelerator.time
    }

    #[test]
    fn the_first_line_is_waited_for_and_then_kept() {
        assert_eq!(time_of(&[7; 8]), WAIT_STATES + 8);
        assert_eq!(time_of(&[7, 7, 90, 90, 7, 7]), 2 * WAIT_STATES + 6);
    }

    /// Eight instructions of a cycle give time to prefetch the next line, four do not.
    #[test]
    fn straight_code_waits_for_what_the_prefetch_lacks() {
        let straight = |each: usize| (0..10u32).flat_map(|line| vec![line; each]).collect::<Vec<_>>();
        assert_eq!(time_of(&straight(8)), WAIT_STATES + 80);
        assert_eq!(time_of(&straight(4)), WAIT_STATES + 40 + 9 * 2);
    }

    #[test]
    fn the_line_that_was_used_longest_ago_goes() {
        let mut cache = Cache::<2>::default();
        cache.keep(1);
        cache.keep(2);
        assert!(cache.has(1));
        cache.keep(3);
        assert!(cache.holds(1) && cache.holds(3) && !cache.holds(2));
    }

    #[test]
    fn a_constant_beside_the_code_is_a_read_of_its_own() {
        // ldr r0, [pc, #28]; bx lr
        let code = [0x07, 0x48, 0x70, 0x47];
        let image = Image::of_code(&code, &[("f", 0, 4)], &[]).unwrap();
        assert_eq!(literal(&image.instructions()[0]), Some(32));
        let without = path::costs(&image, &[0, 2]).unwrap().iter().map(|(_, cycles)| cycles).sum::<u64>();
        assert_eq!(cycles(&image, &[0, 2]), Some(without + 2 * WAIT_STATES));
    }
}
