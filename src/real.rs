//! The scalar that every model is generic over, and every elementary function that it uses.
//!
//! f32 (firmware) and f64 (reference) run the same generic code through [`Real`]; a cargo feature
//! that switched the type would be unified across a workspace and silently reach the firmware.
//! A number enters generic code as f64, through [`Real::lit`].
//!
//! This file holds every square root, exponential and trigonometric call of the library. The f64
//! functions are libm's. The f32 functions of the control step are polynomials of our own, because
//! libm's `sinf` reduces its argument in f64, which a Cortex-M4F only has in software. micromath's,
//! which do without, are off by 1.1e-3 (sine), 2.4e-3 (e^-x) and 2.9e-2 (1 - e^-x from 1e-6 on), too much
//! for torsion and presliding (measured in `host-tests/tests/elementary_functions.rs`):
//!
//! | function | range | max error, f32 |
//! | --- | --- | --- |
//! | [`Real::sin_cos_phase`] | any phase | [`SIN_COS_ERROR`] absolute |
//! | [`Real::exp_neg`] | x >= 0 | [`EXP_NEG_ERROR`] relative |
//! | [`Real::one_minus_exp_neg`] | x >= 0 | [`ONE_MINUS_EXP_NEG_ERROR`] relative |

use crate::hysteresis::fixed::Fixed;
use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// Largest absolute error of the f32 [`Real::sin_cos_phase`].
pub const SIN_COS_ERROR: f64 = 1.25e-7;
/// Largest relative error of the f32 [`Real::exp_neg`] where its result is a normal number.
pub const EXP_NEG_ERROR: f64 = 1.1e-7;
/// Largest relative error of the f32 [`Real::one_minus_exp_neg`].
pub const ONE_MINUS_EXP_NEG_ERROR: f64 = 1.4e-7;

/// Radians in one count of a phase of 2^32 counts a turn.
pub const RADIANS_PER_COUNT: f64 = core::f64::consts::TAU / 4_294_967_296.0;

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
    /// Square root, for `build` only.
    fn sqrt(self) -> Self;
    /// `e^-x` for `x >= 0`; a negative `x` counts as 0.
    fn exp_neg(self) -> Self;
    /// `1 - e^-x` for `x >= 0`, accurate for small `x`; a negative `x` counts as 0.
    fn one_minus_exp_neg(self) -> Self;
    /// Sine and cosine of a phase of 2^32 counts a turn: the range reduction is exact.
    fn sin_cos_phase(phase: u32) -> (Self, Self);

    /// Magnitude.
    #[inline(always)]
    fn abs(self) -> Self {
        if self < Self::ZERO { -self } else { self }
    }
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
    /// Limited to `-bound..=bound`; `-bound` when `self` is NaN.
    #[inline(always)]
    fn limit(self, bound: Self) -> Self {
        self.max(-bound).min(bound)
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

impl Real for f64 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const MAX: Self = Self::MAX;
    const MANTISSA_DIGITS: u32 = Self::MANTISSA_DIGITS;

    type Fixed = i64;

    #[inline(always)]
    fn lit(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }
    #[inline(always)]
    fn from_i32(value: i32) -> Self {
        Self::from(value)
    }
    #[inline(always)]
    fn to_i32(self) -> i32 {
        self as i32
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        Self::is_finite(self)
    }
    #[inline]
    fn sqrt(self) -> Self {
        libm::sqrt(self)
    }
    #[inline]
    fn exp_neg(self) -> Self {
        libm::exp(-Real::max(self, 0.0))
    }
    #[inline]
    fn one_minus_exp_neg(self) -> Self {
        -libm::expm1(-Real::max(self, 0.0))
    }
    #[inline]
    fn sin_cos_phase(phase: u32) -> (Self, Self) {
        libm::sincos(Self::from(phase.cast_signed()) * RADIANS_PER_COUNT)
    }
}

impl Real for f32 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const MAX: Self = Self::MAX;
    const MANTISSA_DIGITS: u32 = Self::MANTISSA_DIGITS;

    type Fixed = i32;

    #[inline(always)]
    fn lit(value: f64) -> Self {
        value as Self
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    #[inline(always)]
    fn from_i32(value: i32) -> Self {
        value as Self
    }
    #[inline(always)]
    fn to_i32(self) -> i32 {
        self as i32
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        Self::is_finite(self)
    }
    #[inline]
    fn sqrt(self) -> Self {
        libm::sqrtf(self)
    }

    #[inline]
    fn exp_neg(self) -> Self {
        let (scale, lost) = exp_neg_parts(self);
        scale - scale * lost
    }

    #[inline]
    fn one_minus_exp_neg(self) -> Self {
        let (scale, lost) = exp_neg_parts(self);
        // 1 - scale is exact, and 0 for small x.
        (1.0 - scale) + scale * lost
    }

    /// Quadrant from the top bits, then the minimax polynomials of Cephes' `sinf` and `cosf` on
    /// +-pi/4 (S. Moshier, Methods and Programs for Mathematical Functions, 1989).
    #[inline]
    fn sin_cos_phase(phase: u32) -> (Self, Self) {
        let quadrant = phase.wrapping_add(1 << 29) >> 30;
        let rest = phase.wrapping_sub(quadrant << 30).cast_signed();
        let x = Self::from_i32(rest) * Self::lit(RADIANS_PER_COUNT);
        let square = x * x;
        let sine = x + x * square * (-1.666_665_5e-1 + square * (8.332_161e-3 - square * 1.951_529_6e-4));
        let cosine = 1.0 - 0.5 * square
            + square * square * (4.166_664_6e-2 + square * (-1.388_731_6e-3 + square * 2.443_315_7e-5));
        match quadrant & 3 {
            0 => (sine, cosine),
            1 => (cosine, -sine),
            2 => (-sine, -cosine),
            _ => (-cosine, sine),
        }
    }
}

/// ln 2 split so that `whole * LN_2_HIGH` is exact for `whole <= 126`.
const LN_2_HIGH: f32 = 0.693_359_4;
const LN_2_LOW: f32 = -2.121_944_4e-4;

/// `2^-n` and `1 - e^-r` for `x = n*ln 2 + r`, n the nearest integer, so that `e^-x = 2^-n*e^-r`.
/// Past 126 binary orders the result would be subnormal: x ends there.
#[inline(always)]
fn exp_neg_parts(x: f32) -> (f32, f32) {
    let x = Real::min(Real::max(x, 0.0), 87.3);
    let whole = (x * core::f32::consts::LOG2_E + 0.5).to_i32();
    let orders = <f32 as Real>::from_i32(whole);
    // The rest is taken from x, not from x * log2(e), whose rounding grows with x.
    let rest = x - orders * LN_2_HIGH - orders * LN_2_LOW;
    let scale = f32::from_bits(((127 - whole) as u32) << 23);
    (scale, rest * one_minus_exp_neg_ratio(rest))
}

/// `(1 - e^-x)/x` on `|x| <= ln(2)/2`: minimax polynomial, 1.1e-8 relative before rounding.
#[inline(always)]
fn one_minus_exp_neg_ratio(x: f32) -> f32 {
    const C: [f32; 6] = [1.0, -0.499_999_97, 0.166_665_05, -0.041_667_14, 0.008_369_212, -0.001_388_887_2];
    C[0] + x * (C[1] + x * (C[2] + x * (C[3] + x * (C[4] + x * C[5]))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn f32_sine_and_cosine_stay_within_their_stated_error() {
        let worst = (0..1 << 22)
            .map(|k: u32| {
                let phase = k.wrapping_mul(1021);
                let (s, c) = f32::sin_cos_phase(phase);
                let (exact_s, exact_c) = f64::sin_cos_phase(phase);
                (f64::from(s) - exact_s).abs().max((f64::from(c) - exact_c).abs())
            })
            .fold(0.0, f64::max);
        assert!(worst <= SIN_COS_ERROR && worst > 0.9 * SIN_COS_ERROR, "{worst:e}");
    }

    fn worst_relative(f: fn(f32) -> f32, exact: fn(f64) -> f64, top: f32) -> f64 {
        (0..200_000)
            .map(|k| {
                let x = top * (k as f32 / 200_000.0) * (k as f32 / 200_000.0) + 1e-9;
                let wanted = exact(f64::from(x));
                ((f64::from(f(x)) - wanted) / wanted).abs()
            })
            .fold(0.0, f64::max)
    }

    #[test]
    fn f32_exponentials_stay_within_their_stated_error() {
        let worst = worst_relative(Real::exp_neg, Real::exp_neg, 87.0);
        assert!(worst <= EXP_NEG_ERROR && worst > 0.7 * EXP_NEG_ERROR, "{worst:e}");
        let worst = worst_relative(Real::one_minus_exp_neg, Real::one_minus_exp_neg, 100.0);
        assert!(worst <= ONE_MINUS_EXP_NEG_ERROR && worst > 0.7 * ONE_MINUS_EXP_NEG_ERROR, "{worst:e}");
    }

    #[test]
    fn exponentials_are_total() {
        assert!(f32::INFINITY.exp_neg() < 2e-38 && f32::MAX.exp_neg() > 0.0);
        assert!(f32::NAN.exp_neg().is_finite() && f32::NAN.one_minus_exp_neg().is_finite());
        assert_eq!((-1.0f32).exp_neg(), 1.0);
        assert_eq!(0f32.one_minus_exp_neg(), 0.0);
    }
}
