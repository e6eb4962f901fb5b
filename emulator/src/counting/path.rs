//! Cost of the instructions of one call, function by function.

use std::collections::BTreeMap;

use super::cycle_table::{REFILL, cycles};
use crate::artifact::Image;
use crate::artifact::disassembly::{Flow, Instruction};

/// Cycles of each instruction of a path through `image`, its address first; `None` where one has no cost.
pub fn costs(image: &Image, path: &[u32]) -> Option<Vec<(u32, u64)>> {
    let code = image.instructions();
    let cost = |(k, address): (usize, &u32)| {
        let place = code.binary_search_by_key(address, |i| i.address).ok()?;
        let instruction = &code[place];
        let before = place.checked_sub(1).map(|k| &code[k]).filter(|b| b.next() == *address);
        let refill = if is_taken(instruction, path.get(k + 1)) { REFILL } else { 0 };
        Some((*address, u64::from(cycles(instruction, before)? + refill)))
    };
    path.iter().enumerate().map(cost).collect()
}

/// A branch that might not be taken, and was; a path ends with a return.
fn is_taken(instruction: &Instruction, next: Option<&u32>) -> bool {
    let leaves = instruction.flow() != Flow::Straight && instruction.may_fall_through();
    let is_call =
        matches!(instruction.flow(), Flow::Call(_) | Flow::CallIndirect) && !instruction.conditional;
    leaves && !is_call && next != Some(&instruction.next())
}

/// Cycles of a path in each function that it goes through, those of its callees apart, the most first; `None` where an
/// instruction has no cost.
pub fn by_function(image: &Image, path: &[u32]) -> Option<Vec<(String, u64)>> {
    let mut sums: BTreeMap<&str, u64> = BTreeMap::new();
    for (address, cycles) in costs(image, path)? {
        let function = image.function_at(address)?;
        *sums.entry(image.functions()[function].name()).or_default() += cycles;
    }
    let mut sums: Vec<_> = sums.into_iter().map(|(name, cycles)| (name.to_owned(), cycles)).collect();
    sums.sort_by_key(|(_, cycles)| std::cmp::Reverse(*cycles));
    Some(sums)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_costs_what_its_instructions_do() {
        // f: cbz r0, 4; adds r0, #1; 4: bl g; bx lr. g: bx lr
        let code = [0x00, 0xb1, 0x40, 0x1c, 0x00, 0xf0, 0x01, 0xf8, 0x70, 0x47, 0x70, 0x47];
        let image = Image::of_code(&code, &[("f", 0, 10), ("g", 10, 2)], &[]).unwrap();
        let straight = [("f".to_owned(), 1 + 1 + 4 + 4), ("g".to_owned(), 4)];
        assert_eq!(by_function(&image, &[0, 2, 4, 10, 8]).unwrap(), straight);
        let taken = by_function(&image, &[0, 4, 10, 8]).unwrap();
        assert_eq!(taken[0], ("f".to_owned(), 1 + 3 + 4 + 4));
        assert_eq!(by_function(&image, &[1]), None);
    }
}
