//! What reset the chip (ST RM0090, 7.3.21; RM0440, 7.4.29).

use crate::Chip;
use crate::register::Register;

/// Flags of the firmware itself, the independent and the window watchdog.
const BY_ITSELF: u32 = 1 << 28 | 1 << 29 | 1 << 30;

/// Whether a watchdog or the firmware itself has reset the chip: then nobody has looked after the cause. Power and the
/// reset pin do not count. The flags are cleared for the next time.
pub fn by_itself<C: Chip>() -> bool {
    let (address, clear) = C::RESET_FLAGS;
    // SAFETY: `Chip` promises the register.
    let register = unsafe { Register::at(address, 0) };
    let flags = register.read();
    register.write(flags | clear);
    flags & BY_ITSELF != 0
}
