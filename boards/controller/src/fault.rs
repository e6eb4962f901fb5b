//! When something is wrong: the drive off, then nothing, until the watchdog or the operator resets the chip.

use crate::Chip;

/// Ends the image with the drive off: no interrupt enables it again.
pub fn halt<C: Chip>() -> ! {
    cortex_m::interrupt::disable();
    let (register, low) = C::RELEASE;
    // SAFETY: a write to the register that `Chip` promises takes the enable low and leaves the rest, whoever owns the port.
    unsafe { (register as *mut u32).write_volatile(low) };
    loop {
        cortex_m::asm::wfi();
    }
}
