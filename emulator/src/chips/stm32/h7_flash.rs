//! Flash of an STM32H7 (ST RM0433, chapter 4): two banks, of which the second is erased and written, the first only read.
//!
//! A word of the flash is 32 bytes with their error correction: it is programmed once, as a whole, in words of the bus that come one after the
//! other. Shorter than on the chip are the erasures. Protection, options, mass erasure and interrupts are not there.

use std::sync::{Arc, Mutex};

use rsemu::core::device::{Device, DeviceClass, PropertySpec, RealizeCtx, ResetKind};
use rsemu::core::error::{BusError, Result};
use rsemu::core::props::{Media, Props, ValueKind};
use rsemu::core::sched::LazyHandle;
use rsemu::core::space::{
    AccessConstraints, Mapping, MemAttrs, MemOps, MemResult, Perms, RamStore, Region, RegionRef,
};
use rsemu::core::value::{Endian, Width};
use rsemu::machine::realize::Instance;
use rsemu::machine::validate::{ClassSchema, PropSchema};

use crate::chips::time::Time;
use crate::lock::locked;

/// Size of the registers' place (bytes).
const REGISTERS: u64 = 0x400;
/// Bytes of both banks, of one, of a sector, and of a word.
const SIZE: u64 = 2 << 20;
const BANK: u64 = SIZE / 2;
const SECTOR: u64 = 128 << 10;
const WORD: usize = 32;

/// Wait states; of the second bank its keys, control, status, and what clears that.
const ACR: u64 = 0x00;
const KEYR2: u64 = 0x104;
const CR2: u64 = 0x10c;
const SR2: u64 = 0x110;
const CCR2: u64 = 0x114;

const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];

/// In the control.
const LOCK: u32 = 1 << 0;
const PROGRAMS: u32 = 1 << 1;
const ERASES: u32 = 1 << 2;
const START: u32 = 1 << 7;
/// In the status: busy, a word is not complete; a wrong sequence, a word that does not go on, one that was programmed before.
const BUSY: u32 = 1 << 0;
const PARTLY: u32 = 1 << 1;
const SEQUENCE: u32 = 1 << 18;
const INCONSISTENT: u32 = 1 << 21;
const TWICE: u32 = 1 << 22;
const FAILURES: u32 = SEQUENCE | INCONSISTENT | TWICE;

/// Clocks, of 8 MHz, of an operation: 0.1 ms for a word, 20 ms for a sector.
const WORD_TIME: u64 = 800;
const SECTOR_TIME: u64 = 160_000;

/// Class of it in a machine's description.
pub static CLASS: DeviceClass = DeviceClass {
    name: "strainwave.h7-flash",
    version: 1,
    summary: "STM32H7 flash of 2 MB",
    properties: &[PropertySpec {
        name: "image",
        kind: ValueKind::Media,
        required: false,
        summary: "what it holds",
    }],
    construct: |props| Ok(Box::new(Flash::new(props)?)),
};

/// What a description may say of it.
pub fn schema() -> ClassSchema {
    ClassSchema::new(CLASS.name).prop(PropSchema::new("image", ValueKind::Media)).region("").region("array")
}

/// The flash.
#[derive(Debug)]
pub struct Flash(Arc<Controller>);

impl Flash {
    /// Of its properties.
    ///
    /// # Errors
    /// With an image that is too large.
    pub fn new(props: &Props) -> Result<Self> {
        let mut reader = props.reader();
        let image = reader.optional_media("image")?.map(Media::to_bytes);
        reader.finish()?;
        let flash = Self(Arc::new(Controller::erased()));
        if let Some(image) = image {
            let too_large = |_| rsemu::Error::Config {
                at: "image".into(),
                message: "it is larger than the flash".into(),
            };
            flash.0.array.write_at(0, &image).map_err(too_large)?;
        }
        Ok(flash)
    }
}

/// What of the second bank is under way.
#[derive(Clone, Copy, Debug, Default)]
enum Operation {
    #[default]
    None,
    Sector(u64),
    Word(u64, [u8; WORD]),
}

/// The registers.
#[derive(Debug)]
struct State {
    access: u32,
    /// Keys that have come in their order; none opens it after a wrong one.
    keys: Option<usize>,
    control: u32,
    failures: u32,
    /// The word that is not complete: its place, and bytes so far.
    partly: Option<(u64, Vec<u8>)>,
    operation: Operation,
    until: u64,
}

impl Default for State {
    fn default() -> Self {
        Self {
            access: 0,
            keys: Some(0),
            control: LOCK,
            failures: 0,
            partly: None,
            operation: Operation::None,
            until: 0,
        }
    }
}

impl State {
    fn status(&self) -> u32 {
        let busy = if matches!(self.operation, Operation::None) { 0 } else { BUSY };
        busy | if self.partly.is_some() { PARTLY } else { 0 } | self.failures
    }

    fn write(&mut self, offset: u64, word: u32, now: u64) {
        match offset {
            ACR => self.access = word,
            KEYR2 => self.key(word),
            CCR2 => self.failures &= !(word & FAILURES),
            CR2 if self.control & LOCK == 0 => self.control(word, now),
            _ => {}
        }
    }

    fn key(&mut self, word: u32) {
        self.keys = match self.keys {
            Some(come) if KEYS[come] == word && come + 1 == KEYS.len() => {
                self.control &= !LOCK;
                Some(0)
            }
            Some(come) if KEYS[come] == word => Some(come + 1),
            _ => None,
        };
    }

    fn control(&mut self, word: u32, now: u64) {
        self.control = word & !START;
        if word & (START | ERASES) == START | ERASES {
            if matches!(self.operation, Operation::None) {
                self.begin(
                    Operation::Sector(BANK + u64::from(word >> 8 & 0b111) * SECTOR),
                    now + SECTOR_TIME,
                );
            } else {
                self.failures |= SEQUENCE;
            }
        }
    }

    fn begin(&mut self, operation: Operation, until: u64) {
        (self.operation, self.until) = (operation, until);
    }

    /// Takes a word of the bus; the complete word of the flash.
    fn take(&mut self, offset: u64, bytes: &[u8]) -> Option<(u64, [u8; WORD])> {
        let allowed = self.control & (LOCK | PROGRAMS) == PROGRAMS && offset >= BANK;
        if !allowed || !matches!(self.operation, Operation::None) {
            self.failures |= SEQUENCE;
            return None;
        }
        let (place, mut so_far) = self.partly.take().unwrap_or((offset, Vec::new()));
        if !place.is_multiple_of(WORD as u64) || place + so_far.len() as u64 != offset {
            self.failures |= INCONSISTENT;
            return None;
        }
        so_far.extend(bytes);
        let complete = so_far.as_slice().try_into().ok().map(|word| (place, word));
        if complete.is_none() {
            self.partly = Some((place, so_far));
        }
        complete
    }
}

/// It with its array and its time.
#[derive(Debug)]
struct Controller {
    state: Mutex<State>,
    array: Arc<RamStore>,
    time: Time,
}

impl Controller {
    fn erased() -> Self {
        let array = RamStore::new(SIZE);
        // All of it is there.
        let _ = array.fill(0, SIZE, 0xff);
        Self { state: Mutex::default(), array: Arc::new(array), time: Time::default() }
    }

    /// Ends what has taken its time by now.
    fn up_to(&self, now: u64) -> MemResult {
        let mut state = locked(&self.state);
        if now < state.until {
            return Ok(());
        }
        match std::mem::take(&mut state.operation) {
            Operation::None => Ok(()),
            Operation::Sector(place) => self.array.fill(place, SECTOR, 0xff),
            Operation::Word(place, word) => self.array.write_at(place, &word),
        }
    }

    fn program(&self, offset: u64, bytes: &[u8], now: u64) -> MemResult {
        let mut state = locked(&self.state);
        let Some((place, word)) = state.take(offset, bytes) else { return Ok(()) };
        let mut old = [0; WORD];
        self.array.read_at(place, &mut old)?;
        if old.iter().all(|byte| *byte == 0xff) {
            state.begin(Operation::Word(place, word), now + WORD_TIME);
        } else {
            state.failures |= TWICE;
        }
        Ok(())
    }
}

impl Device for Flash {
    fn class(&self) -> &'static DeviceClass {
        &CLASS
    }

    fn realize(&self, _context: &mut RealizeCtx<'_>) -> Result<()> {
        Ok(())
    }

    fn reset(&self, _kind: ResetKind) {
        *locked(&self.0.state) = State::default();
    }

    fn region(&self, name: &str) -> Option<RegionRef> {
        let io = |name, size, ops| -> RegionRef { Arc::new(Region::io(name, size, ops)) };
        match name {
            "" => Some(io(CLASS.name, REGISTERS, Arc::new(Face(self.0.clone())) as Arc<dyn MemOps>)),
            // Read from memory, written by the controller's rules.
            "array" => {
                let read: RegionRef = Arc::new(Region::ram("h7-flash.read", self.0.array.clone()));
                let write = io("h7-flash.write", SIZE, Arc::new(Words(self.0.clone())) as Arc<dyn MemOps>);
                let both = vec![
                    Mapping::new(read, 0).with_perms(Perms::RX),
                    Mapping::new(write, 0).with_perms(Perms::WRITE),
                ];
                Some(Arc::new(Region::container("h7-flash", SIZE, both)))
            }
            _ => None,
        }
    }

    // An access brings it up to date.
    fn is_lazy(&self) -> bool {
        true
    }

    fn current_tick(&self) -> u64 {
        self.0.time.now()
    }

    fn advance_to(&self, tick: u64) {
        self.0.time.advance_to(tick);
    }

    fn attach_lazy(&self, handle: LazyHandle) {
        self.0.time.attach(handle);
    }
}

impl Instance for Flash {}

/// Its registers.
#[derive(Debug)]
struct Face(Arc<Controller>);

impl MemOps for Face {
    fn read(&self, offset: u64, bytes: &mut [u8], attributes: MemAttrs) -> MemResult {
        self.0.up_to(self.0.time.sync(attributes))?;
        let state = locked(&self.0.state);
        let word = match offset {
            ACR => state.access,
            CR2 => state.control,
            SR2 => state.status(),
            _ => 0,
        };
        bytes.copy_from_slice(&word.to_le_bytes());
        Ok(())
    }

    fn write(&self, offset: u64, bytes: &[u8], attributes: MemAttrs) -> MemResult {
        let now = self.0.time.sync(attributes);
        self.0.up_to(now)?;
        let mut word = [0; 4];
        word.copy_from_slice(bytes);
        locked(&self.0.state).write(offset, u32::from_le_bytes(word), now);
        Ok(())
    }

    fn constraints(&self) -> AccessConstraints {
        AccessConstraints::word(Width::U32, Endian::Little)
    }
}

/// Its array, as it is written.
#[derive(Debug)]
struct Words(Arc<Controller>);

impl MemOps for Words {
    fn read(&self, _offset: u64, _bytes: &mut [u8], _attributes: MemAttrs) -> MemResult {
        Err(BusError::Unassigned)
    }

    fn write(&self, offset: u64, bytes: &[u8], attributes: MemAttrs) -> MemResult {
        let now = self.0.time.sync(attributes);
        self.0.up_to(now)?;
        self.0.program(offset, bytes, now)
    }

    fn constraints(&self) -> AccessConstraints {
        AccessConstraints::word(Width::U32, Endian::Little)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLACE: u64 = BANK + SECTOR;

    fn unlocked() -> Controller {
        let flash = Controller::erased();
        let mut state = locked(&flash.state);
        KEYS.iter().for_each(|key| state.write(KEYR2, *key, 0));
        state.write(CR2, PROGRAMS, 0);
        assert_eq!(state.control & LOCK, 0);
        drop(state);
        flash
    }

    fn programs(flash: &Controller, from: u64) {
        (from..from + WORD as u64).step_by(4).for_each(|at| flash.program(at, &[1, 2, 3, 4], 0).unwrap());
    }

    fn first(flash: &Controller) -> u8 {
        let mut byte = [0];
        flash.array.read_at(PLACE, &mut byte).unwrap();
        byte[0]
    }

    #[test]
    fn a_word_is_there_after_its_time_and_is_not_written_twice() {
        let flash = unlocked();
        programs(&flash, PLACE);
        assert_eq!((locked(&flash.state).status(), first(&flash)), (BUSY, 0xff));
        flash.up_to(WORD_TIME).unwrap();
        assert_eq!((locked(&flash.state).status(), first(&flash)), (0, 1));
        programs(&flash, PLACE);
        assert_eq!(locked(&flash.state).status(), TWICE);
    }

    #[test]
    fn a_sector_is_erased() {
        let flash = unlocked();
        programs(&flash, PLACE);
        flash.up_to(WORD_TIME).unwrap();
        locked(&flash.state).write(CR2, ERASES | START | 1 << 8, WORD_TIME);
        flash.up_to(WORD_TIME + SECTOR_TIME).unwrap();
        assert_eq!((locked(&flash.state).status(), first(&flash)), (0, 0xff));
    }

    #[test]
    fn what_is_out_of_order_is_refused() {
        let flash = unlocked();
        flash.program(PLACE + 4, &[0; 4], 0).unwrap();
        assert_eq!(locked(&flash.state).status(), INCONSISTENT);
        locked(&flash.state).write(CCR2, FAILURES, 0);
        flash.program(0, &[0; 4], 0).unwrap();
        assert_eq!(locked(&flash.state).status(), SEQUENCE);
        let flash = Controller::erased();
        let mut state = locked(&flash.state);
        [1, KEYS[0], KEYS[1]].iter().for_each(|key| state.write(KEYR2, *key, 0));
        assert_eq!(state.control, LOCK);
    }
}
