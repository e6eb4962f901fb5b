//! Registers of an STM32G4's FDCAN (ST RM0440, 44.4), as a node of a bus has them.

use std::collections::VecDeque;

use crate::chips::can::CanFrame;
use crate::chips::registers::Words;
use crate::chips::stm32::g4_fdcan::message_ram::{MessageRam, Outgoing};
use crate::chips::stm32::g4_fdcan::ring::Ring;

const CREL: usize = 0x00;
const ENDN: usize = 0x04;
const DBTP: usize = 0x0c;
const CCCR: usize = 0x18;
const NBTP: usize = 0x1c;
const ECR: usize = 0x40;
const PSR: usize = 0x44;
const IR: usize = 0x50;
const IE: usize = 0x54;
const ILS: usize = 0x58;
const ILE: usize = 0x5c;
const RXGFC: usize = 0x80;
const XIDAM: usize = 0x84;
/// Status of FIFO 0 and 1, and what acknowledges their elements.
const RXFS: [usize; 2] = [0x90, 0x98];
const RXFA: [usize; 2] = [0x94, 0x9c];
const TXBC: usize = 0xc0;
const TXFQS: usize = 0xc4;
const TXBRP: usize = 0xc8;
const TXBAR: usize = 0xcc;
const TXBTO: usize = 0xd4;
const TXBTIE: usize = 0xdc;
const CKDIV: usize = 0x100;

/// Registers that are not 0 out of reset.
const RESET: [(usize, u32); 5] = [
    (CREL, 0x3214_1218),
    (ENDN, 0x8765_4321),
    (DBTP, 0x0000_0a33),
    (NBTP, 0x0600_0a03),
    (XIDAM, 0x1fff_ffff),
];

/// In the control: off the bus; protected registers are open; FD, with its faster bits.
const INIT: u32 = 1 << 0;
const OPEN: u32 = 1 << 1;
const FLEXIBLE: u32 = 0b11 << 8;
/// In the status of the protocol: no error of the data phase; passive, warning, bus off.
const NO_DATA_ERROR: u32 = 7 << 8;
const PASSIVE: u32 = 1 << 5;
const WARNING: u32 = 1 << 6;
const BUS_OFF: u32 = 1 << 7;
/// There, last error: none since it was read, none in a frame, no acknowledgement.
const UNCHANGED: u32 = 7;
const NONE: u32 = 0;
const NO_ACKNOWLEDGEMENT: u32 = 3;
/// Among the interrupts, of FIFO 0 (those of FIFO 1 are three bits up): new, full, lost.
const NEW: u32 = 1 << 0;
const FULL: u32 = 1 << 1;
const LOST: u32 = 1 << 2;
/// A frame was sent; all were; bus off.
const SENT: u32 = 1 << 7;
const EMPTY: u32 = 1 << 9;
const IS_OFF: u32 = 1 << 19;

/// Clocks until a change of INIT is read back.
pub const SHOWN_AFTER: u64 = 24;
/// Recessive bits until a node takes part, and as often after bus off.
const JOINS_AFTER: u64 = 11;
const RECOVERS_AFTER: u64 = 129 * JOINS_AFTER;
/// Errors that a frame without acknowledgement counts, until the node is passive.
const ERRORS: u32 = 8;
const PASSIVE_FROM: u32 = 128;
const WARNING_FROM: u32 = 96;

/// The node.
#[derive(Debug)]
pub struct Node {
    /// Registers that are kept as they are written.
    words: Words,
    /// Message RAM.
    pub ram: MessageRam,
    /// INIT as it was written, and when it is read so.
    init: bool,
    shown_at: u64,
    /// Since when it takes part, without INIT.
    joins_at: u64,
    /// It has gone off the bus by errors. It is back when it takes part.
    off: bool,
    interrupts: u32,
    last_error: u32,
    errors: u32,
    received: [Ring; 2],
    sending: Ring,
    sent: u32,
    /// Frames in the elements of both FIFOs.
    kept: [VecDeque<CanFrame>; 2],
    /// Frames that the chip has acknowledged there.
    pub taken: Vec<CanFrame>,
}

impl Default for Node {
    fn default() -> Self {
        Self {
            words: Words::reset(&RESET),
            ram: MessageRam::default(),
            init: true,
            shown_at: 0,
            joins_at: 0,
            off: false,
            interrupts: 0,
            last_error: UNCHANGED,
            errors: 0,
            received: Default::default(),
            sending: Ring::default(),
            sent: 0,
            kept: Default::default(),
            taken: Vec::new(),
        }
    }
}

impl Node {
    /// Takes the registers back to those out of reset; the message RAM stays.
    pub fn reset(&mut self) {
        *self = Self { ram: std::mem::take(&mut self.ram), ..Self::default() };
    }

    /// Reads a register.
    pub fn read(&self, offset: usize, now: u64) -> u32 {
        match offset {
            CCCR => self.words.at(CCCR) | u32::from(self.shown(now)),
            ECR => self.errors,
            PSR => self.protocol(now),
            IR => self.interrupts,
            TXFQS => self.queue(),
            TXBRP => self.sending.mask(),
            TXBTO => self.sent,
            _ => match RXFS.iter().position(|status| *status == offset) {
                Some(fifo) => self.fifo(fifo),
                None => self.words.at(offset),
            },
        }
    }

    /// What else a read of it does that is no debugger's.
    pub fn was_read(&mut self, offset: usize) {
        if offset == PSR {
            self.last_error = UNCHANGED;
        }
    }

    /// Writes a register.
    pub fn write(&mut self, offset: usize, word: u32, now: u64) {
        match offset {
            CCCR => self.control(word, now),
            IR => self.interrupts &= !word,
            TXBAR if !self.open() => self.request(word),
            NBTP | DBTP | RXGFC | XIDAM | TXBC | CKDIV if self.open() => self.words.put(offset, word),
            IE | ILS | ILE | TXBTIE => self.words.put(offset, word),
            _ => {
                if let Some(fifo) = RXFA.iter().position(|acknowledges| *acknowledges == offset) {
                    self.words.put(offset, word & 0b111);
                    self.received[fifo].free_up_to(word & 0b111);
                    let left = self.received[fifo].fill() as usize;
                    let freed = self.kept[fifo].len().saturating_sub(left);
                    self.taken.extend(self.kept[fifo].drain(..freed));
                }
            }
        }
    }

    /// It neither sends nor receives.
    pub fn is_stopped(&self) -> bool {
        self.init
    }

    /// Since when it takes part, unless it is stopped.
    pub fn joins_at(&self) -> u64 {
        self.joins_at
    }

    /// Clocks of a bit (ST RM0440, 44.3.3): of the synchronisation one quantum, of the segments one more than their registers say.
    pub fn bit(&self) -> u64 {
        let timing = self.words.at(NBTP);
        let quanta = 3 + (timing >> 8 & 0xff) + (timing & 0x7f);
        let divider = match self.words.at(CKDIV) & 0xf {
            0 => 1,
            half => 2 * half,
        };
        u64::from(divider * ((timing >> 16 & 0x1ff) + 1) * quanta)
    }

    /// What it sends next.
    pub fn outgoing(&self) -> Option<Outgoing> {
        let waits = !self.init && self.sending.fill() > 0;
        waits.then(|| self.ram.outgoing(self.sending.first())).flatten()
    }

    /// That was acknowledged.
    pub fn has_sent(&mut self) {
        let element = self.sending.first();
        self.sending.free_up_to(element);
        self.sent |= 1 << element;
        self.errors = self.errors.saturating_sub(1);
        self.last_error = NONE;
        if self.words.at(TXBTIE) & 1 << element != 0 {
            self.interrupts |= SENT;
        }
        if self.sending.fill() == 0 {
            self.interrupts |= EMPTY;
        }
    }

    /// That was not.
    pub fn was_not_acknowledged(&mut self) {
        if self.errors < PASSIVE_FROM {
            self.errors += ERRORS;
        }
        self.last_error = NO_ACKNOWLEDGEMENT;
    }

    /// A frame comes; whether a full FIFO has lost it.
    pub fn receive(&mut self, frame: &CanFrame) -> bool {
        self.last_error = NONE;
        let rules = self.words.at(RXGFC);
        let matched = self.ram.first_match((rules >> 16 & 0x1f) as usize, frame.number());
        let unmatched = Some((rules >> 4 & 0b11) as usize).filter(|fifo| *fifo < self.received.len());
        let Some(fifo) = matched.map_or(unmatched, |matched| matched.fifo) else { return false };
        let element = self.received[fifo].push();
        let what = match element {
            Some(element) => {
                self.ram.store(fifo, element, frame, matched);
                self.kept[fifo].push_back(*frame);
                NEW | if self.received[fifo].free() == 0 { FULL } else { 0 }
            }
            None => LOST,
        };
        self.interrupts |= what << (3 * fifo);
        element.is_none()
    }

    /// Too many errors have taken it off the bus.
    pub fn go_off(&mut self, now: u64) {
        (self.off, self.init, self.shown_at, self.errors) = (true, true, now, 0xff);
        self.interrupts |= IS_OFF;
    }

    fn shown(&self, now: u64) -> bool {
        self.init == (now >= self.shown_at)
    }

    fn is_off(&self, now: u64) -> bool {
        self.off && (self.init || now < self.joins_at)
    }

    fn open(&self) -> bool {
        self.words.at(CCCR) & OPEN != 0
    }

    fn control(&mut self, word: u32, now: u64) {
        let (was_open, was_shown, init) = (self.open(), self.shown(now), word & INIT != 0);
        if was_open {
            self.words.replace(CCCR, FLEXIBLE, word);
        }
        if init != self.init {
            self.off = self.is_off(now);
            (self.init, self.shown_at) = (init, now + SHOWN_AFTER);
            if !init {
                self.joins(now);
            }
        }
        let opens = init && was_shown && word & OPEN != 0;
        self.words.replace(CCCR, OPEN, if opens { OPEN } else { 0 });
        if opens && !was_open {
            (self.received, self.sending, self.sent, self.kept) = Default::default();
        }
    }

    fn joins(&mut self, now: u64) {
        let after = if self.off { RECOVERS_AFTER } else { JOINS_AFTER };
        self.joins_at = now + SHOWN_AFTER + after * self.bit();
        if self.off {
            self.errors = 0;
        }
    }

    /// Elements are sent in turn, so only requests of the next one are any.
    fn request(&mut self, elements: u32) {
        let mut left = elements;
        while left & 1 << self.sending.next() != 0
            && let Some(element) = self.sending.push()
        {
            left &= !(1 << element);
            self.sent &= !(1 << element);
        }
    }

    fn protocol(&self, now: u64) -> u32 {
        let bit = |is: bool, bit| if is { bit } else { 0 };
        NO_DATA_ERROR
            | self.last_error
            | bit(self.errors >= PASSIVE_FROM, PASSIVE)
            | bit(self.errors >= WARNING_FROM, WARNING)
            | bit(self.is_off(now), BUS_OFF)
    }

    fn fifo(&self, fifo: usize) -> u32 {
        let ring = self.received[fifo];
        let full = u32::from(ring.free() == 0);
        let lost = u32::from(self.interrupts & LOST << (3 * fifo) != 0);
        ring.fill() | ring.first() << 8 | ring.next() << 16 | full << 24 | lost << 25
    }

    fn queue(&self) -> u32 {
        let full = u32::from(self.sending.free() == 0);
        self.sending.free() | self.sending.first() << 8 | self.sending.next() << 16 | full << 21
    }
}
