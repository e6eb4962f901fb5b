//! The worst-case path through a function, from its code alone: no call can cost more, whatever was before it.
//!
//! Cycles are those of [`super::cycle_table`], a taken branch with its refill. Every branch is taken to go
//! either way at every place, whether or not the data can bring that about: the result is a bound, not a
//! count. A function that loops or calls through a pointer, or whose callee does, has none.

use std::collections::HashMap;

use super::cycle_table::{REFILL, cycles};
use crate::artifact::Image;
use crate::artifact::disassembly::{Flow, Instruction};

/// Most cycles of one call of the function with this index; `None` where the code does not show a bound.
pub fn worst_case_path(image: &Image, function: usize) -> Option<u64> {
    Walk { image, rest: HashMap::new() }.from(image.functions()[function].address)
}

/// State of the search for the rest of a path.
enum Rest {
    /// Being followed: to come by again is a loop.
    Open,
    /// So many cycles to the return, or no bound.
    Known(Option<u64>),
}

struct Walk<'a> {
    image: &'a Image,
    rest: HashMap<u32, Rest>,
}

impl Walk<'_> {
    /// Most cycles from the instruction at `address` to the return.
    fn from(&mut self, address: u32) -> Option<u64> {
        match self.rest.get(&address) {
            Some(Rest::Open) => return None,
            Some(Rest::Known(rest)) => return *rest,
            None => self.rest.insert(address, Rest::Open),
        };
        let rest = self.on(address);
        self.rest.insert(address, Rest::Known(rest));
        rest
    }

    fn on(&mut self, address: u32) -> Option<u64> {
        let code = self.image.instructions();
        let place = code.binary_search_by_key(&address, |i| i.address).ok()?;
        let instruction = &code[place];
        let before = place.checked_sub(1).map(|k| &code[k]).filter(|b| b.next() == address);
        let own = u64::from(cycles(instruction, before)?);
        // An unconditional transfer's cost has its refill in it.
        let falls_through = instruction.may_fall_through();
        let refill = if falls_through { u64::from(REFILL) } else { 0 };
        let leaves = match instruction.flow() {
            Flow::Straight => None,
            Flow::Return => Some(refill),
            Flow::Branch(target) => Some(refill + self.from(target)?),
            Flow::Call(callee) => return Some(own + self.from(callee)? + self.from(instruction.next())?),
            Flow::Table(size) => Some(self.table(instruction, size)?),
            Flow::Trap | Flow::Indirect | Flow::CallIndirect => return None,
        };
        let goes_on = if falls_through { Some(self.from(instruction.next())?) } else { None };
        leaves.max(goes_on).map(|rest| own + rest)
    }

    /// Most cycles behind a table branch. What fills up its table to an even size points at no instruction.
    fn table(&mut self, instruction: &Instruction, size: u32) -> Option<u64> {
        let is_code =
            |address: &u32| self.image.instructions().binary_search_by_key(address, |i| i.address).is_ok();
        let targets: Vec<u32> =
            self.image.table_targets(instruction, size)?.into_iter().filter(is_code).collect();
        let rests = targets.into_iter().map(|target| self.from(target));
        rests.collect::<Option<Vec<_>>>()?.into_iter().max()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn worst_case(code: &[u8], callee: &[u8]) -> Option<u64> {
        let all = [code, callee].concat();
        let functions = [("f", 0, code.len() as u32), ("g", code.len() as u32, callee.len() as u32)];
        worst_case_path(&Image::of_code(&all, &functions, &[]).unwrap(), 0)
    }

    const BX_LR: [u8; 2] = [0x70, 0x47];

    #[test]
    fn the_dearer_of_two_ways_counts_with_its_refill() {
        // cbz r0, 1f; adds r0, #1; adds r0, #1; 1: bx lr
        let skip = [0x08, 0xb1, 0x40, 0x1c, 0x40, 0x1c, 0x70, 0x47];
        // Taken: 1 + 3, and 1 + 3 for the return; straight through: 1 + 2, and the return.
        assert_eq!(worst_case(&skip, &BX_LR), Some(8));
        // The same with five additions in between.
        let long = [&[0x20, 0xb1][..], &[0x40, 0x1c].repeat(5), &BX_LR].concat();
        assert_eq!(worst_case(&long, &BX_LR), Some(10));
    }

    #[test]
    fn a_callee_counts_in() {
        // push {r4, lr}; bl g; pop {r4, pc}. g: bx lr
        let call = [0x10, 0xb5, 0x00, 0xf0, 0x01, 0xf8, 0x10, 0xbd];
        assert_eq!(worst_case(&call, &BX_LR), Some(3 + 4 + 4 + 3 + 3));
    }

    #[test]
    fn a_loop_and_a_pointer_have_no_bound() {
        // 1: subs r0, #1; bne 1b; bx lr
        assert_eq!(worst_case(&[0x40, 0x1e, 0xfd, 0xd1, 0x70, 0x47], &BX_LR), None);
        // blx r3; bx lr
        assert_eq!(worst_case(&[0x98, 0x47, 0x70, 0x47], &BX_LR), None);
        // push {r4, lr}; bl g; pop {r4, pc}. g: b .
        assert_eq!(worst_case(&[0x10, 0xb5, 0x00, 0xf0, 0x01, 0xf8, 0x10, 0xbd], &[0xfe, 0xe7]), None);
    }
}
