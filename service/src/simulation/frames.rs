//! Frames that nobody should send, and what a joint does on them.

use std::vec::Vec;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::joint::{Line, RestingJoint};
use crate::CHECKSUM;
use crate::tuning::frame::{Collector, LONGEST, Opened, Sealed};
use crate::tuning::{Function, Order, Reply, Request, Trial, TuningLink, VERSION};

/// Periods in which a frame that has come whole is served, a reading of a stream before it.
const SERVED: u32 = 10;
/// Id of the sound request.
const SOUND: u8 = 7;

/// What malformed frames have led to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Malformed {
    /// Frames that were sent.
    pub frames: u64,
    /// Orders with a value out of its range, and any that no request asked for.
    pub out_of_range: u64,
    /// Sound requests among them that were served: the link is still alive.
    pub served: u64,
    /// Sound requests that were not.
    pub unserved: u64,
}

impl Malformed {
    /// Both.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            frames: self.frames + other.frames,
            out_of_range: self.out_of_range + other.out_of_range,
            served: self.served + other.served,
            unserved: self.unserved + other.unserved,
        }
    }
}

/// Sends so many malformed frames to one joint; a sound request follows every thousandth.
///
/// # Panics
/// When the link does.
pub fn send(frames: u64, seed: u64) -> Malformed {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let (mut joint, mut link, mut line) = (RestingJoint::default(), TuningLink::default(), Line::default());
    let mut found = Malformed { frames, ..Malformed::default() };
    for number in 0..frames {
        let (bytes, allowed) = malformed(&mut random);
        line.there.extend(bytes);
        line.there.push_back(0);
        serve(&mut joint, &mut link, &mut line);
        let wrong = |order: &Order| !is_harmless(order, &allowed);
        found.out_of_range += joint.did.drain(..).filter(wrong).count() as u64;
        if number % 1000 == 0 {
            line.back.clear();
            line.there.extend(Sealed::of(SOUND, &Request::Hello).bytes());
            serve(&mut joint, &mut link, &mut line);
            let answered = is_answered(&line.back);
            found.served += u64::from(answered);
            found.unserved += u64::from(!answered);
        }
        line.back.clear();
    }
    found
}

/// Lets a joint take and serve what is on its way.
fn serve(joint: &mut RestingJoint, link: &mut TuningLink, line: &mut Line) {
    while !line.there.is_empty() {
        joint.run(link, line, 1);
    }
    joint.run(link, line, SERVED);
}

/// The sound request's reply is among these bytes.
fn is_answered(bytes: &[u8]) -> bool {
    let mut collector = Collector::default();
    let is_reply = |opened| matches!(opened, Opened::Message(SOUND, Reply::Hello(_)));
    bytes.iter().any(|byte| collector.take(*byte) && is_reply(collector.open()))
}

/// The order has no value out of its range, and is of what the frame may have asked for.
fn is_harmless(order: &Order, allowed: &Allowed) -> bool {
    match order {
        Order::Try(trial) => {
            let tried = |function| trial.of(function).is_none_or(Trial::allows);
            matches!(allowed, Allowed::InRange) && Function::ALL.into_iter().all(tried)
        }
        // A stream that was begun goes on.
        Order::Read => true,
        Order::Learnt | Order::Reset => matches!(allowed, Allowed::InRange),
    }
}

/// What a frame may lead to.
enum Allowed {
    /// Nothing at all: it is damaged or of another version.
    Nothing,
    /// What is in range.
    InRange,
}

/// A frame without its zero.
fn malformed(random: &mut ChaCha8Rng) -> (Vec<u8>, Allowed) {
    match random.random_range(0..5) {
        0 => (bytes(random, 2 * LONGEST), Allowed::Nothing),
        1 => (damaged(random), Allowed::Nothing),
        2 => (checked(VERSION, &bytes(random, 120)), Allowed::InRange),
        3 => (checked(random.random_range(VERSION + 1..=u8::MAX), &bytes(random, 120)), Allowed::Nothing),
        _ => (unstuffed(&Sealed::of(random.random(), &any_request(random))), Allowed::InRange),
    }
}

fn bytes(random: &mut ChaCha8Rng, most: usize) -> Vec<u8> {
    let length = random.random_range(0..=most);
    (0..length).map(|_| random.random()).collect()
}

/// Any bytes as the content of a frame, with the right checksum.
fn checked(version: u8, content: &[u8]) -> Vec<u8> {
    let content = [&[version], content].concat();
    let checksum = CHECKSUM.checksum(&content).to_le_bytes();
    unstuffed(&Sealed::stuffed(&[&content, &checksum]))
}

/// The bytes on the wire without the zero.
fn unstuffed(sealed: &Sealed) -> Vec<u8> {
    sealed.bytes().split_last().map_or_else(Vec::new, |(_, bytes)| bytes.to_vec())
}

/// A sound frame with bits turned, or cut off.
fn damaged(random: &mut ChaCha8Rng) -> Vec<u8> {
    let sound = unstuffed(&Sealed::of(random.random(), &any_request(random)));
    let mut bytes = sound.clone();
    if random.random() {
        bytes.truncate(random.random_range(0..bytes.len()));
    }
    for _ in 0..random.random_range(0..4) {
        if let Some(byte) = bytes.get_mut(random.random_range(0..sound.len())) {
            *byte ^= random.random::<u8>();
        }
    }
    if bytes == sound {
        bytes.pop();
    }
    bytes
}

/// A request with any values.
fn any_request(random: &mut ChaCha8Rng) -> Request {
    let function = Function::ALL[random.random_range(0..Function::ALL.len())];
    match random.random_range(0..3) {
        0 => Request::Stream(random.random()),
        1 => Request::SetGain(function, [random.random_range(-0.5..1.5), random.random_range(-0.5..1.5)]),
        _ => Request::SetGain(function, [random.random(), random.random()].map(f32::from_bits)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn malformed_frames_lead_to_nothing_out_of_range() {
        let found = send(20_000, 1);
        assert_eq!((found.out_of_range, found.unserved), (0, 0), "{found:?}");
        assert_eq!(found.served, 20);
    }

    #[test]
    fn an_order_of_a_damaged_frame_would_be_seen() {
        let trial = Trial::NONE.with(Function::Friction, [0.5; 2]).unwrap();
        assert!(!is_harmless(&Order::Try(trial), &Allowed::Nothing));
        assert!(is_harmless(&Order::Try(trial), &Allowed::InRange));
    }
}
