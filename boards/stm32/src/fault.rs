//! When something is wrong: the drive off, then nothing, until the watchdog or the operator resets the chip.

use crate::Chip;
use crate::register::Register;

/// Ends the image with the drive off.
pub fn halt<C: Chip>() -> ! {
    let (register, low) = C::RELEASE;
    // SAFETY: a write to the set-and-reset register, as `Chip` promises, takes the enable low, whoever owns the port.
    unsafe { Register::at(register, 0) }.write(low);
    loop {
        cortex_m::asm::wfi();
    }
}
