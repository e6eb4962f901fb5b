//! The scalar that every model is generic over, and every elementary function that it uses.
//!
//! f32 (firmware) and f64 (reference) run the same generic code through [`Real`]; a cargo feature
//! that switched the type would be unified across a workspace and silently reach the firmware.
//! A number enters generic code as f64, through [`Real::lit`].
//!
//! Every square root, exponential and sine of the library is called through it, but for those of the link's mode shapes
//! (`elementary/double.rs`). Square roots of `build` and the f64 sine are libm's. The functions of the control step are our
//! own, because libm's `sinf` reduces its argument in f64, which a Cortex-M4F only has in software. micromath's, which do
//! without, have errors of 1.1e-3 (sine) and 2.9e-2 (1 - e^-x from 1e-6 on), too much for torsion and presliding (measured in
//! `host-tests/tests/elementary_functions.rs`). A cargo feature nevertheless chooses either crate's in their place
//! ([`crate::elementary`]); the table is of our own:
//!
//! | function | range | max error, f32 | f64 |
//! | --- | --- | --- | --- |
//! | [`Real::sin_cos_phase`] | any phase | [`SIN_COS_ERROR`] absolute | libm's |
//! | [`Real::sqrt_or_zero`] | any finite x | [`SQRT_ERROR`] relative | libm's |
//! | [`Real::one_minus_exp_neg`] | finite x >= 0 | [`ONE_MINUS_EXP_NEG_ERROR`] relative | [`ONE_MINUS_EXP_NEG_ERROR_F64`] |

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use crate::branch::seldom;
use crate::fixed::Fixed;

pub use crate::sine_cosine::RADIANS_PER_COUNT;

/// Largest absolute error of the f32 [`Real::sin_cos_phase`].
pub const SIN_COS_ERROR: f64 = 8e-8;
/// Largest relative error of the f32 [`Real::sqrt_or_zero`] of a normal number.
pub const SQRT_ERROR: f64 = 2.4e-7;
/// Largest relative error of the f32 [`Real::one_minus_exp_neg`].
pub const ONE_MINUS_EXP_NEG_ERROR: f64 = 2.5e-7;
/// Largest relative error of the f64 [`Real::one_minus_exp_neg`].
pub const ONE_MINUS_EXP_NEG_ERROR_F64: f64 = 6e-16;

/// A floating-point scalar: f32 in firmware, f64 in the reference build.
pub trait Real:
    Copy
    + Default
    + Debug
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + Send
    + Sync
    + 'static
{
    /// Zero.
    const ZERO: Self;
    /// One.
    const ONE: Self;
    /// Largest finite value.
    const MAX: Self;
    /// Bits of the significand.
    const MANTISSA_DIGITS: u32;

    /// The integer that hysteresis computes in.
    type Fixed: Fixed<Self>;

    /// The nearest value to a literal; folded at compile time.
    fn lit(value: f64) -> Self;
    /// The value as f64, exact. Not for the control step.
    fn to_f64(self) -> f64;
    /// The nearest value to an integer.
    fn from_i32(value: i32) -> Self;
    /// The integer part towards zero; saturates, and is 0 for NaN.
    fn to_i32(self) -> i32;
    /// Neither NaN nor infinite.
    fn is_finite(self) -> bool;
    /// Finite and above 0.
    #[inline(always)]
    fn is_positive(self) -> bool {
        self.is_finite() && self > Self::ZERO
    }
    /// The same bits. One comparison of integers.
    fn is_same(self, other: Self) -> bool;
    /// Within 0..=1, without -0; not NaN. One comparison of integers.
    fn is_fraction(self) -> bool;
    /// Square root, for `build` only.
    fn sqrt(self) -> Self;
    /// Square root of a finite number; 0 of one below 0.
    fn sqrt_or_zero(self) -> Self;
    /// `1 - e^-x` for a finite `x >= 0`, accurate for small `x`. No other bits panic, but what they give is
    /// not said.
    fn one_minus_exp_neg(self) -> Self;
    /// Sine and cosine of a phase of 2^32 counts a revolution: the range reduction is exact.
    fn sin_cos_phase(phase: u32) -> (Self, Self);

    /// Magnitude: the sign bit cleared.
    fn abs(self) -> Self;
    /// The magnitude of `self` with the sign bit of `other`: no branch.
    fn copysign(self, other: Self) -> Self;
    /// The smaller; `other` when `self` is NaN.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
    /// The larger; `other` when `self` is NaN.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    /// Within `-bound..=bound`; not NaN.
    #[inline(always)]
    fn is_within(self, bound: Self) -> bool {
        self.abs() <= bound
    }
    /// Limited to `-bound..=bound`; `-bound` when `self` is NaN.
    #[inline(always)]
    fn limit(self, bound: Self) -> Self {
        if self.is_within(bound) {
            return self;
        }
        seldom();
        if self > Self::ZERO { bound } else { -bound }
    }
    /// Dead zone of half width `width`: 0 within it, beyond it what exceeds it.
    #[inline(always)]
    fn dead_zone(self, width: Self) -> Self {
        if self > width {
            self - width
        } else if self < -width {
            self + width
        } else {
            Self::ZERO
        }
    }
    /// -1, 0 or 1; 0 for NaN.
    #[inline(always)]
    fn sign(self) -> Self {
        if self > Self::ZERO {
            Self::ONE
        } else if self < Self::ZERO {
            -Self::ONE
        } else {
            Self::ZERO
        }
    }
    /// `self` when it is finite, else `held`.
    #[inline(always)]
    fn finite_or(self, held: Self) -> Self {
        if self.is_finite() { self } else { held }
    }
}

/// Methods with the same text for both scalars.
macro_rules! common {
    () => {
        const ZERO: Self = 0.0;
        const ONE: Self = 1.0;
        const MAX: Self = Self::MAX;
        const MANTISSA_DIGITS: u32 = Self::MANTISSA_DIGITS;

        #[inline(always)]
        fn to_i32(self) -> i32 {
            self as i32
        }
        #[inline(always)]
        fn is_finite(self) -> bool {
            Self::is_finite(self)
        }
        #[inline(always)]
        fn is_same(self, other: Self) -> bool {
            self.to_bits() == other.to_bits()
        }
        #[inline(always)]
        fn is_fraction(self) -> bool {
            self.to_bits() <= Self::ONE.to_bits()
        }
        #[inline(always)]
        fn abs(self) -> Self {
            Self::abs(self)
        }
        #[inline(always)]
        fn copysign(self, other: Self) -> Self {
            Self::copysign(self, other)
        }
    };
}

mod double;
mod single;

#[cfg(test)]
mod tests;
