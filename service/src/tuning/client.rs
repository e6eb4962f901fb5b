//! The host's side of the link: requests out, replies in, over any transport that can be read and written.
//!
//! A read of the transport waits a few milliseconds for bytes and then fails with `TimedOut` or `WouldBlock`, as serial ports and sockets with a
//! time-out do. Each request has a time in which its reply must come, and is sent again with the same id when none has: a joint
//! may serve it twice. That changes nothing, but that `Keep` then writes a second record of the same words.
//!
//! Frames that were damaged on their way are counted and dropped. Gains that were set are in force as long as the joint hears of the host:
//! [`Client::keep_alive`], called at least each 0.1 s.

mod error;

use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
use std::time::{Duration, Instant};
use std::vec::Vec;

use strainwave::compensator::adapt::learning::Learnt;

use super::frame::{Collector, Opened, Sealed};
use super::link::learnt_of;
use super::{Function, Hello, Reading, Refusal, Reply, Request, Trial};
pub use error::Error;

/// Time after the last request when [`Client::keep_alive`] sends one: a joint that hears nothing for 1 s takes its own gains.
const QUIET: Duration = Duration::from_millis(400);
/// Most bytes of a read.
const BYTES: usize = 512;

/// How long a client waits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Patience {
    /// Time for a reply.
    pub answer: Duration,
    /// The same of a request that writes flash.
    pub flash: Duration,
    /// How often a request is sent before the joint is given up.
    pub tries: u32,
}

impl Default for Patience {
    /// 0.25 s and 3 s, four times: the largest sectors take 0.5 s to erase each.
    fn default() -> Self {
        Self { answer: Duration::from_millis(250), flash: Duration::from_secs(3), tries: 4 }
    }
}

impl Patience {
    fn of(&self, request: &Request) -> Duration {
        if request.writes() { self.flash } else { self.answer }
    }
}

/// Counts of a client since it was connected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Requests.
    pub requests: u64,
    /// Requests that were sent again.
    pub repeated: u64,
    /// Frames that were damaged on their way here.
    pub damaged: u64,
}

/// The host's end of the link to a joint.
#[derive(Debug)]
pub struct Client<P> {
    port: P,
    patience: Patience,
    hello: Hello,
    /// Bytes that were read and not taken yet.
    bytes: VecDeque<u8>,
    collector: Collector,
    /// Of the last request, and when it was sent.
    id: u8,
    asked: Instant,
    /// Readings of the stream that nobody has taken yet.
    readings: VecDeque<Reading>,
    /// Gains that the joint tries, as far as it was told.
    trial: Trial,
    counts: Counts,
}

impl<P: Read + Write> Client<P> {
    /// Greets the joint, ends a stream that another host has left, and asks for the gains that are tried.
    ///
    /// # Errors
    /// [`Error`]: of another version, without an answer, or a port that fails.
    pub fn connect(port: P, patience: Patience) -> Result<Self, Error> {
        let nobody =
            Hello { gear: Hello::name(""), layout: 0, joint: 0, rate: 0, store: super::StoreState::Missing };
        let mut client = Self {
            port,
            patience,
            hello: nobody,
            bytes: VecDeque::new(),
            collector: Collector::default(),
            id: 0,
            asked: Instant::now(),
            readings: VecDeque::new(),
            trial: Trial::NONE,
            counts: Counts::default(),
        };
        client.hello = client.hello()?;
        client.stream(0)?;
        client.trial = client.gains()?;
        Ok(client)
    }

    /// Who the joint is, as it said when it was greeted.
    pub fn joint(&self) -> &Hello {
        &self.hello
    }

    /// Gains that the joint was told to try, those of another host before included.
    pub fn trial(&self) -> &Trial {
        &self.trial
    }

    /// What was counted so far.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Who the joint is, and the state of its store.
    ///
    /// # Errors
    /// [`Error`].
    pub fn hello(&mut self) -> Result<Hello, Error> {
        self.ask(&Request::Hello, |reply| if let Reply::Hello(hello) = reply { Some(hello) } else { None })
    }

    /// The quantities of this moment.
    ///
    /// # Errors
    /// [`Error`]; [`Refusal::NoStep`] when the control runs no step.
    pub fn read(&mut self) -> Result<Reading, Error> {
        self.ask(
            &Request::Read,
            |reply| if let Reply::Reading(reading) = reply { Some(reading) } else { None },
        )
    }

    /// Gains that are tried, as the joint has them.
    ///
    /// # Errors
    /// [`Error`].
    pub fn gains(&mut self) -> Result<Trial, Error> {
        self.ask(&Request::Gains, |reply| if let Reply::Gains(trial) = reply { Some(trial) } else { None })
    }

    /// Tries gains of a function for forward and backward motion, 0..=1, while [`Self::keep_alive`] is called.
    ///
    /// # Errors
    /// [`Error`]; [`Refusal::OutOfRange`] of other gains.
    pub fn set_gain(&mut self, function: Function, gains: [f32; 2]) -> Result<(), Error> {
        self.done(&Request::SetGain(function, gains))?;
        if let Some(trial) = self.trial.with(function, gains) {
            self.trial = trial;
        }
        Ok(())
    }

    /// From Safe to Ready, once the cause is removed.
    ///
    /// # Errors
    /// [`Error`].
    pub fn reset(&mut self) -> Result<(), Error> {
        self.done(&Request::Reset)
    }

    /// What was learnt so far.
    ///
    /// # Errors
    /// [`Error`].
    pub fn learnt(&mut self) -> Result<Learnt<f32>, Error> {
        self.ask(&Request::Learnt, |reply| {
            if let Reply::Learnt(floats) = reply { Some(learnt_of(&floats)) } else { None }
        })
    }

    /// What the store holds, and the number of its record.
    ///
    /// # Errors
    /// [`Error`]; [`Refusal::Store`] when it holds nothing of this joint.
    pub fn stored(&mut self) -> Result<(u32, Learnt<f32>), Error> {
        self.ask(&Request::Stored, |reply| {
            if let Reply::Stored(number, floats) = reply { Some((number, learnt_of(&floats))) } else { None }
        })
    }

    /// Stores what was learnt so far; the number of the record.
    ///
    /// # Errors
    /// [`Error`]; [`Refusal::DriveOn`] or [`Refusal::Store`] when it cannot be stored.
    pub fn keep(&mut self) -> Result<u32, Error> {
        self.ask(&Request::Keep, |reply| if let Reply::Kept(number) = reply { Some(number) } else { None })
    }

    /// Forgets what the store holds, whosever it is.
    ///
    /// # Errors
    /// As [`Self::keep`].
    pub fn erase(&mut self) -> Result<(), Error> {
        self.done(&Request::Erase)
    }

    /// Asks for a reading every so many control periods, [`super::link::FASTEST`] or more; for none with 0.
    ///
    /// # Errors
    /// [`Error`]; [`Refusal::OutOfRange`] of fewer periods.
    pub fn stream(&mut self, every: u16) -> Result<(), Error> {
        self.done(&Request::Stream(every))
    }

    /// The next reading of the stream; `None` when none has come within this time.
    ///
    /// # Errors
    /// [`Error::Port`] or [`Error::Version`].
    pub fn next_reading(&mut self, within: Duration) -> Result<Option<Reading>, Error> {
        let deadline = Instant::now() + within;
        loop {
            if let Some(reading) = self.readings.pop_front() {
                return Ok(Some(reading));
            }
            match self.frame(deadline)? {
                Some((0, Reply::Reading(reading))) => self.readings.push_back(reading),
                // The reply to a request that was sent again meanwhile.
                Some(_) => {}
                None => return Ok(None),
            }
        }
    }

    /// Lets the joint hear of the host, if it has not for a while, and compares the gains that it tries.
    ///
    /// # Errors
    /// [`Error::Lost`] when they are others than those that were set.
    pub fn keep_alive(&mut self) -> Result<(), Error> {
        let kept = self.asked.elapsed() < QUIET || self.gains()? == self.trial;
        if kept { Ok(()) } else { Err(Error::Lost) }
    }

    fn done(&mut self, request: &Request) -> Result<(), Error> {
        self.ask(request, |reply| (reply == Reply::Done).then_some(()))
    }

    /// Asks until there is an answer, or the joint is given up.
    fn ask<T>(&mut self, request: &Request, answer: impl Fn(Reply) -> Option<T>) -> Result<T, Error> {
        self.id = self.id % u8::MAX + 1;
        self.counts.requests += 1;
        let frame = Sealed::of(self.id, request);
        let within = self.patience.of(request);
        let mut busy = false;
        for number in 0..self.patience.tries {
            self.counts.repeated += u64::from(number > 0);
            self.send(&frame)?;
            match self.reply(Instant::now() + within)? {
                None => {}
                Some(Reply::Refused(Refusal::Busy)) => {
                    busy = true;
                    // What it is busy with takes some periods.
                    self.reply(Instant::now() + within / 8)?;
                }
                Some(Reply::Refused(why)) => return Err(Error::Refused { request: request.name(), why }),
                Some(reply) => return answer(reply).ok_or(Error::Unexpected { request: request.name() }),
            }
        }
        if busy {
            return Err(Error::Refused { request: request.name(), why: Refusal::Busy });
        }
        Err(Error::NoAnswer { request: request.name(), tries: self.patience.tries, within })
    }

    fn send(&mut self, frame: &Sealed) -> Result<(), Error> {
        self.asked = Instant::now();
        // The zero in front ends whatever the joint has heard of a frame that was cut off.
        let mut bytes = Vec::from([0]);
        bytes.extend_from_slice(frame.bytes());
        self.port.write_all(&bytes)?;
        Ok(self.port.flush()?)
    }

    /// The reply to the last request; readings of the stream are laid aside.
    fn reply(&mut self, deadline: Instant) -> Result<Option<Reply>, Error> {
        while let Some((id, reply)) = self.frame(deadline)? {
            match reply {
                Reply::Reading(reading) if id == 0 => self.readings.push_back(reading),
                reply if id == self.id => return Ok(Some(reply)),
                // Late, of a request that was given up.
                _ => {}
            }
        }
        Ok(None)
    }

    /// The next sound frame; `None` after the deadline.
    fn frame(&mut self, deadline: Instant) -> Result<Option<(u8, Reply)>, Error> {
        loop {
            while let Some(byte) = self.bytes.pop_front() {
                if !self.collector.take(byte) {
                    continue;
                }
                match self.collector.open() {
                    Opened::Message(id, reply) => return Ok(Some((id, reply))),
                    Opened::Version { version, .. } => return Err(Error::Version { joint: version }),
                    Opened::Unknown(_) | Opened::Damaged => self.counts.damaged += 1,
                }
            }
            if Instant::now() >= deadline {
                return Ok(None);
            }
            self.fill()?;
        }
    }

    fn fill(&mut self) -> Result<(), Error> {
        let mut bytes = [0; BYTES];
        match self.port.read(&mut bytes) {
            Ok(0) => {
                Err(Error::Port(io::Error::new(ErrorKind::UnexpectedEof, "the other end has closed it")))
            }
            Ok(count) => {
                self.bytes.extend(bytes.iter().take(count));
                Ok(())
            }
            Err(error) => match error.kind() {
                ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted => Ok(()),
                _ => Err(error.into()),
            },
        }
    }
}

#[cfg(test)]
mod tests;
