//! The built compensator as the words of an image: a host builds it, firmware reads it in place.
//!
//! | word | contents |
//! | --- | --- |
//! | 0 | layout: fingerprint of the names and types of all fields, and of this library's version |
//! | 1 | number of words behind the checksum |
//! | 2 | CRC-32 of these, ISO-HDLC, over their bytes in little-endian order |
//! | 3.. | the compensator: f32, u32, i32, i16 and bool in the order of their fields, padding 0 |
//!
//! Words lie in memory little-endian, as on any Cortex-M and on x86-64. Host and target have one layout, for no field is a
//! pointer or as wide as one.

use core::fmt;
use core::mem::offset_of;

use crc::{CRC_32_ISO_HDLC, Crc, NoTable};
use zerocopy::{IntoBytes, TryFromBytes};

use crate::compensator::Compensator;
use crate::compensator::adapt::learning::Learnt;
use crate::compensator::sense::motor_encoder::MotorEncoder;
use crate::constants::{Constants, fingerprint};

/// Words before the compensator's own: layout, number, checksum.
const HEADER: usize = 3;

/// Words of a built compensator with their header.
pub const WORDS: usize = HEADER + size_of::<Compensator<f32>>() / 4;

/// Layout that this version of the library reads and writes.
pub const LAYOUT: u32 =
    fingerprint(<Compensator<f32> as Constants>::FINGERPRINT, env!("CARGO_PKG_VERSION").as_bytes());

/// Words of what a joint has learnt.
pub const LEARNT_WORDS: usize = size_of::<Learnt<f32>>() / 4;

/// Layout of what a joint has learnt: fingerprint of the names and types of all fields.
pub const LEARNT_LAYOUT: u32 = <Learnt<f32> as Constants>::FINGERPRINT;

/// Bit by bit: a table would take 1 kB.
const CHECKSUM: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// Words that are no compensator of this library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BadWords {
    /// Written by another version, or no compensator's.
    Layout,
    /// There are more or fewer than their header tells, or than a compensator has.
    Length,
    /// A bit has changed since they were written.
    Checksum,
    /// The joint has a belt, and the program was built without the cargo feature `belt`.
    Belt,
}

impl BadWords {
    /// What is wrong, in words.
    pub const fn reason(self) -> &'static str {
        match self {
            Self::Layout => "layout of another version",
            Self::Length => "wrong number of words",
            Self::Checksum => "wrong checksum",
            Self::Belt => "joint with a belt, program without the feature `belt`",
        }
    }
}

impl fmt::Display for BadWords {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.reason())
    }
}

impl core::error::Error for BadWords {}

/// Resolution of the motor encoder in words of [`Compensator::to_words`]: 2^bits counts a revolution. For constants, where nothing is
/// checked yet: a board whose encoder has fewer bits does not compile.
///
/// ```
/// # mod joint { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/joint/hd25_100.rs")); }
/// # use joint::JOINT;
/// use strainwave::compensator::words::motor_encoder_bits;
///
/// let built = JOINT.build().unwrap();
/// assert_eq!(motor_encoder_bits(&built.to_words()), built.motor_encoder_bits());
/// ```
///
/// # Panics
/// When the words are of another layout: in a constant, the build fails.
pub const fn motor_encoder_bits(words: &[u32]) -> u32 {
    const SHIFT: usize =
        HEADER + (offset_of!(Compensator<f32>, motor_encoder) + MotorEncoder::<f32>::SHIFT_OFFSET) / 4;
    // Of any length: joint files of another version must compile where they are written anew.
    assert!(words.len() == WORDS && words[0] == LAYOUT, "joint file: layout of another version");
    MotorEncoder::<f32>::bits_of(words[SHIFT])
}

impl Compensator<f32> {
    /// The compensator as words, which [`Self::from_words`] reads.
    ///
    /// ```
    /// # mod joint { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/joint/hd25_100.rs")); }
    /// # use joint::JOINT;
    /// use strainwave::compensator::Compensator;
    /// use strainwave::compensator::words::BadWords;
    ///
    /// let built = JOINT.build().unwrap();
    /// let mut words = built.to_words();
    /// assert_eq!(Compensator::from_words(&words), Ok(&built));
    /// words[100] ^= 1;
    /// assert_eq!(Compensator::from_words(&words), Err(BadWords::Checksum));
    /// ```
    pub fn to_words(&self) -> [u32; WORDS] {
        let mut words = [0; WORDS];
        let [layout, length, checksum, own @ ..] = &mut words;
        self.write(own.as_mut_bytes());
        (*layout, *length, *checksum) = (LAYOUT, own.len() as u32, self::checksum(own));
        words
    }

    /// The compensator that lies in `words`: checked, but neither copied nor computed.
    ///
    /// # Errors
    /// [`BadWords`] when they are not as [`Self::to_words`] of this version has written them.
    pub fn from_words(words: &[u32]) -> Result<&Self, BadWords> {
        let [layout, length, checksum, own @ ..] = words else { return Err(BadWords::Length) };
        if *layout != LAYOUT {
            return Err(BadWords::Layout);
        }
        if *length as usize != own.len() || words.len() != WORDS {
            return Err(BadWords::Length);
        }
        if *checksum != self::checksum(own) {
            return Err(BadWords::Checksum);
        }
        // With the checksum right only a bool that is none could be left.
        let compensator = Self::try_ref_from_bytes(own.as_bytes()).map_err(|_| BadWords::Layout)?;
        if compensator.pulleys.lack_code() { Err(BadWords::Belt) } else { Ok(compensator) }
    }
}

/// Checksum of the compensator's own words, those behind the header.
pub fn checksum(own: &[u32]) -> u32 {
    CHECKSUM.checksum(own.as_bytes())
}

/// What tells a joint's words from those of another: their checksum.
pub const fn identity(words: &[u32; WORDS]) -> u32 {
    let [_, _, checksum, ..] = *words;
    checksum
}

impl Learnt<f32> {
    /// What was learnt as words, which [`Self::from_words`] reads: f32 in the order of their fields.
    pub fn to_words(&self) -> [u32; LEARNT_WORDS] {
        let mut words = [0; LEARNT_WORDS];
        self.write(words.as_mut_bytes());
        words
    }

    /// What these words of [`LEARNT_LAYOUT`] tell: of any value, to be bounded where it is used
    /// ([`Compensator::rest_with`]).
    pub fn from_words(words: &[u32; LEARNT_WORDS]) -> Self {
        // Any bits are an f32: nothing is refused.
        Self::try_read_from_bytes(words.as_bytes()).unwrap_or_default()
    }
}
