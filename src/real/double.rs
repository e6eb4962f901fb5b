//! f64, the reference's scalar: libm's functions, and our own exponential.

use super::Real;
use crate::exponential;
use crate::sine_cosine::RADIANS_PER_COUNT;

impl Real for f64 {
    common!();

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
    #[inline]
    fn sqrt(self) -> Self {
        libm::sqrt(self)
    }
    #[inline]
    fn sqrt_or_zero(self) -> Self {
        libm::sqrt(Real::max(self, 0.0))
    }
    #[inline(always)]
    fn one_minus_exp_neg(self) -> Self {
        exponential::one_minus_exp_neg_f64(self)
    }
    #[inline]
    fn sin_cos_phase(phase: u32) -> (Self, Self) {
        libm::sincos(Self::from(phase.cast_signed()) * RADIANS_PER_COUNT)
    }
}
