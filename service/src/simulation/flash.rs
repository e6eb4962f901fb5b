//! NOR flash, simulated: bits that only an erasure sets, pages, and a power that may fail at any byte.

use std::vec::Vec;

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Bytes that are programmed at once.
pub const WORD: usize = 8;
/// Bytes of a page.
pub const PAGE: usize = 512;
/// Bytes that are erased while one is programmed: a cut may come in between.
const ERASED_AT_ONCE: usize = 32;

/// Why the flash refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error {
    /// The power is off.
    Off,
    /// Out of its range, or not aligned.
    Range(NorFlashErrorKind),
    /// The word was programmed since it was erased.
    NotErased,
}

impl NorFlashError for Error {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::Range(kind) => *kind,
            Self::Off | Self::NotErased => NorFlashErrorKind::Other,
        }
    }
}

/// A simulated flash.
#[derive(Clone, Debug)]
pub struct Flash {
    bytes: Vec<u8>,
    /// Whether each word was programmed since it was erased.
    programmed: Vec<bool>,
    /// Steps until the power fails; a byte is one when it is programmed.
    left: Option<usize>,
    steps: usize,
    /// Bits of a byte that the failing power has programmed, and of bytes that it has erased.
    random: ChaCha8Rng,
}

impl Flash {
    /// A flash of so many pages with this content, over and over.
    pub fn new(pages: usize, content: &[u8], random: ChaCha8Rng) -> Self {
        let bytes: Vec<u8> = content.iter().copied().cycle().take(pages * PAGE).collect();
        let programmed = bytes.chunks(WORD).map(|word| word.iter().any(|byte| *byte != 0xff)).collect();
        Self { bytes, programmed, left: None, steps: 0, random }
    }

    /// From now on the power fails after so many steps.
    pub fn cut_after(&mut self, steps: usize) {
        self.left = Some(steps);
    }

    /// The power is back.
    pub fn power_on(&mut self) {
        self.left = None;
    }

    /// Steps so far.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Its content, which may be changed.
    pub fn bytes(&mut self) -> &mut [u8] {
        &mut self.bytes
    }

    /// Takes a step; false once when it is the one that the power fails in.
    fn step(&mut self) -> Result<bool, Error> {
        self.steps += 1;
        match &mut self.left {
            None => Ok(true),
            Some(0) => Err(Error::Off),
            Some(left) => {
                *left -= 1;
                Ok(*left > 0)
            }
        }
    }
}

impl ErrorType for Flash {
    type Error = Error;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Error> {
        check_read(self, offset, bytes.len()).map_err(Error::Range)?;
        if self.left == Some(0) {
            return Err(Error::Off);
        }
        bytes.copy_from_slice(&self.bytes[offset as usize..offset as usize + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = PAGE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Error> {
        check_erase(self, from, to).map_err(Error::Range)?;
        for place in (from as usize..to as usize).step_by(ERASED_AT_ONCE) {
            let whole = self.step()?;
            for byte in &mut self.bytes[place..place + ERASED_AT_ONCE] {
                *byte |= if whole { 0xff } else { self.random.random::<u8>() };
            }
            self.programmed[place / WORD..(place + ERASED_AT_ONCE) / WORD].fill(!whole);
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Error> {
        check_write(self, offset, bytes.len()).map_err(Error::Range)?;
        for (place, byte) in (offset as usize..).zip(bytes) {
            let whole = self.step()?;
            if place.is_multiple_of(WORD) && std::mem::replace(&mut self.programmed[place / WORD], true) {
                return Err(Error::NotErased);
            }
            let missing = if whole { 0 } else { self.random.random::<u8>() };
            self.bytes[place] &= byte | missing;
        }
        Ok(())
    }
}
