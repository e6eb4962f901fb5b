//! Store: words that survive power loss at any moment, in two areas of NOR flash.
//!
//! ```text
//! record   owner's layout | owner's joint | sequence | number of words n | CRC-32 of all others | word 0 .. word n-1
//! area     record | record | .. | erased            each from a multiple of 32 bytes on
//! ```
//!
//! All little-endian, 4 bytes each; CRC-32 is ISO-HDLC. The valid record with the highest sequence is what was stored. The next one goes
//! behind it, where that is erased; when its area is full the other area is erased and begun. So what was stored last is
//! never touched while another record is written: a cut leaves the old record or the new one. A record that was cut stays unreadable, and is skipped.
//! Not covered: a bit that a cut has left half programmed and that reads differently from time to time.
//!
//! A record of another layout or of another joint is neither read nor overwritten ([`Error::Layout`], [`Error::Joint`]) until
//! [`Store::erase`]. Layouts of other lengths are told by the first record of an area, which gives its own.
//!
//! Wear: an area is erased once for as many records as fit into it. With e erase cycles that the flash endures, areas of a bytes and
//! records of r bytes ([`Store::RECORD`]) there are `2*e*floor(a/r)` writes.
//!
//! While flash is written or erased many chips cannot read it: if the control runs from there it stands still, on an STM32F405 16 us for a
//! word and 0.25 to 0.5 s for an erased sector. [`crate::tuning`] therefore writes where the drive is off, unless the board tells otherwise.
//!
//! sequential-storage and ekv are made for more than one record, and asynchronous; the image of the former's map has 7.6 kB and reachable panics.

use core::ops::Range;

use embedded_storage::nor_flash::NorFlash;

use crate::CHECKSUM;

/// What is read and written at once: a multiple of what any flash writes.
const CHUNK: usize = 32;
/// Words before the stored ones.
const HEADER: usize = 5;

/// Whose words they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Owner {
    /// Layout of the words.
    pub layout: u32,
    /// The joint that they are of.
    pub joint: u32,
}

/// Why words could not be read or stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error {
    /// The region is not two areas of whole erasable pages that hold a record each, or the flash writes more than 32 bytes at once.
    Region,
    /// What is stored has another layout.
    Layout,
    /// What is stored is of another joint.
    Joint,
    /// The flash failed, or does not hold what was written.
    Flash,
}

impl Error {
    /// What is wrong, in words.
    pub const fn reason(self) -> &'static str {
        match self {
            Self::Region => "region that cannot hold two records",
            Self::Layout => "layout of another version",
            Self::Joint => "store of another joint",
            Self::Flash => "flash that fails",
        }
    }
}

/// Words as they are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Record<const N: usize> {
    /// Number of the record, from 1 on.
    pub sequence: u32,
    /// The words.
    pub words: [u32; N],
}

/// Head of a record as it lies in flash.
#[derive(Clone, Copy)]
struct Head {
    owner: Owner,
    sequence: u32,
    words: u32,
    checksum: u32,
}

/// The record that was stored last.
#[derive(Clone, Copy)]
struct Newest {
    address: u32,
    head: Head,
}

/// N words in two areas of a flash.
pub struct Store<F, const N: usize> {
    flash: F,
    /// Start of the first area, and length of each (bytes).
    start: u32,
    area: u32,
    owner: Owner,
}

impl<F: NorFlash, const N: usize> Store<F, N> {
    /// Bytes of a record.
    pub const RECORD: u32 = (4 * (HEADER + N)).next_multiple_of(CHUNK) as u32;

    /// The store of `owner` in a region of the flash, the first half of which is the first area.
    ///
    /// # Errors
    /// [`Error::Region`].
    pub fn new(flash: F, region: Range<u32>, owner: Owner) -> Result<Self, Error> {
        let area = region.end.saturating_sub(region.start) / 2;
        let page = const { F::ERASE_SIZE as u32 };
        let fits = region.end as usize <= flash.capacity() && area >= Self::RECORD;
        let aligned = region.start.is_multiple_of(page)
            && region.end.is_multiple_of(page)
            && area.is_multiple_of(page)
            && area.is_multiple_of(CHUNK as u32);
        let chunks = const { CHUNK.is_multiple_of(F::WRITE_SIZE) && CHUNK.is_multiple_of(F::READ_SIZE) };
        if fits && aligned && chunks {
            Ok(Self { flash, start: region.start, area, owner })
        } else {
            Err(Error::Region)
        }
    }

    /// The words that were stored last, if any.
    ///
    /// # Errors
    /// [`Error::Layout`], [`Error::Joint`] or [`Error::Flash`].
    pub fn read(&mut self) -> Result<Option<Record<N>>, Error> {
        self.newest()?.map(|newest| self.record(newest)).transpose()
    }

    /// Stores words; the number of their record.
    ///
    /// # Errors
    /// As [`Self::read`]; then the old words are still there.
    pub fn write(&mut self, words: &[u32; N]) -> Result<u32, Error> {
        let newest = self.newest()?;
        let sequence = newest.map_or(1, |newest| newest.head.sequence.saturating_add(1));
        let behind = newest.map(|newest| self.erased_behind(newest.address)).transpose()?.flatten();
        let in_place = behind.ok_or(Error::Flash).and_then(|address| self.put(address, sequence, words));
        // Full, or not to be programmed although it reads as erased: a cut can leave that.
        in_place.or_else(|_| {
            let area = newest.map_or(self.start, |newest| self.other_area(newest.address));
            self.begin(area)?;
            self.put(area, sequence, words)
        })
    }

    /// Forgets what is stored, whosever it is.
    ///
    /// # Errors
    /// [`Error::Flash`].
    pub fn erase(&mut self) -> Result<(), Error> {
        self.begin(self.start)?;
        self.begin(self.start + self.area)
    }

    /// Starts of the areas.
    fn areas(&self) -> [u32; 2] {
        [self.start, self.start + self.area]
    }

    fn other_area(&self, address: u32) -> u32 {
        let [first, second] = self.areas();
        if address < second { second } else { first }
    }

    /// End of the area that an address lies in.
    fn end(&self, address: u32) -> u32 {
        let [_, second] = self.areas();
        if address < second { second } else { second + self.area }
    }

    /// Places of records from `address` on, to the end of its area.
    fn places(&self, address: u32) -> impl Iterator<Item = u32> + use<F, N> {
        let end = self.end(address);
        (address..).step_by(Self::RECORD as usize).take_while(move |place| place + Self::RECORD <= end)
    }

    /// The valid record with the highest sequence.
    fn newest(&mut self) -> Result<Option<Newest>, Error> {
        let mut newest: Option<Newest> = None;
        for area in self.areas() {
            for address in self.places(area) {
                let Some(head) = self.valid(address)? else { continue };
                if newest.is_none_or(|newest| newest.head.sequence < head.sequence) {
                    newest = Some(Newest { address, head });
                }
            }
        }
        match newest {
            Some(Newest { head, .. }) if head.owner.layout != self.owner.layout => Err(Error::Layout),
            Some(Newest { head, .. }) if head.words != N as u32 => Err(Error::Layout),
            Some(Newest { head, .. }) if head.owner.joint != self.owner.joint => Err(Error::Joint),
            newest => Ok(newest),
        }
    }

    /// Head of the record at an address, if its checksum is right.
    fn valid(&mut self, address: u32) -> Result<Option<Head>, Error> {
        let chunk = self.chunk(address)?;
        let head = Head::of(&chunk);
        let length = head.words.saturating_add(HEADER as u32).saturating_mul(4);
        if length > self.end(address) - address {
            return Ok(None);
        }
        let mut digest = CHECKSUM.digest();
        digest.update(chunk.get(..CHECKED.start).unwrap_or_default());
        for place in (address..address + length).step_by(CHUNK) {
            let chunk = self.chunk(place)?;
            let first = if place == address { CHECKED.end } else { 0 };
            let last = CHUNK.min((address + length - place) as usize);
            digest.update(chunk.get(first..last).unwrap_or_default());
        }
        Ok((digest.finalize() == head.checksum).then_some(head))
    }

    fn record(&mut self, newest: Newest) -> Result<Record<N>, Error> {
        let mut words = [0; N];
        let mut places = words.iter_mut();
        let length = 4 * (HEADER + N) as u32;
        let mut skipped = HEADER;
        for place in (newest.address..newest.address + length).step_by(CHUNK) {
            let chunk = self.chunk(place)?;
            let (read, _) = chunk.as_chunks();
            for word in read.iter().skip(skipped) {
                if let Some(place) = places.next() {
                    *place = u32::from_le_bytes(*word);
                }
            }
            skipped = 0;
        }
        Ok(Record { sequence: newest.head.sequence, words })
    }

    /// The first place behind a record that is erased, with all behind it that lie in the same area.
    fn erased_behind(&mut self, address: u32) -> Result<Option<u32>, Error> {
        let mut erased = None;
        for place in self.places(address).skip(1) {
            if !self.is_erased(place)? {
                erased = None;
            } else if erased.is_none() {
                erased = Some(place);
            }
        }
        Ok(erased)
    }

    fn is_erased(&mut self, address: u32) -> Result<bool, Error> {
        for place in (address..address + Self::RECORD).step_by(CHUNK) {
            if self.chunk(place)?.iter().any(|byte| *byte != ERASED) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Erases an area.
    fn begin(&mut self, area: u32) -> Result<(), Error> {
        self.flash.erase(area, area + self.area).map_err(|_| Error::Flash)
    }

    /// Writes a record and reads it back; its number.
    fn put(&mut self, address: u32, sequence: u32, words: &[u32; N]) -> Result<u32, Error> {
        let Owner { layout, joint } = self.owner;
        let head = [layout, joint, sequence, N as u32];
        let mut digest = CHECKSUM.digest();
        for word in head.iter().chain(words) {
            digest.update(&word.to_le_bytes());
        }
        let checksum = digest.finalize();
        let mut all = head.iter().chain([&checksum]).chain(words);
        for place in (address..address + Self::RECORD).step_by(CHUNK) {
            let mut chunk = [ERASED; CHUNK];
            let (places, _) = chunk.as_chunks_mut();
            for (bytes, word) in places.iter_mut().zip(&mut all) {
                *bytes = word.to_le_bytes();
            }
            self.flash.write(place, &chunk).map_err(|_| Error::Flash)?;
        }
        match self.read()? {
            Some(stored) if stored.sequence == sequence && stored.words == *words => Ok(sequence),
            _ => Err(Error::Flash),
        }
    }

    fn chunk(&mut self, address: u32) -> Result<[u8; CHUNK], Error> {
        let mut chunk = [0; CHUNK];
        self.flash.read(address, &mut chunk).map_err(|_| Error::Flash)?;
        Ok(chunk)
    }
}

/// What an erased byte reads.
const ERASED: u8 = 0xff;
/// Where the checksum lies in a record.
const CHECKED: Range<usize> = 16..20;

impl Head {
    fn of(chunk: &[u8; CHUNK]) -> Self {
        let (words, _) = chunk.as_chunks();
        let [layout, joint, sequence, words, checksum, ..] = words else { return Self::NONE };
        let [layout, joint, sequence, words, checksum] =
            [layout, joint, sequence, words, checksum].map(|word| u32::from_le_bytes(*word));
        Self { owner: Owner { layout, joint }, sequence, words, checksum }
    }

    /// One that nothing has: it is longer than any flash.
    const NONE: Self =
        Self { owner: Owner { layout: 0, joint: 0 }, sequence: 0, words: u32::MAX, checksum: 0 };
}
