//! NOR flash in a file of the host, by semihosting: what is stored there outlives the emulator.
//!
//! The host makes the file, as long as the flash, before it starts the emulator. Bits are only cleared by a write, and set by the erasure of a page, as in
//! a real flash; the control goes on meanwhile.

use core::ops::Range;
use cortex_m_semihosting::{nr, syscall};
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};
use strainwave_app::served::{STORE_BYTES, STORE_FILE};

/// Bytes that are programmed, and erased, at once.
const WORD: usize = 4;
const PAGE: usize = STORE_BYTES / 2;
/// Bytes that go to the host at once.
const CHUNK: usize = 32;
/// What an erased byte reads.
const ERASED: u8 = 0xff;

/// The flash.
pub struct FlashFile(usize);

impl FlashFile {
    /// The whole of it.
    pub const REGION: Range<u32> = 0..STORE_BYTES as u32;

    /// Opens the file; `None` when the host has not made it.
    pub fn open() -> Option<Self> {
        // SAFETY: the block names a string, its length without the zero, and a mode.
        let handle =
            unsafe { syscall!(OPEN, STORE_FILE.as_ptr(), nr::open::RW_BINARY, STORE_FILE.count_bytes()) };
        (handle != usize::MAX).then_some(Self(handle))
    }

    fn seek(&self, offset: usize) -> Result<(), NorFlashErrorKind> {
        // SAFETY: the block names a handle and a position in its file.
        let failed = unsafe { syscall!(SEEK, self.0, offset) };
        if failed == 0 { Ok(()) } else { Err(NorFlashErrorKind::Other) }
    }

    fn get(&self, offset: usize, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        self.seek(offset)?;
        // SAFETY: the block names `bytes` and its length; the host writes no further.
        let missing = unsafe { syscall!(READ, self.0, bytes.as_mut_ptr(), bytes.len()) };
        if missing == 0 { Ok(()) } else { Err(NorFlashErrorKind::Other) }
    }

    fn put(&self, offset: usize, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        self.seek(offset)?;
        // SAFETY: the block names `bytes` and its length; the host only reads them.
        let missing = unsafe { syscall!(WRITE, self.0, bytes.as_ptr(), bytes.len()) };
        if missing == 0 { Ok(()) } else { Err(NorFlashErrorKind::Other) }
    }
}

impl ErrorType for FlashFile {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for FlashFile {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        check_read(self, offset, bytes.len())?;
        self.get(offset as usize, bytes)
    }

    fn capacity(&self) -> usize {
        STORE_BYTES
    }
}

impl NorFlash for FlashFile {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = PAGE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        check_erase(self, from, to)?;
        (from..to).step_by(CHUNK).try_for_each(|place| self.put(place as usize, &[ERASED; CHUNK]))
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        check_write(self, offset, bytes.len())?;
        for (place, new) in (offset as usize..).step_by(CHUNK).zip(bytes.chunks(CHUNK)) {
            let mut old = [ERASED; CHUNK];
            let Some(old) = old.get_mut(..new.len()) else { return Err(NorFlashErrorKind::Other) };
            self.get(place, old)?;
            old.iter_mut().zip(new).for_each(|(old, new)| *old &= *new);
            self.put(place, old)?;
        }
        Ok(())
    }
}
