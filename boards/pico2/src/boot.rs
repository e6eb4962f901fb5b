//! What the boot ROM has to find in the first 4 kB of the flash to start the image (RP2350 datasheet, 5.9.5.1), and what runs before the
//! code is in RAM.

use core::arch::global_asm;

/// Begin and end of a block.
const BEGIN: u32 = 0xffff_ded3;
const END: u32 = 0xab12_3579;
/// An item of one word: the image is a program for an RP2350's Arm cores in the secure state.
const PROGRAM: u32 = 0x1021_0142;
/// No item follows, and one word of items came.
const LAST: u32 = 0x0000_01ff;
/// Distance to the next block: there is none.
const ALONE: u32 = 0;

// SAFETY: nothing but the boot ROM looks at the section.
#[unsafe(link_section = ".start_block")]
#[used]
static IMAGE: [u32; 5] = [BEGIN, PROGRAM, LAST, ALONE, END];

// Nothing is to be done before the copy. The function that stands in for it where there is none would be in RAM, too.
global_asm!(
    ".section .start_code, \"ax\"",
    ".global __pre_init",
    ".type __pre_init, %function",
    ".thumb_func",
    "__pre_init:",
    "bx lr",
    ".size __pre_init, . - __pre_init",
    ".text",
);
