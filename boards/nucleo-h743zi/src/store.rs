//! The store of the tuning link: the last two sectors of the flash's second bank, which is written while code is read in the first (ST RM0433,
//! chapter 4).

use stm32h7::stm32h743v::FLASH;
use strainwave_stm32::flash::{Controller, StoreFlash};

use crate::clock::H743;

/// 64 bits at once, for a supply of 2.7 to 3.6 V.
const PARALLELISM: u32 = 0b11 << 4;

// SAFETY: the controller is that of the second bank of an STM32H743, which nothing uses; `memory.x` keeps the sectors free.
unsafe impl StoreFlash for H743 {
    const CONTROLLER: Controller = Controller {
        address: 0x5200_2000,
        registers: [0x104, 0x110, 0x10c, 0x114],
        busy: 0b111,
        failed: 0b110_1110 << 16,
        locked: 1 << 0,
        programs: PARALLELISM | 1 << 1,
        erases: PARALLELISM | 1 << 2,
        number: 1 << 8,
        start: 1 << 7,
        // Nor is that of the core on.
        cached: false,
    };
    // A word with its error correction.
    const UNIT: usize = 32;
    const PAGE: usize = 128 << 10;
    const FIRST: u32 = 6;
    const WRITES_BESIDE: bool = true;

    // Its two banks are not swapped, as when it is delivered.
    fn is_there() -> bool {
        // SAFETY: only read, and nothing writes it.
        let options = unsafe { (*FLASH::ptr()).optcr().read() };
        options.swap_bank().bit_is_clear()
    }
}
