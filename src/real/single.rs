//! f32, the firmware's scalar: the elementary functions that a cargo feature chooses, our own without one.

use super::Real;
use crate::elementary::chosen;

impl Real for f32 {
    common!();

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
    #[inline]
    fn sqrt(self) -> Self {
        libm::sqrtf(self)
    }
    #[inline(always)]
    fn sqrt_or_zero(self) -> Self {
        chosen::square_root_or_zero(self)
    }

    #[inline(always)]
    fn one_minus_exp_neg(self) -> Self {
        chosen::one_minus_exp_neg(self)
    }

    #[inline(always)]
    fn sin_cos_phase(phase: u32) -> (Self, Self) {
        chosen::sine_cosine(phase)
    }
}
