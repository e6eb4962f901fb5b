//! An FDCAN of an STM32G4 with frames of classic CAN at 1 Mbit/s (ST RM0440, chapter 44).
//!
//! Its message memory has fixed places: filters, two queues of three frames that have come, three places for frames to be sent.

use core::convert::Infallible;
use core::marker::PhantomData;
use embedded_can::nb::Can;
use embedded_can::{Frame as _, Id, StandardId};
use strainwave_app::commanded::Frame;
use strainwave_controller::clock::starts;

use crate::register::Register;

/// Clock of the peripheral (Hz): the crystal's.
pub const CLOCK: u32 = 24_000_000;

/// Control: initialisation, and with it protected registers are written.
const CONTROL: usize = 0x18;
const INITIALISES: u32 = 1 << 0;
const CONFIGURES: u32 = 1 << 1;
/// Time quanta: 1 + 20 before the sample, 3 behind it, of one clock each; the sample is at 87.5 %.
const BIT_TIMING: usize = 0x1c;
const AT_1_MBIT: u32 = 2 << 25 | 19 << 8 | 2;
const _: () = assert!(CLOCK == (1 + 20 + 3) * 1_000_000);
/// Filters: how many, remote frames and those that pass none refused.
const FILTERS: usize = 0x80;
const REFUSES_OTHERS: u32 = 0b11_1111;
/// Status: the controller has left the bus.
const STATUS: usize = 0x44;
const OFF_THE_BUS: u32 = 1 << 7;
/// Of each queue of what has come: its level and its next place, and the place that was read.
const COME: [(usize, usize); 2] = [(0x90, 0x94), (0x98, 0x9c)];
const LEVEL: u32 = 0xf;
/// Frames to be sent go out in the order in which they were put.
const SEND_QUEUE: usize = 0xc0;
const SEND_STATUS: usize = 0xc4;
const FULL: u32 = 1 << 21;
const SEND: usize = 0xcc;

/// In the message memory, in bytes: filters of 11 bits, what has come, what is sent; and from one place to the next.
const FILTER: usize = 0x000;
const COME_PLACES: [usize; 2] = [0x0b0, 0x188];
const SEND_PLACES: usize = 0x278;
const PLACE: usize = 72;

/// An FDCAN of a board.
///
/// # Safety
/// One is at the address and its message memory at the other, nothing else uses either, and its clock, of [`CLOCK`], is on before
/// [`Bus::start`].
pub unsafe trait FdCan {
    /// Where it is.
    const ADDRESS: usize;
    /// Its part of the message memory.
    const MEMORY: usize;
}

/// Frames that are taken: those whose identifier is `id` in the bits of `mask`.
#[derive(Clone, Copy)]
pub struct Filter {
    /// 11 bits.
    pub id: u16,
    /// 11 bits.
    pub mask: u16,
    /// Queue, 0 or 1. What is to stay in the order in which it came has to be in one.
    pub queue: u8,
}

impl Filter {
    /// By identifier and mask, to a queue.
    fn word(self) -> u32 {
        2 << 30 | (u32::from(self.queue & 1) + 1) << 27 | u32::from(self.id) << 16 | u32::from(self.mask)
    }
}

/// The bus.
pub struct Bus<F>(PhantomData<F>);

impl<F: FdCan> Bus<F> {
    /// Joins the bus; `None` where the peripheral does not answer.
    pub fn start<const N: usize>(filters: [Filter; N]) -> Option<Self> {
        const { assert!(N <= 28, "there are 28 filters") };
        register::<F>(CONTROL).write(INITIALISES);
        starts(|| register::<F>(CONTROL).read() & INITIALISES != 0).then_some(())?;
        register::<F>(CONTROL).write(INITIALISES | CONFIGURES);
        register::<F>(BIT_TIMING).write(AT_1_MBIT);
        register::<F>(FILTERS).write((N as u32) << 16 | REFUSES_OTHERS);
        register::<F>(SEND_QUEUE).write(0);
        for (index, filter) in filters.into_iter().enumerate() {
            memory::<F>(FILTER + 4 * index).write(filter.word());
        }
        register::<F>(CONTROL).write(0);
        starts(|| register::<F>(CONTROL).read() & INITIALISES == 0).then_some(Self(PhantomData))
    }

    fn next(queue: usize) -> Option<Frame> {
        let (&(status, taken), &places) = (COME.get(queue)?, COME_PLACES.get(queue)?);
        let status = register::<F>(status).read();
        if status & LEVEL == 0 {
            return None;
        }
        let index = status >> 8 & 0b11;
        let place = places + PLACE * index as usize;
        let word = |offset: usize| memory::<F>(place + offset).read();
        let bytes = u64::from(word(12)) << 32 | u64::from(word(8));
        let length = (word(4) >> 16 & 0xf).min(8) as usize;
        let id = StandardId::new((word(0) >> 18 & 0x7ff) as u16);
        register::<F>(taken).write(index);
        Frame::new(id?, bytes.to_le_bytes().get(..length)?)
    }
}

impl<F: FdCan> Can for Bus<F> {
    type Frame = Frame;
    type Error = Infallible;

    fn transmit(&mut self, frame: &Frame) -> nb::Result<Option<Frame>, Infallible> {
        let status = register::<F>(SEND_STATUS).read();
        if status & FULL != 0 {
            return Err(nb::Error::WouldBlock);
        }
        let index = status >> 16 & 0b11;
        let place = SEND_PLACES + PLACE * index as usize;
        let id = match frame.id() {
            Id::Standard(id) => u32::from(id.as_raw()) << 18,
            Id::Extended(id) => id.as_raw() | 1 << 30,
        };
        let data = frame.data();
        let byte = |at: usize| u32::from(data.get(at).copied().unwrap_or_default());
        let word =
            |first: usize| byte(first) | byte(first + 1) << 8 | byte(first + 2) << 16 | byte(first + 3) << 24;
        memory::<F>(place).write(id);
        memory::<F>(place + 4).write((data.len() as u32) << 16);
        memory::<F>(place + 8).write(word(0));
        memory::<F>(place + 12).write(word(4));
        register::<F>(SEND).write(1 << index);
        Ok(None)
    }

    fn receive(&mut self) -> nb::Result<Frame, Infallible> {
        if register::<F>(STATUS).read() & OFF_THE_BUS != 0 {
            // Joins again, when the bus has been idle for 128 times 11 bits.
            register::<F>(CONTROL).write(0);
        }
        Self::next(0).or_else(|| Self::next(1)).ok_or(nb::Error::WouldBlock)
    }
}

fn register<F: FdCan>(offset: usize) -> Register {
    // SAFETY: `FdCan` promises it there, and the offsets are those of its registers.
    unsafe { Register::at(F::ADDRESS, offset) }
}

fn memory<F: FdCan>(offset: usize) -> Register {
    // SAFETY: `FdCan` promises it there, and the offsets are within its part, of 0x350 bytes; it is read and written by words.
    unsafe { Register::at(F::MEMORY, offset) }
}
