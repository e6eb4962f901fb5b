//! Our own: neither branch nor division, and no double precision.

use crate::real::Real;
use crate::{exponential, sine_cosine as table};

/// Bytes of constants that [`sine_cosine`] reads.
pub const SINE_COSINE_TABLE: usize = table::BYTES;
/// Bytes of constants that [`one_minus_exp_neg`] reads.
pub const ONE_MINUS_EXP_NEG_TABLE: usize = exponential::SINGLE_BYTES;

/// Sine and cosine of a phase of 2^32 counts a revolution.
#[inline(always)]
pub fn sine_cosine(phase: u32) -> (f32, f32) {
    table::sine_cosine_f32(phase)
}

/// Square root of a finite number; 0 of one below 0. x times 1/sqrt(x), by three Newton steps from a guess that halves the exponent.
#[inline(always)]
pub fn square_root_or_zero(x: f32) -> f32 {
    let x = Real::max(x, 0.0);
    let mut inverse = f32::from_bits(0x5f37_59df - (x.to_bits() >> 1));
    for _ in 0..3 {
        inverse *= 1.5 - 0.5 * x * inverse * inverse;
    }
    x * inverse
}

/// `1 - e^-x` for a finite `x >= 0`.
#[inline(always)]
pub fn one_minus_exp_neg(x: f32) -> f32 {
    exponential::one_minus_exp_neg_f32(x)
}
