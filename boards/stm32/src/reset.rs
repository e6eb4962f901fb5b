//! What reset the chip (ST RM0090, 7.3.21; RM0440, 7.4.29; RM0433, 8.7).

use crate::Stm32;
use crate::register::Register;

/// The flags of a chip.
pub struct Flags {
    /// Address of their register.
    pub register: usize,
    /// Those of the firmware itself, the independent and the window watchdog.
    pub by_itself: u32,
    /// The bit that clears them all.
    pub clear: u32,
}

/// Whether a watchdog or the firmware itself has reset the chip: then nobody has looked after the cause. Power and the
/// reset pin do not count. The flags are cleared for the next time.
pub fn by_itself<C: Stm32>() -> bool {
    let Flags { register, by_itself, clear } = C::RESET_FLAGS;
    // SAFETY: `Stm32` promises the register.
    let register = unsafe { Register::at(register, 0) };
    let flags = register.read();
    register.write(flags | clear);
    flags & by_itself != 0
}
