//! micromath's: short, and of few digits.

use micromath::F32Ext;

use crate::real::{RADIANS_PER_COUNT, Real};

/// Sine and cosine of a phase of 2^32 counts a revolution.
#[inline]
pub fn sine_cosine(phase: u32) -> (f32, f32) {
    F32Ext::sin_cos(phase.cast_signed() as f32 * RADIANS_PER_COUNT as f32)
}

/// Square root of a finite number; that of 0, which is 8e-20, of one below 0.
#[inline]
pub fn square_root_or_zero(x: f32) -> f32 {
    F32Ext::sqrt(Real::max(x, 0.0))
}

/// `1 - e^-x` for a finite `x >= 0`, kept within 0..=1.
#[inline]
pub fn one_minus_exp_neg(x: f32) -> f32 {
    Real::min(Real::max(1.0 - F32Ext::exp(-x), 0.0), 1.0)
}
