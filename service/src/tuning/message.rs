//! Requests to a joint and its replies.

use serde::{Deserialize, Serialize};
use strainwave::compensator::words::LEARNT_WORDS;

use super::{Function, Reading, Trial};

/// A request to the joint.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Request {
    /// Who is it? Answered by [`Reply::Hello`].
    Hello,
    /// The quantities of this moment. Answered by [`Reply::Reading`].
    Read,
    /// Gains that are tried. Answered by [`Reply::Gains`].
    Gains,
    /// Tries gains of a function for forward and backward motion, 0..=1. Answered by [`Reply::Done`].
    SetGain(Function, [f32; 2]),
    /// From Safe to Ready, once the cause is removed. Answered by [`Reply::Done`].
    Reset,
    /// What was learnt so far. Answered by [`Reply::Learnt`].
    Learnt,
    /// What the store holds. Answered by [`Reply::Stored`].
    Stored,
    /// What was learnt so far, into the store. Answered by [`Reply::Kept`].
    Keep,
    /// Forgets what the store holds, whosever it is. Answered by [`Reply::Done`].
    Erase,
    /// A reading every so many control periods, [`super::link::FASTEST`] or more; none with 0. Answered by [`Reply::Done`].
    Stream(#[serde(with = "postcard::fixint::le")] u16),
}

impl Request {
    /// Its name.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Hello => "hello",
            Self::Read => "read",
            Self::Gains => "gains",
            Self::SetGain(..) => "set gain",
            Self::Reset => "reset",
            Self::Learnt => "learnt",
            Self::Stored => "stored",
            Self::Keep => "keep",
            Self::Erase => "erase",
            Self::Stream(_) => "stream",
        }
    }

    /// It writes the flash of the store.
    pub const fn writes(&self) -> bool {
        matches!(self, Self::Keep | Self::Erase)
    }
}

/// The joint's answer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Reply {
    /// Who it is.
    Hello(Hello),
    /// Quantities of a control period.
    Reading(Reading),
    /// Gains that are tried.
    Gains(Trial),
    /// It is done.
    Done,
    /// What was learnt: the words of `Learnt` as floats.
    Learnt([f32; LEARNT_WORDS]),
    /// What the store holds, and the number of its record.
    Stored(#[serde(with = "postcard::fixint::le")] u32, [f32; LEARNT_WORDS]),
    /// The number of the record that was written.
    Kept(#[serde(with = "postcard::fixint::le")] u32),
    /// It was not done.
    Refused(Refusal),
}

/// Who a joint is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Hello {
    /// Name of its gear, zeros behind it; a longer one is cut.
    pub gear: [u8; 24],
    /// Layout of its constants, `strainwave::compensator::words::LAYOUT` of its firmware.
    #[serde(with = "postcard::fixint::le")]
    pub layout: u32,
    /// Checksum of its constants: tells one joint from another.
    #[serde(with = "postcard::fixint::le")]
    pub joint: u32,
    /// Control periods in a second (Hz).
    #[serde(with = "postcard::fixint::le")]
    pub rate: u32,
    /// Its store.
    pub store: StoreState,
}

impl Hello {
    /// A gear's name as it is sent.
    pub fn name(gear: &str) -> [u8; 24] {
        let mut name = [0; 24];
        for (place, byte) in name.iter_mut().zip(gear.as_bytes()) {
            *place = *byte;
        }
        name
    }

    /// The gear's name; what is no text of it is left out.
    pub fn gear(&self) -> &str {
        let name = self.gear.split(|byte| *byte == 0).next().unwrap_or_default();
        let text = core::str::from_utf8(name);
        text.unwrap_or_else(|error| {
            let valid = name.get(..error.valid_up_to()).unwrap_or_default();
            core::str::from_utf8(valid).unwrap_or_default()
        })
    }
}

/// A joint's store.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum StoreState {
    /// It has none.
    Missing,
    /// Nothing is stored.
    Empty,
    /// It holds what the joint has learnt.
    Sound,
    /// It is of another layout.
    OtherLayout,
    /// It is another joint's.
    OtherJoint,
    /// It fails.
    Broken,
}

/// Why a request was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Refusal {
    /// The frame is of another version than the joint's firmware.
    Version,
    /// There is no such request.
    Unknown,
    /// A value is out of its range.
    OutOfRange,
    /// The joint is serving another request.
    Busy,
    /// The control runs no step: its sensors give nothing.
    NoStep,
    /// The drive is on, and its flash cannot be written meanwhile.
    DriveOn,
    /// The store is not one that holds something, or not one that can be written.
    Store(StoreState),
}

impl Refusal {
    /// Why, in words.
    pub const fn reason(self) -> &'static str {
        match self {
            Self::Version => "the link has another version",
            Self::Unknown => "no such request",
            Self::OutOfRange => "out of range",
            Self::Busy => "another request is served",
            Self::NoStep => "the control runs no step: it has no sensors' input",
            Self::DriveOn => "the drive is on: its flash cannot be written while the joint is controlled",
            Self::Store(StoreState::Missing) => "it has no store",
            Self::Store(StoreState::Empty) => "nothing is stored",
            Self::Store(StoreState::Sound) => "the store is in use",
            Self::Store(StoreState::OtherLayout) => "the store has the layout of another version",
            Self::Store(StoreState::OtherJoint) => "the store is another joint's",
            Self::Store(StoreState::Broken) => "the store's flash fails",
        }
    }
}
