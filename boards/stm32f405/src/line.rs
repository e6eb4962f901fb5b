//! USART1 under the tuning link.
//!
//! It has no FIFO, and the control's interrupt lasts longer than a byte: so DMA2's stream 5, channel 4, puts what comes into a ring (ST RM0090,
//! chapter 10), from which the idle loop takes it. It holds 1.4 ms of bytes. What is sent goes byte by byte from a queue, in the interrupt.

use core::sync::atomic::{AtomicU8, Ordering};
use stm32f4xx_hal::pac::{DMA2, dma2};
use stm32f4xx_hal::rcc::Enable;
use strainwave_controller::line::{Line, Queue};

use crate::serial::registers;

const RING: usize = 128;
const STREAM: usize = 5;
const CHANNEL: u8 = 4;

/// In memory that the DMA reaches.
static COME: [AtomicU8; RING] = [const { AtomicU8::new(0) }; RING];
static TO_SEND: Queue = Queue::new();

/// The link's line. There is one.
pub struct Dma {
    /// Place of the next byte in the ring.
    next: usize,
}

impl Dma {
    /// Hands the USART, which was switched on, over to the link.
    pub fn begin() -> Self {
        // SAFETY: only its clock is switched on; `board` has given the clock control up.
        unsafe { DMA2::enable_unchecked() };
        let usart = registers();
        usart.cr1().modify(|_, w| w.rxneie().disabled());
        let stream = stream();
        // SAFETY: the data register and the ring, whose length it is told, in bytes.
        unsafe {
            stream.par().write(|w| w.bits(usart.dr().as_ptr() as u32));
            stream.m0ar().write(|w| w.bits(COME.as_ptr() as u32));
            stream.ndtr().write(|w| w.bits(RING as u32));
        }
        // Bytes from the peripheral, those of the ring one after the other, over and over: the rest of the register's fields are 0.
        // SAFETY: the stream has this channel.
        stream
            .cr()
            .write(|w| unsafe { w.chsel().bits(CHANNEL) }.minc().set_bit().circ().set_bit().en().set_bit());
        usart.cr3().modify(|_, w| w.dmar().enabled());
        Self { next: 0 }
    }
}

impl Line for Dma {
    fn take(&mut self) -> Option<u8> {
        // Bytes that are left until the ring begins again.
        let left = stream().ndtr().read().bits() as usize;
        if self.next == RING.wrapping_sub(left) % RING {
            return None;
        }
        let byte = COME.get(self.next).map(|byte| byte.load(Ordering::Relaxed));
        self.next = (self.next + 1) % RING;
        byte
    }

    fn put(&mut self, byte: u8) -> bool {
        let room = TO_SEND.enqueue(byte).is_ok();
        registers().cr1().modify(|_, w| w.txeie().enabled());
        room
    }
}

/// Sends the next byte, in the USART's interrupt.
pub fn serve() {
    let usart = registers();
    if usart.sr().read().txe().bit_is_clear() {
        return;
    }
    let Some(byte) = TO_SEND.dequeue() else {
        usart.cr1().modify(|_, w| w.txeie().disabled());
        return;
    };
    // SAFETY: the data register takes any byte.
    usart.dr().write(|w| unsafe { w.bits(u16::from(byte)) });
}

fn stream() -> &'static dma2::ST {
    // SAFETY: `board` has given the DMA up, and nothing else has it.
    unsafe { (*DMA2::ptr()).st(STREAM) }
}
