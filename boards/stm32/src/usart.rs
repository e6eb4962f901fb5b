//! A USART of an STM32G4 or STM32H7: telemetry out, the operator's keys in (ST RM0440, chapter 37; RM0433, chapter 48). That of an STM32F4
//! has other registers.

use crate::register::Register;
use strainwave_controller::keys;
#[cfg(feature = "served")]
use strainwave_controller::line::{Line, Queue};

/// Symbols a second [Bd].
pub const RATE: u32 = 921_600;

const CONTROL: usize = 0x00;
const DIVIDER: usize = 0x0c;
const STATUS: usize = 0x1c;
const CLEAR: usize = 0x20;
const RECEIVED: usize = 0x24;
const SENT: usize = 0x28;

/// On, receives, sends, and interrupts for each character that comes.
const ON: u32 = 1 << 0 | 1 << 2 | 1 << 3 | 1 << 5;
/// In the status: a character came before the last was taken, one has come, there is room for one.
const OVERRUN: u32 = 1 << 3;
const HAS_COME: u32 = 1 << 5;
const HAS_ROOM: u32 = 1 << 7;

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

/// Its two FIFOs, of 8 bytes at least, are on. That is chosen while it is off.
#[cfg(feature = "served")]
const FIFO: u32 = 1 << 29;
/// It interrupts where there is room for a byte to send.
#[cfg(feature = "served")]
const ROOM_INTERRUPTS: u32 = 1 << 7;

/// Bytes that have come, and that are to be sent.
#[cfg(feature = "served")]
static COME: Queue = Queue::new();
#[cfg(feature = "served")]
static TO_SEND: Queue = Queue::new();

/// A USART as the line of the tuning link. There is one.
#[cfg(feature = "served")]
pub struct Linked<U>(core::marker::PhantomData<U>);

#[cfg(feature = "served")]
impl<U: Usart> Linked<U> {
    /// Hands a USART that [`start`] has switched on over to the link.
    pub fn begin() -> Self {
        register::<U>(CONTROL).write(0);
        register::<U>(CONTROL).write(FIFO | ON);
        Self(core::marker::PhantomData)
    }
}

#[cfg(feature = "served")]
impl<U: Usart> Line for Linked<U> {
    fn take(&mut self) -> Option<u8> {
        COME.dequeue()
    }

    fn put(&mut self, byte: u8) -> bool {
        let room = TO_SEND.enqueue(byte).is_ok();
        register::<U>(CONTROL).write(FIFO | ON | ROOM_INTERRUPTS);
        room
    }
}

/// Serves the interrupt of a USART that the link has. A byte for which there is no room is lost, as on a line.
#[cfg(feature = "served")]
pub fn serve<U: Usart>() {
    register::<U>(CLEAR).write(OVERRUN);
    while register::<U>(STATUS).read() & HAS_COME != 0 {
        let _ = COME.enqueue(register::<U>(RECEIVED).read() as u8);
    }
    while register::<U>(STATUS).read() & HAS_ROOM != 0 {
        let Some(byte) = TO_SEND.dequeue() else {
            register::<U>(CONTROL).write(FIFO | ON);
            return;
        };
        register::<U>(SENT).write(u32::from(byte));
    }
}

fn register<U: Usart>(offset: usize) -> Register {
    // SAFETY: `Usart` promises it there, and the offsets are those of its registers. The idle loop only sends and the interrupt only
    // receives, each by registers of its own.
    unsafe { Register::at(U::ADDRESS, offset) }
}
