//! The joint's side of the link: frames in, orders to the control, answers out.
//!
//! [`TuningLink::poll`] is called from the idle loop, at least once in a control period. A call takes and sends at most [`MOST_BYTES`] bytes and
//! serves at most one frame, waits for nothing, and gives the control at most one [`Order`]: the control answers between two of its
//! periods, so that neither waits for the other. Writing to the store alone takes as long as its flash does.
//!
//! When no sound frame has come for [`SILENCE`] the stream ends and the board's own gains come back; an unfinished frame is forgotten.

use embedded_hal_nb::serial::{Read, Write};
use strainwave::compensator::adapt::learning::Learnt;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::compensator::words::LEARNT_WORDS;

use super::frame::{Collector, Opened, Sealed};
use super::{Function, Hello, Reading, Refusal, Reply, Request, StoreState, Trial};

/// Most bytes that a call takes, and most that it sends.
pub const MOST_BYTES: usize = 64;

/// Control periods without a sound frame after which the link is silent: 1 s.
pub const SILENCE: u32 = (1.0 / CONTROL_PERIOD) as u32;

/// Fewest control periods between two readings of a stream: 1000 readings a second.
pub const FASTEST: u16 = 10;

/// Control periods within which the control answers: otherwise it has no input, and runs no step.
pub const PATIENCE: u32 = 100;

/// What the control is to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Order {
    /// Answer with the quantities of the next period.
    Read,
    /// Answer with what was learnt.
    Learnt,
    /// Use these gains from now on.
    Try(Trial),
    /// From Safe to Ready.
    Reset,
}

/// What the control answers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer {
    /// The quantities.
    Reading(Reading),
    /// What was learnt.
    Learnt(Learnt<f32>),
}

/// The joint behind the link.
pub trait Joint {
    /// Who it is.
    fn hello(&mut self) -> Hello;
    /// Control periods since start-up, which wrap.
    fn now(&self) -> u32;
    /// Gives the control an order; false when it has not yet taken the last one.
    fn order(&mut self, order: Order) -> bool;
    /// Its answer, once.
    fn answer(&mut self) -> Option<Answer>;
    /// The store may be written now: the drive is off, or writing does not hold the control up.
    fn may_write(&self) -> bool;
    /// What the store holds, with the number of the record.
    ///
    /// # Errors
    /// The store's state when it holds nothing of this joint.
    fn stored(&mut self) -> Result<(u32, Learnt<f32>), StoreState>;
    /// Stores what was learnt; the number of the record.
    ///
    /// # Errors
    /// The store's state when it cannot be written.
    fn keep(&mut self, learnt: &Learnt<f32>) -> Result<u32, StoreState>;
    /// Forgets what the store holds.
    ///
    /// # Errors
    /// The store's state when it cannot be erased.
    fn erase(&mut self) -> Result<(), StoreState>;
}

/// For whom the control's answer is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Awaited {
    Reading(u8),
    Learnt(u8),
    Keep(u8),
    Stream,
}

/// State of the link.
#[derive(Debug)]
pub struct TuningLink {
    collector: Collector,
    /// A whole frame has not been served yet.
    waiting: bool,
    reply: Sealed,
    sent: usize,
    /// Who awaits an answer, and since when.
    awaited: Option<(Awaited, u32)>,
    trial: Trial,
    /// The control has not yet been told that the board's own gains are back.
    releases: bool,
    /// Whether and when a sound frame was last heard.
    heard: Option<u32>,
    /// Control periods from reading to reading, 0 for none, and when the last one was due.
    every: u16,
    due: u32,
    left_out: u32,
}

impl Default for TuningLink {
    fn default() -> Self {
        Self {
            collector: Collector::default(),
            waiting: false,
            reply: Sealed::EMPTY,
            sent: 0,
            awaited: None,
            trial: Trial::NONE,
            releases: false,
            heard: None,
            every: 0,
            due: 0,
            left_out: 0,
        }
    }
}

impl TuningLink {
    /// Goes on with what is to be done.
    pub fn poll<P: Read<u8> + Write<u8>>(&mut self, port: &mut P, joint: &mut impl Joint) {
        self.watch(joint);
        if let Some(answer) = joint.answer() {
            self.pass_on(&answer, joint);
        }
        self.give_up(joint.now());
        self.receive(port);
        if self.waiting && self.is_free() {
            self.waiting = false;
            self.serve(joint);
        }
        self.stream(joint);
        self.send(port);
    }

    /// Gains that are tried.
    pub fn trial(&self) -> &Trial {
        &self.trial
    }

    /// Another reply may be made.
    fn is_free(&self) -> bool {
        self.awaited.is_none() && self.sent >= self.reply.bytes().len()
    }

    /// Ends what the host has begun when nothing is heard of it.
    fn watch(&mut self, joint: &mut impl Joint) {
        if self.heard.is_some_and(|heard| joint.now().wrapping_sub(heard) >= SILENCE) {
            (self.heard, self.every, self.waiting) = (None, 0, false);
            self.collector = Collector::default();
            self.releases |= self.trial != Trial::NONE;
            self.trial = Trial::NONE;
        }
        if self.releases {
            self.releases = !joint.order(Order::Try(Trial::NONE));
        }
    }

    fn receive(&mut self, port: &mut impl Read<u8>) {
        for _ in 0..MOST_BYTES {
            if self.waiting {
                return;
            }
            match port.read() {
                Ok(byte) => self.waiting = self.collector.take(byte),
                Err(_) => return,
            }
        }
    }

    fn send(&mut self, port: &mut impl Write<u8>) {
        for byte in self.reply.bytes().iter().skip(self.sent).take(MOST_BYTES) {
            if port.write(*byte).is_err() {
                return;
            }
            self.sent += 1;
        }
    }

    fn reply(&mut self, id: u8, reply: &Reply) {
        (self.reply, self.sent) = (Sealed::of(id, reply), 0);
    }

    /// Serves the whole frame.
    fn serve(&mut self, joint: &mut impl Joint) {
        let (id, request) = match self.collector.open() {
            Opened::Message(id, request) => (id, request),
            Opened::Unknown(id) => return self.reply(id, &Reply::Refused(Refusal::Unknown)),
            Opened::Version { id, .. } => return self.reply(id, &Reply::Refused(Refusal::Version)),
            Opened::Damaged => return,
        };
        self.heard = Some(joint.now());
        if let Some(reply) = self.done(id, &request, joint) {
            self.reply(id, &reply);
        }
    }

    /// Does what a request asks for; the reply, unless the control has to answer first.
    fn done(&mut self, id: u8, request: &Request, joint: &mut impl Joint) -> Option<Reply> {
        match *request {
            Request::Hello => Some(Reply::Hello(joint.hello())),
            Request::Gains => Some(Reply::Gains(self.trial)),
            Request::Read => self.ask(Order::Read, Awaited::Reading(id), joint),
            Request::Learnt => self.ask(Order::Learnt, Awaited::Learnt(id), joint),
            Request::SetGain(function, gains) => Some(self.set(function, gains, joint)),
            Request::Reset => Some(given(joint.order(Order::Reset))),
            Request::Stored => Some(joint.stored().map_or_else(not_stored, |(number, learnt)| {
                Reply::Stored(number, learnt.to_words().map(f32::from_bits))
            })),
            Request::Keep | Request::Erase if !joint.may_write() => Some(Reply::Refused(Refusal::DriveOn)),
            Request::Keep => self.ask(Order::Learnt, Awaited::Keep(id), joint),
            Request::Erase => Some(joint.erase().map_or_else(not_stored, |()| Reply::Done)),
            Request::Stream(every) => Some(self.stream_every(every, joint.now())),
        }
    }

    /// Orders what the control answers later.
    fn ask(&mut self, order: Order, awaited: Awaited, joint: &mut impl Joint) -> Option<Reply> {
        let taken = joint.order(order);
        self.awaited = taken.then_some((awaited, joint.now()));
        (!taken).then_some(Reply::Refused(Refusal::Busy))
    }

    fn set(&mut self, function: Function, gains: [f32; 2], joint: &mut impl Joint) -> Reply {
        let Some(trial) = self.trial.with(function, gains) else {
            return Reply::Refused(Refusal::OutOfRange);
        };
        let taken = joint.order(Order::Try(trial));
        if taken {
            self.trial = trial;
        }
        given(taken)
    }

    fn stream_every(&mut self, every: u16, now: u32) -> Reply {
        if (1..FASTEST).contains(&every) {
            return Reply::Refused(Refusal::OutOfRange);
        }
        (self.every, self.due, self.left_out) = (every, now, 0);
        Reply::Done
    }

    /// Asks for the reading that is due, or leaves it out when the last one is still on its way.
    fn stream(&mut self, joint: &mut impl Joint) {
        let (now, every) = (joint.now(), u32::from(self.every));
        if every == 0 || now.wrapping_sub(self.due) < every {
            return;
        }
        // Those that were missed meanwhile are not made up for.
        self.due = now;
        if self.is_free() && joint.order(Order::Read) {
            self.awaited = Some((Awaited::Stream, now));
        } else {
            self.left_out = self.left_out.saturating_add(1);
        }
    }

    /// Tells that the control does not answer.
    fn give_up(&mut self, now: u32) {
        let late = |since: u32| now.wrapping_sub(since) >= PATIENCE;
        let Some((awaited, _)) = self.awaited.take_if(|(_, since)| late(*since)) else { return };
        match awaited {
            Awaited::Reading(id) | Awaited::Learnt(id) | Awaited::Keep(id) => {
                self.reply(id, &Reply::Refused(Refusal::NoStep));
            }
            Awaited::Stream => {}
        }
    }

    /// Passes the control's answer on to who awaits it.
    fn pass_on(&mut self, answer: &Answer, joint: &mut impl Joint) {
        let Some((awaited, since)) = self.awaited.take() else { return };
        let (id, reply) = match (awaited, answer) {
            (Awaited::Reading(id), Answer::Reading(reading)) => (id, Reply::Reading(*reading)),
            (Awaited::Stream, Answer::Reading(reading)) => {
                (0, Reply::Reading(reading.with_left_out(self.left_out)))
            }
            (Awaited::Learnt(id), Answer::Learnt(learnt)) => {
                (id, Reply::Learnt(learnt.to_words().map(f32::from_bits)))
            }
            // Meanwhile the drive may have been switched on.
            (Awaited::Keep(id), Answer::Learnt(_)) if !joint.may_write() => {
                (id, Reply::Refused(Refusal::DriveOn))
            }
            (Awaited::Keep(id), Answer::Learnt(learnt)) => {
                (id, joint.keep(learnt).map_or_else(not_stored, Reply::Kept))
            }
            // Of an earlier order, which was given up.
            _ => return self.awaited = Some((awaited, since)),
        };
        self.reply(id, &reply);
    }
}

fn given(taken: bool) -> Reply {
    if taken { Reply::Done } else { Reply::Refused(Refusal::Busy) }
}

fn not_stored(state: StoreState) -> Reply {
    Reply::Refused(Refusal::Store(state))
}

/// Words of what was learnt, as a reply has them.
pub fn learnt_of(floats: &[f32; LEARNT_WORDS]) -> Learnt<f32> {
    Learnt::from_words(&floats.map(f32::to_bits))
}
