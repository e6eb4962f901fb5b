//! The store of the tuning link: sectors 1 and 2 of the flash, from which code cannot be read while one of them is erased or written (ST
//! RM0090, chapter 3).

use strainwave_stm32::flash::{Controller, StoreFlash};

use crate::clock::F405;

/// 32 bits at once, for a supply of 2.7 to 3.6 V.
const PARALLELISM: u32 = 0b10 << 8;

// SAFETY: the controller is that of an STM32F405, which nothing uses after the clock's start; `memory-served.x` keeps the sectors free.
unsafe impl StoreFlash for F405 {
    const CONTROLLER: Controller = Controller {
        address: 0x4002_3c00,
        registers: [0x04, 0x0c, 0x10, 0x0c],
        busy: 1 << 16,
        failed: 0b1_1111_0010,
        locked: 1 << 31,
        programs: PARALLELISM | 1 << 0,
        erases: PARALLELISM | 1 << 1,
        number: 1 << 3,
        start: 1 << 16,
        cached: true,
    };
    const UNIT: usize = 4;
    const PAGE: usize = 16 << 10;
    const FIRST: u32 = 1;
    const WRITES_BESIDE: bool = false;
}
