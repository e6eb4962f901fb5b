//! A reply of the drive.

use super::value::{NEWTON_METRES, REVOLUTIONS, REVOLUTIONS_PER_SECOND, Value, varuint};

/// No operation: fills a frame.
pub(super) const NOP: u8 = 0x50;
const WRITE_ERROR: u8 = 0x30;
const READ_ERROR: u8 = 0x31;

/// What a reply says of the registers that are asked for. What is left out, not a number, or behind the first unknown byte is missing.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Reply {
    pub(super) mode: Option<u8>,
    pub(super) position: Option<f32>,
    pub(super) velocity: Option<f32>,
    pub(super) torque: Option<f32>,
    pub(super) fault: Option<u8>,
    /// A register was not written, or not read.
    pub(super) refused: bool,
}

impl Reply {
    pub(super) fn parse(data: &[u8]) -> Self {
        let mut reply = Self::default();
        let mut rest = data;
        // A subframe takes at least one byte.
        while let Some(behind) = reply.subframe(rest) {
            rest = behind;
        }
        reply
    }

    /// What is behind the subframe; `None` at the end, or where none begins.
    fn subframe<'a>(&mut self, data: &'a [u8]) -> Option<&'a [u8]> {
        let (&kind, rest) = data.split_first()?;
        match kind {
            NOP => Some(rest),
            0x20..=0x2f => self.values(kind, rest),
            WRITE_ERROR | READ_ERROR => {
                self.refused = true;
                let (_register, rest) = varuint(rest)?;
                let (_error, rest) = varuint(rest)?;
                Some(rest)
            }
            _ => None,
        }
    }

    fn values<'a>(&mut self, kind: u8, rest: &'a [u8]) -> Option<&'a [u8]> {
        let (number, rest) = match kind & 3 {
            0 => varuint(rest)?,
            number => (number.into(), rest),
        };
        let (first, mut rest) = varuint(rest)?;
        // Ends with the bytes, whatever the number.
        for register in 0..number {
            let (value, behind) = Value::take(kind, rest)?;
            self.set(first.checked_add(register)?, value);
            rest = behind;
        }
        Some(rest)
    }

    fn set(&mut self, register: u32, value: Value) {
        match register {
            0x000 => self.mode = value.code(),
            0x001 => self.position = value.quantity(REVOLUTIONS),
            0x002 => self.velocity = value.quantity(REVOLUTIONS_PER_SECOND),
            0x003 => self.torque = value.quantity(NEWTON_METRES),
            0x00f => self.fault = value.code(),
            _ => {}
        }
    }
}
