//! SDO server: one object of at most 4 bytes is read or written by one frame (expedited transfer).
//!
//! ```text
//! request  0x40 index subindex 0 0 0 0                   read
//!          0x22 | size                 data              write; bit 0: bits 2 and 3 are the bytes of data that are not used
//!          0x80                        abort code        the master gives up: no answer
//! answer   0x43 | unused << 2          data              read
//!          0x60                        0 0 0 0           written
//!          0x80                        abort code        refused
//! ```
//!
//! Reference: CiA 301, sections "Service data object" and "Abort SDO transfer protocol".

use super::Node;

/// Why a transfer was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Abort {
    UnknownCommand = 0x0504_0001,
    ReadOnly = 0x0601_0002,
    NoObject = 0x0602_0000,
    Length = 0x0607_0010,
    NoSubindex = 0x0609_0011,
    Range = 0x0609_0030,
    State = 0x0800_0022,
}

/// An object's value: little-endian in the lowest 1, 2 or 4 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Value {
    bits: u32,
    size: u8,
}

impl Value {
    pub(super) const fn bits(self) -> u32 {
        self.bits
    }

    /// Of the data those bytes that an object of this size has.
    const fn resized(self, data: u32) -> Self {
        let mask = match self.size {
            1 => 0xff,
            2 => 0xffff,
            _ => u32::MAX,
        };
        Self { bits: data & mask, ..self }
    }
}

impl From<u8> for Value {
    fn from(value: u8) -> Self {
        Self { bits: value.into(), size: 1 }
    }
}

impl From<i8> for Value {
    fn from(value: i8) -> Self {
        value.cast_unsigned().into()
    }
}

impl From<u16> for Value {
    fn from(value: u16) -> Self {
        Self { bits: value.into(), size: 2 }
    }
}

impl From<i16> for Value {
    fn from(value: i16) -> Self {
        value.cast_unsigned().into()
    }
}

impl From<u32> for Value {
    fn from(bits: u32) -> Self {
        Self { bits, size: 4 }
    }
}

impl From<i32> for Value {
    fn from(value: i32) -> Self {
        value.cast_unsigned().into()
    }
}

/// The answer to a request, if it gets one.
pub(super) fn answer(node: &mut Node, request: [u8; 8]) -> Option<[u8; 8]> {
    let [command, i0, i1, subindex, d0, d1, d2, d3] = request;
    let index = u16::from_le_bytes([i0, i1]);
    let data = u32::from_le_bytes([d0, d1, d2, d3]);
    let outcome = match command >> 5 {
        1 => write(node, command, (index, subindex), data).map(|()| (0x60, 0)),
        2 => node.object((index, subindex)).map(|value| (read_command(value), value.bits)),
        4 => return None,
        _ => Err(Abort::UnknownCommand),
    };
    let (command, data) = outcome.unwrap_or_else(|abort| (0x80, abort as u32));
    let [d0, d1, d2, d3] = data.to_le_bytes();
    Some([command, i0, i1, subindex, d0, d1, d2, d3])
}

fn read_command(value: Value) -> u8 {
    0x43 | 4_u8.saturating_sub(value.size) << 2
}

fn write(node: &mut Node, command: u8, object: (u16, u8), data: u32) -> Result<(), Abort> {
    let [expedited, sized] = [0x02, 0x01].map(|bit| command & bit != 0);
    if !expedited {
        return Err(Abort::UnknownCommand);
    }
    let old = node.object(object)?;
    if !Node::writable(object) {
        return Err(Abort::ReadOnly);
    }
    let size = 4_u8.saturating_sub(command >> 2 & 0x03);
    if sized && size != old.size {
        return Err(Abort::Length);
    }
    node.set_object(object, old.resized(data))
}
