//! Two erasable pages of the chip's flash for a store (ST RM0090, chapter 3; RM0440, chapter 3; RM0433, chapter 4), where the memory map of
//! the board has them.
//!
//! ```text
//! unlock    two keys, after which the control register can be written until it is locked
//! erase     the page's number with the erasure's bits, then the start
//! program   the programming's bits, then as many bytes as are programmed at once, in words
//! ```
//!
//! Each waits for the end of the last one; the error flags then tell how it went. A controller that has met a wrong sequence of keys stays locked
//! until the next reset, and what is asked for fails.
//!
//! The data cache would go on showing what was there before: it is off until the operation is over, and begins empty.

use core::marker::PhantomData;
use core::ops::Range;
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};

use crate::register::Register;
use crate::{IndependentWatchdog, Stm32};
use strainwave_controller::served::Service;

unsafe extern "C" {
    /// The first page, by the memory map.
    static _store: u8;
}

const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];

/// Access control of an STM32F4 or STM32G4, and its data cache: on, and emptied, which it can be while it is off.
const ACCESS: usize = 0x00;
const CACHED: u32 = 1 << 10;
const EMPTIED: u32 = 1 << 12;

/// Polls for an operation's end, of ten cycles or more each: longer than the slowest erasure at any clock.
const POLLS: u32 = 1 << 30;

/// Registers of a controller, and their bits.
#[derive(Clone, Copy, Debug)]
pub struct Controller {
    /// Address of the first register.
    pub address: usize,
    /// Offsets of the registers of keys, status, control, and the one that clears flags of the status by ones.
    pub registers: [usize; 4],
    /// In the status: an operation is under way; one has failed.
    pub busy: u32,
    /// See `busy`.
    pub failed: u32,
    /// In the control: locked; what programs; what erases a page, the lowest bit of its number, and the start of that.
    pub locked: u32,
    /// See `locked`.
    pub programs: u32,
    /// See `locked`.
    pub erases: u32,
    /// See `locked`.
    pub number: u32,
    /// See `locked`.
    pub start: u32,
    /// There is a data cache in front of it.
    pub cached: bool,
}

/// A chip with a store in its flash.
///
/// # Safety
/// The controller is there, and the pages where `_store` of the memory map is; nothing else uses them, and no code or constant is in them.
pub unsafe trait StoreFlash: Stm32 {
    /// The controller.
    const CONTROLLER: Controller;
    /// Bytes that are programmed at once.
    const UNIT: usize;
    /// Bytes of a page.
    const PAGE: usize;
    /// Number of the first page.
    const FIRST: u32;
    /// No code is fetched from the flash, or bank of it, that is written.
    const WRITES_BESIDE: bool;

    /// The chip's option bytes leave the pages where they are.
    fn is_there() -> bool {
        true
    }
}

/// The two pages.
pub struct Flash<C>(PhantomData<C>);

/// What the link of a chip is brought up with: its line, and the store in its flash.
pub fn service<C: StoreFlash, L>(line: L) -> Service<L, Flash<C>> {
    let store: Option<(_, Range<u32>)> = C::is_there().then(|| (Flash(PhantomData), 0..2 * C::PAGE as u32));
    Service { line, store, writes_beside: C::WRITES_BESIDE }
}

/// Address of the first page.
fn begin() -> usize {
    &raw const _store as usize
}

fn register<C: StoreFlash>(offset: usize) -> Register {
    // SAFETY: `StoreFlash` promises the controller, and the offsets are those of its registers.
    unsafe { Register::at(C::CONTROLLER.address, offset) }
}

fn status<C: StoreFlash>() -> Register {
    register::<C>(C::CONTROLLER.registers[1])
}

fn control<C: StoreFlash>() -> Register {
    register::<C>(C::CONTROLLER.registers[2])
}

/// Waits for the end of what is under way.
fn ended<C: StoreFlash>() -> bool {
    (0..POLLS).any(|_| status::<C>().read() & C::CONTROLLER.busy == 0)
}

/// Does one operation on the unlocked controller, without the data cache; whether it went well.
fn operate<C: StoreFlash>(operation: impl FnOnce()) -> Result<(), NorFlashErrorKind> {
    let Controller { registers: [keys, _, _, clear], failed, locked, cached, .. } = C::CONTROLLER;
    let access = || register::<C>(ACCESS);
    let went_well = ended::<C>() && {
        if cached {
            access().write(access().read() & !CACHED);
        }
        if control::<C>().read() & locked != 0 {
            KEYS.iter().for_each(|key| register::<C>(keys).write(*key));
        }
        register::<C>(clear).write(failed);
        operation();
        let went_well = ended::<C>() && status::<C>().read() & failed == 0;
        control::<C>().write(locked);
        if cached {
            access().write(access().read() | EMPTIED);
            access().write(access().read() & !EMPTIED | CACHED);
        }
        went_well
    };
    if went_well { Ok(()) } else { Err(NorFlashErrorKind::Other) }
}

/// Does what holds the core up where code is fetched from the same flash, with a watchdog that waits for it.
fn change<C: StoreFlash>(
    change: impl FnOnce() -> Result<(), NorFlashErrorKind>,
) -> Result<(), NorFlashErrorKind> {
    if C::WRITES_BESIDE { change() } else { IndependentWatchdog::<C>::patiently(change) }
}

fn erase<C: StoreFlash>(page: u32) -> Result<(), NorFlashErrorKind> {
    let Controller { erases, number, start, .. } = C::CONTROLLER;
    let chosen = erases | ((C::FIRST + page) * number);
    operate::<C>(|| {
        control::<C>().write(chosen);
        control::<C>().write(chosen | start);
    })
}

/// Programs as many bytes as are programmed at once.
fn program<C: StoreFlash>(offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
    let place = begin() + offset as usize;
    let (words, _) = bytes.as_chunks();
    operate::<C>(|| {
        control::<C>().write(C::CONTROLLER.programs);
        for (word, address) in words.iter().zip((place..).step_by(4)) {
            // SAFETY: within the pages, which `StoreFlash` promises, as `check_write` has made sure; the controller takes the word.
            unsafe { (address as *mut u32).write_volatile(u32::from_le_bytes(*word)) };
        }
        // The words are on their way before the status is read.
        cortex_m::asm::dsb();
    })
}

impl<C> ErrorType for Flash<C> {
    type Error = NorFlashErrorKind;
}

impl<C: StoreFlash> ReadNorFlash for Flash<C> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        check_read(self, offset, bytes.len())?;
        for (byte, address) in bytes.iter_mut().zip(begin() + offset as usize..) {
            // SAFETY: within the pages, which `StoreFlash` promises.
            *byte = unsafe { (address as *const u8).read_volatile() };
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        2 * C::PAGE
    }
}

impl<C: StoreFlash> NorFlash for Flash<C> {
    const WRITE_SIZE: usize = C::UNIT;
    const ERASE_SIZE: usize = C::PAGE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        check_erase(self, from, to)?;
        let page = C::PAGE as u32;
        change::<C>(|| (from / page..to / page).try_for_each(erase::<C>))
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        check_write(self, offset, bytes.len())?;
        let units = bytes.chunks_exact(C::UNIT).zip((offset..).step_by(C::UNIT));
        change::<C>(|| units.into_iter().try_for_each(|(unit, place)| program::<C>(place, unit)))
    }
}
