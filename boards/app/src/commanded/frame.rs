//! A frame of classic CAN with data.

use embedded_can::{Id, StandardId};

/// An identifier of 11 bits and up to 8 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    id: StandardId,
    length: u8,
    bytes: [u8; 8],
}

impl Frame {
    /// With an identifier of 11 bits and at most 8 bytes; else none.
    pub fn of(id: u16, data: &[u8]) -> Option<Self> {
        embedded_can::Frame::new(StandardId::new(id)?, data)
    }

    /// Of the bytes of a word, the first lowest, without those beyond the length, 8 at most.
    pub fn of_word(id: StandardId, length: u8, word: u64) -> Self {
        let length = length.min(8);
        let beyond = u64::MAX.checked_shl(8 * u32::from(length)).unwrap_or(0);
        Self { id, length, bytes: (word & !beyond).to_le_bytes() }
    }

    /// Its bytes as a word, the first lowest, 0 beyond its length.
    pub fn word(&self) -> u64 {
        u64::from_le_bytes(self.bytes)
    }

    /// Its identifier; of two frames that begin at once, the lower goes first.
    pub fn number(&self) -> u16 {
        self.id.as_raw()
    }
}

impl embedded_can::Frame for Frame {
    fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
        let Id::Standard(id) = id.into() else { return None };
        let mut bytes = [0; 8];
        bytes.get_mut(..data.len())?.iter_mut().zip(data).for_each(|(place, byte)| *place = *byte);
        Some(Self { id, length: data.len() as u8, bytes })
    }

    fn new_remote(_id: impl Into<Id>, _length: usize) -> Option<Self> {
        None
    }

    fn is_extended(&self) -> bool {
        false
    }

    fn is_remote_frame(&self) -> bool {
        false
    }

    fn id(&self) -> Id {
        self.id.into()
    }

    fn dlc(&self) -> usize {
        self.length.into()
    }

    fn data(&self) -> &[u8] {
        self.bytes.get(..usize::from(self.length)).unwrap_or(&self.bytes)
    }
}
