//! CMSDK timer 0: the control interrupt, 10 kHz from the board's 25 MHz clock
//! (Arm DDI 0479, CMSDK APB timer; Arm DAI 0386, memory map).

use crate::register::Register;
use crate::vectors::Timer0;
use cortex_m::peripheral::NVIC;
use strainwave_app::control::RATE;

/// Clock of every peripheral on the board (Hz).
pub const CLOCK: u32 = 25_000_000;

/// Clock cycles in a control period: exact.
pub const PERIOD: u32 = CLOCK / RATE;
const _: () = assert!(PERIOD * RATE == CLOCK);

// SAFETY: timer 0 of this board is at 0x4000_0000; these are its registers.
const CONTROL: Register = unsafe { Register::at(0x4000_0000) };
// SAFETY: as above.
const RELOAD: Register = unsafe { Register::at(0x4000_0008) };
// SAFETY: as above. Reads as status, writes as clear.
const INTERRUPT: Register = unsafe { Register::at(0x4000_000c) };

const ENABLE: u32 = 1 << 0;
const INTERRUPT_ENABLE: u32 = 1 << 3;

/// Starts the interrupt, at the highest priority.
pub fn start() {
    RELOAD.write(PERIOD - 1);
    // SAFETY: no critical section relies on priorities, and what the interrupt uses is in place.
    unsafe {
        let nvic = &*NVIC::PTR;
        nvic.ipr[Timer0::NUMBER].write(0);
        NVIC::unmask(Timer0);
    }
    CONTROL.write(ENABLE | INTERRUPT_ENABLE);
}

/// Clears the interrupt that is being served.
pub fn acknowledge() {
    INTERRUPT.write(1);
}

/// The next interrupt is already waiting.
pub fn waiting() -> bool {
    INTERRUPT.read() & 1 != 0
}
