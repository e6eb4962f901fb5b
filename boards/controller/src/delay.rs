//! Waiting by counting cycles of the core.

use core::marker::PhantomData;
use embedded_hal::delay::DelayNs;

use crate::Chip;

/// Waits at the core's full clock.
pub struct CycleDelay<C>(PhantomData<C>);

impl<C: Chip> CycleDelay<C> {
    /// A delay.
    #[expect(clippy::new_without_default, reason = "no chip has a default")]
    pub const fn new() -> Self {
        Self(PhantomData)
    }
}

impl<C: Chip> DelayNs for CycleDelay<C> {
    fn delay_ns(&mut self, time: u32) {
        // Rounded up; a microsecond at a time, so that nothing overflows.
        let per_microsecond = const { C::CORE_CLOCK / 1_000_000 };
        for _ in 0..time / 1000 {
            cortex_m::asm::delay(per_microsecond);
        }
        cortex_m::asm::delay(time % 1000 * per_microsecond / 1000 + 1);
    }
}
