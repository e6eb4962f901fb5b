//! A USART of an STM32G4 or STM32H7: telemetry out, the operator's keys in (ST RM0440, chapter 37; RM0433, chapter 48). That of an STM32F4
//! has other registers.

use crate::register::Register;
use strainwave_controller::keys;

/// Symbols a second [Bd].
pub const RATE: u32 = 921_600;

pub(crate) const CONTROL: usize = 0x00;
const DIVIDER: usize = 0x0c;
pub(crate) const STATUS: usize = 0x1c;
pub(crate) const CLEAR: usize = 0x20;
pub(crate) const RECEIVED: usize = 0x24;
pub(crate) const SENT: usize = 0x28;

/// On, receives, sends, and interrupts for each character that comes.
pub(crate) const ON: u32 = 1 << 0 | 1 << 2 | 1 << 3 | 1 << 5;
/// In the status: a character came before the last was taken, one has come, there is room for one.
pub(crate) const OVERRUN: u32 = 1 << 3;
pub(crate) const HAS_COME: u32 = 1 << 5;
pub(crate) const HAS_ROOM: u32 = 1 << 7;

/// A USART of a board.
///
/// # Safety
/// One is at the address, nothing else uses it, and its own clock is on before [`start`].
pub unsafe trait Usart {
    /// Where it is.
    const ADDRESS: usize;
}

/// Switches it on; `clock` is the one that it divides (Hz), at least 16 times [`RATE`].
pub fn start<U: Usart>(clock: u32) {
    register::<U>(DIVIDER).write((clock + RATE / 2) / RATE);
    register::<U>(CONTROL).write(ON);
}

/// Takes the key that interrupted.
pub fn receive<U: Usart>() {
    // An overrun interrupts until it is cleared.
    register::<U>(CLEAR).write(OVERRUN);
    if register::<U>(STATUS).read() & HAS_COME != 0 {
        keys::take(register::<U>(RECEIVED).read() as u8);
    }
}

/// Sends bytes, waiting for room for each: idle loop only.
pub fn send<U: Usart>(bytes: &[u8]) {
    for byte in bytes {
        while register::<U>(STATUS).read() & HAS_ROOM == 0 {}
        register::<U>(SENT).write(u32::from(*byte));
    }
}

pub(crate) fn register<U: Usart>(offset: usize) -> Register {
    // SAFETY: `Usart` promises it there, and the offsets are those of its registers. The idle loop only sends and the interrupt only
    // receives, each by registers of its own.
    unsafe { Register::at(U::ADDRESS, offset) }
}
