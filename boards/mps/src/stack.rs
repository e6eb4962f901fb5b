//! High-water mark of the stack: cortex-m-rt paints it before `main`, use overwrites the paint.

use cortex_m_rt::STACK_PAINT_VALUE;

unsafe extern "C" {
    static _stack_start: u32;
    static _stack_end: u32;
}

/// Most bytes of stack in use at once so far.
pub fn high_water_mark() -> usize {
    let (top, bottom) = (&raw const _stack_start, &raw const _stack_end);
    let mut lowest = bottom;
    // SAFETY: the words from `_stack_end` up to `_stack_start` are RAM that nothing else owns. The reads are
    // volatile because the words in use change under the compiler's feet.
    while lowest < top && unsafe { lowest.read_volatile() } == STACK_PAINT_VALUE {
        lowest = lowest.wrapping_add(1);
    }
    top as usize - lowest as usize
}
