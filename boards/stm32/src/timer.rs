//! TIM2: the control interrupt, 10 kHz (ST RM0090, chapter 18; RM0440, chapter 30; RM0433, chapter 39).

use crate::Stm32;
use crate::register::Register;
use core::marker::PhantomData;
use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;
use strainwave_app::control::RATE;
use strainwave_controller::Timer;

const ADDRESS: usize = 0x4000_0000;
const CONTROL: usize = 0x0;
const INTERRUPTS: usize = 0xc;
const STATUS: usize = 0x10;
const RELOAD: usize = 0x2c;

/// Enabled.
const ENABLE: u32 = 1 << 0;
/// An update, its interrupt and its flag.
const UPDATE: u32 = 1 << 0;

/// Number of its interrupt.
const INTERRUPT: u16 = 28;

#[derive(Clone, Copy)]
struct Interrupt;

// SAFETY: the number that the vector table gives to TIM2, as `Stm32` promises.
unsafe impl InterruptNumber for Interrupt {
    fn number(self) -> u16 {
        INTERRUPT
    }
}

fn register(offset: usize) -> Register {
    // SAFETY: `Stm32` promises TIM2 at the address, and the offsets are those of its registers.
    unsafe { Register::at(ADDRESS, offset) }
}

/// Timer cycles in a control period: exact.
const fn period<C: Stm32>() -> u32 {
    assert!(C::TIMER_CLOCK.is_multiple_of(RATE), "the clock is no multiple of the control rate");
    C::TIMER_CLOCK / RATE
}

/// TIM2 of a chip; its own clock has to be on.
pub struct Tim2<C>(PhantomData<C>);

impl<C: Stm32> Timer for Tim2<C> {
    fn start(interrupts: &mut NVIC) {
        register(RELOAD).write(const { period::<C>() } - 1);
        register(INTERRUPTS).write(UPDATE);
        // SAFETY: no critical section relies on priorities, and what the interrupt uses is in place.
        unsafe {
            interrupts.set_priority(Interrupt, 0);
            NVIC::unmask(Interrupt);
        }
        register(CONTROL).write(ENABLE);
    }

    fn acknowledge() {
        // A flag is cleared by a 0; the others stay.
        register(STATUS).write(!UPDATE);
    }

    fn waiting() -> bool {
        register(STATUS).read() & UPDATE != 0
    }
}
