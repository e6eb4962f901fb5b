//! The store of the tuning link: the last two pages of the flash's second bank, which is written while code is read in the first (ST RM0440,
//! chapter 3).

use stm32g4xx_hal::pac::FLASH;
use strainwave_stm32::flash::{Controller, StoreFlash};

use crate::clock::G474;

/// The second bank, in which the page's number counts.
const SECOND_BANK: u32 = 1 << 11;

// SAFETY: the controller is that of an STM32G474, which nothing uses after the clock's start; `memory.x` keeps the pages free.
unsafe impl StoreFlash for G474 {
    const CONTROLLER: Controller = Controller {
        address: 0x4002_2000,
        registers: [0x08, 0x10, 0x14, 0x10],
        busy: 1 << 16,
        failed: 0b11_1111_1010,
        locked: 1 << 31,
        programs: 1 << 0,
        erases: SECOND_BANK | 1 << 1,
        number: 1 << 3,
        start: 1 << 16,
        cached: true,
    };
    const UNIT: usize = 8;
    const PAGE: usize = 2 << 10;
    const FIRST: u32 = 126;
    const WRITES_BESIDE: bool = true;

    // Two banks, of which the chip starts from the first, as when it is delivered.
    fn is_there() -> bool {
        // SAFETY: only read, and nothing writes it.
        let options = unsafe { (*FLASH::ptr()).optr().read() };
        options.dbank().bit_is_set() && options.bfb2().bit_is_clear()
    }
}
