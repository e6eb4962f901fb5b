//! Frames: version, id, message and checksum, stuffed by COBS.
//!
//! A frame ends with a zero byte and has no other. What comes before the first one, and what is too long, is dropped: the next zero byte
//! begins anew. S. Cheshire, M. Baker, "Consistent Overhead Byte Stuffing", IEEE/ACM Transactions on Networking 7 (1999).

use cobs::{CobsEncoder, DecodeResult, DecoderState};
use serde::{Deserialize, Serialize};

use super::VERSION;
use crate::CHECKSUM;

/// Most bytes of a frame before it is stuffed.
pub const LONGEST: usize = 160;
/// Most bytes of a frame on the wire: one more for each 254, one to begin with, and the zero.
pub const LONGEST_STUFFED: usize = LONGEST + LONGEST / 254 + 2;

/// Bytes before and behind the message.
const HEAD: usize = 2;
const CHECK: usize = 4;

/// What a frame is found to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Opened<M> {
    /// A message with its id.
    Message(u8, M),
    /// A message of no kind that this version has, with its id.
    Unknown(u8),
    /// A frame of another version, with its id.
    Version {
        /// Of the frame.
        version: u8,
        /// Its id.
        id: u8,
    },
    /// A frame that was damaged on its way, or none.
    Damaged,
}

/// A stuffed frame, ready to be sent.
#[derive(Clone, Copy, Debug)]
pub struct Sealed {
    bytes: [u8; LONGEST_STUFFED],
    length: usize,
}

impl Sealed {
    /// No frame.
    pub const EMPTY: Self = Self { bytes: [0; LONGEST_STUFFED], length: 0 };

    /// The frame of a message; an empty one of a message that is too long, which none is.
    pub fn of(id: u8, message: &impl Serialize) -> Self {
        Self::with_version(VERSION, id, message)
    }

    /// The same in the name of another version.
    pub fn with_version(version: u8, id: u8, message: &impl Serialize) -> Self {
        let mut bytes = [0; LONGEST];
        let [first, second, rest @ ..] = &mut bytes;
        (*first, *second) = (version, id);
        let room = rest.len() - CHECK;
        let message = postcard::to_slice(message, rest.get_mut(..room).unwrap_or_default());
        let length = message.map(|message| message.len());
        length.map_or(Self::EMPTY, |length| Self::checked(&mut bytes, HEAD + length))
    }

    /// Adds the checksum of the content, and stuffs both.
    fn checked(bytes: &mut [u8; LONGEST], content: usize) -> Self {
        let Some((content, rest)) = bytes.split_at_mut_checked(content) else { return Self::EMPTY };
        let checksum = CHECKSUM.checksum(content).to_le_bytes();
        let Some(check) = rest.first_chunk_mut() else { return Self::EMPTY };
        *check = checksum;
        Self::stuffed(&[content, check])
    }

    /// The frame of these bytes as they are, checksum and all; an empty one when they are too many.
    pub fn stuffed(parts: &[&[u8]]) -> Self {
        let mut frame = Self::EMPTY;
        let [stuffed @ .., _] = &mut frame.bytes;
        let mut encoder = CobsEncoder::new(stuffed);
        if parts.iter().any(|part| encoder.push(part).is_err()) {
            return Self::EMPTY;
        }
        // The zero behind it is there already.
        frame.length = encoder.finalize() + 1;
        frame
    }

    /// Its bytes on the wire.
    pub fn bytes(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or_default()
    }
}

/// Collects the bytes of a frame.
#[derive(Debug)]
pub struct Collector {
    state: DecoderState,
    bytes: [u8; LONGEST],
    length: usize,
    /// A frame too long or wrongly stuffed: the rest of it is dropped, up to the zero.
    broken: bool,
}

impl Default for Collector {
    fn default() -> Self {
        Self { state: DecoderState::Idle, bytes: [0; LONGEST], length: 0, broken: false }
    }
}

impl Collector {
    /// Takes a byte; whether a frame is whole, which [`Self::open`] then tells, up to the next byte.
    pub fn take(&mut self, byte: u8) -> bool {
        if self.broken {
            self.broken = byte != 0;
            return false;
        }
        match self.state.feed(byte) {
            Ok(DecodeResult::DataStart) => self.length = 0,
            Ok(DecodeResult::DataContinue(byte)) => self.add(byte),
            Ok(DecodeResult::DataComplete) => return true,
            Ok(DecodeResult::NoData) => {}
            // A zero inside of it: what follows may be the next frame.
            Err(_) => self.state = DecoderState::Idle,
        }
        false
    }

    fn add(&mut self, byte: u8) {
        match self.bytes.get_mut(self.length) {
            Some(place) => {
                *place = byte;
                self.length += 1;
            }
            None => (self.broken, self.state) = (true, DecoderState::Idle),
        }
    }

    /// What the whole frame is.
    pub fn open<'a, M: Deserialize<'a>>(&'a self) -> Opened<M> {
        let content = self.bytes.get(..self.length).unwrap_or_default();
        let Some((content, check)) = content.split_last_chunk() else { return Opened::Damaged };
        let checked = CHECKSUM.checksum(content) == u32::from_le_bytes(*check);
        match content {
            [version, id, message @ ..] if checked => {
                if *version != VERSION {
                    return Opened::Version { version: *version, id: *id };
                }
                match postcard::take_from_bytes(message) {
                    Ok((message, [])) => Opened::Message(*id, message),
                    _ => Opened::Unknown(*id),
                }
            }
            _ => Opened::Damaged,
        }
    }
}
