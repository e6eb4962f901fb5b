//! A USART of an STM32G4 or STM32H7 under the tuning link: FIFOs, and a queue in front of each.

use core::marker::PhantomData;
use strainwave_controller::line::{Line, Queue};

use crate::usart::{
    CLEAR, CONTROL, HAS_COME, HAS_ROOM, ON, OVERRUN, RECEIVED, SENT, STATUS, Usart, register,
};

/// Its two FIFOs, of 8 bytes at least, are on. That is chosen while it is off.
const FIFO: u32 = 1 << 29;
/// It interrupts where there is room for a byte to send.
const ROOM_INTERRUPTS: u32 = 1 << 7;

/// Bytes that have come, and that are to be sent.
static COME: Queue = Queue::new();
static TO_SEND: Queue = Queue::new();

/// A USART as the line of the tuning link. There is one.
pub struct Linked<U>(PhantomData<U>);

impl<U: Usart> Linked<U> {
    /// Hands a USART that [`crate::usart::start`] has switched on over to the link.
    pub fn begin() -> Self {
        register::<U>(CONTROL).write(0);
        register::<U>(CONTROL).write(FIFO | ON);
        Self(PhantomData)
    }
}

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
