//! Integers that the real-time operator remembers and computes in.
//!
//! ```text
//! position    the input over -U..U on the whole range of an unsigned integer; its mirror is its complement
//! fraction    position in a cell, relative to 2^(BITS - 1)
//! output      in quanta of 2^-SHIFT of an entry of the table; its mirror is its complement
//! ```
//!
//! Integers compare in one instruction on any processor, a position times the number of cells is cell and
//! fraction in the two words of one product, a conversion saturates at the ends of the range, and sums are
//! exact: a minor loop closes to the last bit, and the output does not drift however often a loop is run
//! through. f32 computes in 32 bits with a table of 16-bit entries, half the memory of an f32 one; f64 in 64
//! bits with a table of as many, finer than f64 itself resolves.

use crate::branch::cheaper;
use core::fmt::Debug;
use core::ops::{Add, BitXor, Not, Sub};

/// Integer that a scalar `R` is kept in as an output.
pub trait Fixed<R>:
    Copy
    + Default
    + Debug
    + Ord
    + Add<Output = Self>
    + Sub<Output = Self>
    + Not<Output = Self>
    + Send
    + Sync
    + 'static
{
    /// As an input; as unsigned, and as wide.
    type Position: Copy
        + Default
        + Debug
        + Ord
        + Not<Output = Self::Position>
        + BitXor<Output = Self::Position>
        + Send
        + Sync
        + 'static;
    /// Number in a table.
    type Entry: Copy + Default + Debug + PartialEq + Send + Sync + 'static;

    /// Largest magnitude of an entry.
    const LARGEST: R;
    /// Quanta of an output in one of an entry: 2^SHIFT.
    const SCALE: R;
    /// Its processor foresees a branch, and then need not wait for what the last step has stored.
    const FORESEEN: bool;
    /// Positions in half of the range: 2^(BITS - 1).
    const HALF_RANGE: R;
    /// Arguments of [`Self::position`] for the input U, and for 0.
    const UPPER_END: R;
    /// See [`Self::UPPER_END`].
    const CENTRE: R;
    /// Position of the input 0.
    const MIDDLE: Self::Position;

    /// The position of an input scaled and shifted; the end of the range beyond it, and the lower one for NaN.
    fn position(scaled: R) -> Self::Position;
    /// !0 where `position` is below `other`, else 0; and as an index, -1 or 0.
    fn below(position: Self::Position, other: Self::Position) -> (Self::Position, usize);
    /// It is one of the two ends of the range.
    fn is_end(position: Self::Position) -> bool;
    /// Positions from the middle.
    fn distance(position: Self::Position) -> Self;
    /// The cell of `cells` in which a position lies, and its fraction.
    fn place(position: Self::Position, cells: usize) -> (usize, Self);
    /// The nearest number.
    fn real(self) -> R;
    /// The number, without what is behind the point.
    fn truncated(number: R) -> Self;
    /// `self`, or its mirror when `frame` is !0; the frame is 0 otherwise.
    fn in_frame(self, frame: Self::Position) -> Self;
    /// The nearest entry to a value within +-[`Self::LARGEST`].
    fn entry(value: R) -> Self::Entry;
    /// An entry as an output.
    fn output(entry: Self::Entry) -> Self;
    /// Linear between two entries.
    fn between(near: Self::Entry, far: Self::Entry, fraction: Self) -> Self;
    /// `self` times a fraction, or a difference of two.
    fn scaled(self, fraction: Self) -> Self;
    /// Half of it.
    fn half(self) -> Self;
}

macro_rules! common {
    ($real:ty, $position:ty, $double:ty, $unsigned_double:ty) => {
        type Position = $position;

        const HALF_RANGE: $real = Self::MIDDLE as $real;
        const MIDDLE: $position = Self::MIN.cast_unsigned();

        #[inline(always)]
        fn is_end(position: $position) -> bool {
            position.wrapping_add(1) <= 1
        }
        #[inline(always)]
        fn distance(position: $position) -> Self {
            (position ^ Self::MIDDLE).cast_signed()
        }
        #[inline(always)]
        fn place(position: $position, cells: usize) -> (usize, Self) {
            let product = position as $unsigned_double * cells as $unsigned_double;
            ((product >> Self::BITS) as usize, (product as $position >> 1).cast_signed())
        }
        #[inline(always)]
        fn real(self) -> $real {
            self as $real
        }
        #[inline(always)]
        fn truncated(number: $real) -> Self {
            number as Self
        }
        #[inline(always)]
        fn in_frame(self, frame: $position) -> Self {
            self ^ frame.cast_signed()
        }
        #[inline(always)]
        fn scaled(self, fraction: Self) -> Self {
            // The high word of the product is one instruction.
            (((self as $double * fraction as $double) >> Self::BITS) as Self) << 1
        }
        #[inline(always)]
        fn half(self) -> Self {
            self >> 1
        }
    };
}

/// Entries times 2^15 fill 31 bits.
impl Fixed<f32> for i32 {
    type Entry = i16;

    const LARGEST: f32 = i16::MAX as f32;
    const SCALE: f32 = (1 << 15) as f32;
    const FORESEEN: bool = false;
    const CENTRE: f32 = Self::HALF_RANGE;
    const UPPER_END: f32 = 2.0 * Self::HALF_RANGE;

    common!(f32, u32, i64, u64);

    #[inline(always)]
    fn position(scaled: f32) -> u32 {
        scaled as u32
    }
    /// The borrow of the difference: no branch, which a microcontroller does not foresee.
    #[inline(always)]
    fn below(position: u32, other: u32) -> (u32, usize) {
        let borrow = (u64::from(position).wrapping_sub(u64::from(other)) >> 32) as u32;
        (borrow, borrow.cast_signed() as usize)
    }

    fn entry(value: f32) -> i16 {
        (value + if value < 0.0 { -0.5 } else { 0.5 }) as i16
    }
    #[inline(always)]
    fn output(entry: i16) -> Self {
        Self::from(entry) << 15
    }
    /// With the upper 15 bits of the fraction: one multiplication, and less than an entry's rounding is lost.
    #[inline(always)]
    fn between(near: i16, far: i16, fraction: Self) -> Self {
        (Self::from(far) - Self::from(near)) * (fraction >> 16) + Self::output(near)
    }
}

/// Entries of 2^60 leave room for sums and differences of outputs.
impl Fixed<f64> for i64 {
    type Entry = Self;

    const LARGEST: f64 = (1_i64 << 60) as f64;
    const SCALE: f64 = 1.0;
    const FORESEEN: bool = true;
    const CENTRE: f64 = 1.5;
    const UPPER_END: f64 = 2.0;

    common!(f64, u64, i128, u128);

    /// From 1 to 2 the significand is the position: a conversion takes a desktop's processor longer.
    #[inline(always)]
    fn position(scaled: f64) -> u64 {
        let bits = scaled.to_bits();
        if bits >> 52 == 1.0_f64.to_bits() >> 52 {
            return bits << 12;
        }
        cheaper();
        if scaled >= Self::UPPER_END { u64::MAX } else { 0 }
    }
    /// A branch: a desktop's processor foresees it, and does not wait for the last step.
    #[inline(always)]
    fn below(position: u64, other: u64) -> (u64, usize) {
        if position < other {
            cheaper();
            (u64::MAX, usize::MAX)
        } else {
            (0, 0)
        }
    }

    fn entry(value: f64) -> Self {
        value as Self
    }
    #[inline(always)]
    fn output(entry: Self) -> Self {
        entry
    }
    #[inline(always)]
    fn between(near: Self, far: Self, fraction: Self) -> Self {
        near + (far - near).scaled(fraction)
    }
}
