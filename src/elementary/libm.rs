//! libm's: within a digit of the exact value; its sine and cosine compute in double precision, which a Cortex-M4F has only in software.

use crate::real::{RADIANS_PER_COUNT, Real};

/// Sine and cosine of a phase of 2^32 counts a revolution.
#[inline]
pub fn sine_cosine(phase: u32) -> (f32, f32) {
    ::libm::sincosf(phase.cast_signed() as f32 * RADIANS_PER_COUNT as f32)
}

/// Square root of a finite number; 0 of one below 0.
#[inline]
pub fn square_root_or_zero(x: f32) -> f32 {
    ::libm::sqrtf(Real::max(x, 0.0))
}

/// `1 - e^-x` for a finite `x >= 0`.
#[inline]
pub fn one_minus_exp_neg(x: f32) -> f32 {
    -::libm::expm1f(-x)
}
