//! The device's part of the vector table (Arm DAI 0386, interrupt assignments).

use crate::control_interrupt;
use cortex_m::interrupt::InterruptNumber;

/// Interrupt of CMSDK timer 0.
#[derive(Clone, Copy)]
pub struct Timer0;

impl Timer0 {
    pub const NUMBER: usize = 8;
}

// SAFETY: the number is the one that the vector table below gives to this interrupt.
unsafe impl InterruptNumber for Timer0 {
    fn number(self) -> u16 {
        Self::NUMBER as u16
    }
}

unsafe extern "C" {
    fn DefaultHandler();
}

type Handler = unsafe extern "C" fn();

// SAFETY: this section and name are cortex-m-rt's contract for a device's vectors; every entry is a handler.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [Handler; 32] = {
    let mut table: [Handler; 32] = [DefaultHandler; 32];
    table[Timer0::NUMBER] = control_interrupt;
    table
};
