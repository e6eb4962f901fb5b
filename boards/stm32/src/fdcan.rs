//! An FDCAN of an STM32G4 with frames of classic CAN at 1 Mbit/s (ST RM0440, chapter 44, whose names these are).
//!
//! Its message RAM has fixed places: filters, two RX FIFOs of three elements, three elements of the TX FIFO.

use core::convert::Infallible;
use core::marker::PhantomData;
use embedded_can::nb::Can;
use embedded_can::{Frame as _, StandardId};
use strainwave_app::commanded::Frame;
use strainwave_controller::clock::starts;

use crate::register::Register;

/// Clock of the peripheral (Hz): the crystal's.
pub const CLOCK: u32 = 24_000_000;

const CCCR: usize = 0x18;
const INIT: u32 = 1 << 0;
const CCE: u32 = 1 << 1;
/// Time quanta: 1 + 20 before the sample, 3 behind it, of one clock each; the sample is at 87.5 %.
const NBTP: usize = 0x1c;
const AT_1_MBIT: u32 = 2 << 25 | 19 << 8 | 2;
const _: () = assert!(CLOCK == (1 + 20 + 3) * 1_000_000);
const PSR: usize = 0x44;
const BUS_OFF: u32 = 1 << 7;
/// Number of filters in bits 16 on; remote frames and those that pass no filter are refused.
const RXGFC: usize = 0x80;
const REFUSE_OTHERS: u32 = 0b11_1111;
/// Status and acknowledge of either RX FIFO.
const RX_FIFOS: [(usize, usize); 2] = [(0x90, 0x94), (0x98, 0x9c)];
const FILL_LEVEL: u32 = 0xf;
const TXBC: usize = 0xc0;
const TXFQS: usize = 0xc4;
const TX_FULL: u32 = 1 << 21;
const TXBRP: usize = 0xc8;
const TXBAR: usize = 0xcc;

/// In the message RAM, in bytes: filters of 11 bits, elements of the RX FIFOs and of the TX FIFO, and from one element to the next.
const FILTERS: usize = 0x000;
const RX_ELEMENTS: [usize; 2] = [0x0b0, 0x188];
const TX_ELEMENTS: usize = 0x278;
const ELEMENT: usize = 72;

/// Calls of `receive`, one in a control period, in which a frame waits to be sent, at most: then nobody listens, or the node is off the bus. All
/// that waits is dropped, and the node joins anew: what is sent is not to be old.
const LONGEST_WAIT: u32 = 50;

/// An FDCAN of a board.
///
/// # Safety
/// One is at the address and its message RAM at the other, nothing else uses either, and its clock, of [`CLOCK`], is on before
/// [`Bus::start`].
pub unsafe trait FdCan {
    /// Where it is.
    const ADDRESS: usize;
    /// Its part of the message RAM.
    const MESSAGE_RAM: usize;
    /// RX FIFOs that its filters use, 1 or 2.
    const FIFOS: usize = 2;
}

/// Frames that are taken: those whose identifier is `id` in the bits of `mask`.
#[derive(Clone, Copy)]
pub struct Filter {
    /// 11 bits.
    pub id: u16,
    /// 11 bits.
    pub mask: u16,
    /// RX FIFO, 0 or 1. What is to stay in the order in which it came has to be in one.
    pub fifo: u8,
}

impl Filter {
    /// A classic filter, by identifier and mask.
    fn word(self) -> u32 {
        2 << 30 | (u32::from(self.fifo & 1) + 1) << 27 | u32::from(self.id) << 16 | u32::from(self.mask)
    }
}

/// The bus.
pub struct Bus<F> {
    /// Calls of `receive` in which a frame has waited.
    waited: u32,
    peripheral: PhantomData<F>,
}

impl<F: FdCan> Bus<F> {
    /// Joins the bus; `None` where the peripheral does not answer.
    pub fn start<const N: usize>(filters: [Filter; N]) -> Option<Self> {
        const { assert!(N <= 28, "there are 28 filters") };
        register::<F>(CCCR).write(INIT);
        starts(|| register::<F>(CCCR).read() & INIT != 0).then_some(())?;
        register::<F>(CCCR).write(INIT | CCE);
        register::<F>(NBTP).write(AT_1_MBIT);
        register::<F>(RXGFC).write((N as u32) << 16 | REFUSE_OTHERS);
        register::<F>(TXBC).write(0);
        for (index, filter) in filters.into_iter().enumerate() {
            message_ram::<F>(FILTERS + 4 * index).write(filter.word());
        }
        register::<F>(CCCR).write(0);
        let joins = starts(|| register::<F>(CCCR).read() & INIT == 0);
        joins.then_some(Self { waited: 0, peripheral: PhantomData })
    }

    /// Whether the node takes part; where it has not sent for long it is made to join anew, a step at a time: INIT is read back a microsecond
    /// after it is written, and CCE, which drops what waits, is taken with it only.
    fn takes_part(&mut self) -> bool {
        let waits = register::<F>(TXBRP).read() != 0 || register::<F>(PSR).read() & BUS_OFF != 0;
        self.waited = match self.waited {
            0..LONGEST_WAIT => {
                if waits {
                    self.waited + 1
                } else {
                    0
                }
            }
            LONGEST_WAIT => {
                register::<F>(CCCR).write(INIT);
                LONGEST_WAIT + 1
            }
            _ if register::<F>(CCCR).read() & CCE == 0 => {
                register::<F>(CCCR).write(INIT | CCE);
                LONGEST_WAIT + 1
            }
            _ => {
                register::<F>(CCCR).write(0);
                0
            }
        };
        self.waited < LONGEST_WAIT
    }

    fn next(fifo: usize) -> Option<Frame> {
        let (&(status, acknowledge), &elements) = (RX_FIFOS.get(fifo)?, RX_ELEMENTS.get(fifo)?);
        let status = register::<F>(status).read();
        if status & FILL_LEVEL == 0 {
            return None;
        }
        let index = status >> 8 & 0b11;
        let element = elements + ELEMENT * index as usize;
        let word = |offset: usize| message_ram::<F>(element + offset).read();
        let bytes = u64::from(word(12)) << 32 | u64::from(word(8));
        let length = (word(4) >> 16 & 0xf) as u8;
        let id = StandardId::new((word(0) >> 18 & 0x7ff) as u16);
        register::<F>(acknowledge).write(index);
        Some(Frame::of_word(id?, length, bytes))
    }
}

impl<F: FdCan> Can for Bus<F> {
    type Frame = Frame;
    type Error = Infallible;

    fn transmit(&mut self, frame: &Frame) -> nb::Result<Option<Frame>, Infallible> {
        let status = register::<F>(TXFQS).read();
        if status & TX_FULL != 0 || self.waited >= LONGEST_WAIT {
            return Err(nb::Error::WouldBlock);
        }
        let index = status >> 16 & 0b11;
        let element = TX_ELEMENTS + ELEMENT * index as usize;
        let word = frame.word();
        message_ram::<F>(element).write(u32::from(frame.number()) << 18);
        message_ram::<F>(element + 4).write((frame.dlc() as u32) << 16);
        message_ram::<F>(element + 8).write(word as u32);
        message_ram::<F>(element + 12).write((word >> 32) as u32);
        register::<F>(TXBAR).write(1 << index);
        Ok(None)
    }

    fn receive(&mut self) -> nb::Result<Frame, Infallible> {
        if !self.takes_part() {
            return Err(nb::Error::WouldBlock);
        }
        let second = || if F::FIFOS > 1 { Self::next(1) } else { None };
        Self::next(0).or_else(second).ok_or(nb::Error::WouldBlock)
    }
}

fn register<F: FdCan>(offset: usize) -> Register {
    // SAFETY: `FdCan` promises it there, and the offsets are those of its registers.
    unsafe { Register::at(F::ADDRESS, offset) }
}

fn message_ram<F: FdCan>(offset: usize) -> Register {
    // SAFETY: `FdCan` promises it there, and the offsets are within its part, of 0x350 bytes; it is read and written by words.
    unsafe { Register::at(F::MESSAGE_RAM, offset) }
}
