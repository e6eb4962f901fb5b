//! The 10 kHz timers of the boards: Arm's CMSDK timer, or the core's own SysTick where the board has none.
//!
//! References: Arm DDI 0479, CMSDK APB timer; Arm DDI 0553 (Armv8-M), SysTick.

use crate::Machine;
use crate::register::Register;
use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::{NVIC, SCB, SYST};
use strainwave_app::control::RATE;

/// A timer.
#[derive(Clone, Copy, Debug)]
pub enum Timer {
    /// CMSDK timer.
    Cmsdk {
        /// Address of its first register.
        address: usize,
        /// Its clock (Hz).
        clock: u32,
        /// Number of its interrupt.
        interrupt: u16,
    },
    /// The core's own.
    SysTick {
        /// The core's clock (Hz).
        clock: u32,
    },
}

const CONTROL: usize = 0x0;
const RELOAD: usize = 0x8;
/// Reads as status, writes as clear.
const INTERRUPT: usize = 0xc;

const ENABLE: u32 = 1 << 0;
const INTERRUPT_ENABLE: u32 = 1 << 3;

/// Of SysTick: enabled, with its exception, by the core's clock.
const SYSTICK_ENABLE: u32 = 1 << 0 | 1 << 1 | 1 << 2;

impl Timer {
    /// Number of its interrupt; 0 of SysTick, which is an exception and has none.
    pub const fn interrupt(&self) -> usize {
        match *self {
            Self::Cmsdk { interrupt, .. } => interrupt as usize,
            Self::SysTick { .. } => 0,
        }
    }

    /// Clock cycles in a control period: exact.
    const fn period(&self) -> u32 {
        let (Self::Cmsdk { clock, .. } | Self::SysTick { clock }) = *self;
        assert!(clock.is_multiple_of(RATE), "the clock is no multiple of the control rate");
        clock / RATE
    }
}

/// Interrupt of a CMSDK timer.
#[derive(Clone, Copy)]
struct Interrupt(u16);

// SAFETY: the only number that it is made with is the one that the vector table gives to the timer.
unsafe impl InterruptNumber for Interrupt {
    fn number(self) -> u16 {
        self.0
    }
}

fn register(address: usize, offset: usize) -> Register {
    // SAFETY: `Machine` promises a timer at the address, and the offsets are those of its registers.
    unsafe { Register::at(address, offset) }
}

/// Starts the interrupt, at the highest priority.
pub fn start<M: Machine>() {
    let period = const { M::TIMER.period() };
    match M::TIMER {
        Timer::Cmsdk { address, interrupt, .. } => {
            register(address, RELOAD).write(period - 1);
            // SAFETY: no critical section relies on priorities, and what the interrupt uses is in place.
            unsafe {
                let nvic = &*NVIC::PTR;
                nvic.ipr[usize::from(interrupt)].write(0);
                NVIC::unmask(Interrupt(interrupt));
            }
            register(address, CONTROL).write(ENABLE | INTERRUPT_ENABLE);
        }
        // SAFETY: what the exception uses is in place, nothing else uses the timer, and its priority is 0 from reset.
        Timer::SysTick { .. } => unsafe {
            let timer = &*SYST::PTR;
            timer.rvr.write(period - 1);
            timer.cvr.write(0);
            timer.csr.write(SYSTICK_ENABLE);
        },
    }
}

/// Clears the interrupt that is being served; the core does so itself with an exception.
pub fn acknowledge<M: Machine>() {
    if let Timer::Cmsdk { address, .. } = M::TIMER {
        register(address, INTERRUPT).write(1);
    }
}

/// The next interrupt is already waiting.
pub fn waiting<M: Machine>() -> bool {
    match M::TIMER {
        Timer::Cmsdk { address, .. } => register(address, INTERRUPT).read() & 1 != 0,
        Timer::SysTick { .. } => SCB::is_pendst_pending(),
    }
}
