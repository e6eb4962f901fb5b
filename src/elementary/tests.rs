//! Which functions [`Real`] for f32 has, and that those of every library keep what it promises.

use super::*;
use crate::real::Real;
use proptest::prelude::*;

type SineCosine = fn(u32) -> (f32, f32);
type Function = fn(f32) -> f32;

/// Sine and cosine, square root, 1 - e^-x.
const LIBRARIES: &[(SineCosine, Function, Function)] = &[
    (ours::sine_cosine, ours::square_root_or_zero, ours::one_minus_exp_neg),
    (libm::sine_cosine, libm::square_root_or_zero, libm::one_minus_exp_neg),
    #[cfg(any(feature = "micromath", feature = "micromath-beside"))]
    (micromath::sine_cosine, micromath::square_root_or_zero, micromath::one_minus_exp_neg),
];

/// Those of the library that the features choose.
#[cfg(feature = "libm")]
fn expected(phase: u32, x: f32) -> ((f32, f32), f32, f32) {
    let radians = (f64::from(phase.cast_signed()) as f32) * crate::real::RADIANS_PER_COUNT as f32;
    (::libm::sincosf(radians), ::libm::sqrtf(x), -::libm::expm1f(-x))
}

#[cfg(all(feature = "micromath", not(feature = "libm")))]
fn expected(phase: u32, x: f32) -> ((f32, f32), f32, f32) {
    use ::micromath::F32Ext;
    let radians = (f64::from(phase.cast_signed()) as f32) * crate::real::RADIANS_PER_COUNT as f32;
    let share = 1.0 - F32Ext::exp(-x);
    ((F32Ext::sin(radians), F32Ext::cos(radians)), F32Ext::sqrt(x), share.clamp(0.0, 1.0))
}

#[cfg(not(any(feature = "micromath", feature = "libm")))]
fn expected(phase: u32, x: f32) -> ((f32, f32), f32, f32) {
    (ours::sine_cosine(phase), ours::square_root_or_zero(x), ours::one_minus_exp_neg(x))
}

proptest! {
    #[test]
    fn f32_has_the_functions_of_the_chosen_library(phase: u32, x in 0f32..100.0) {
        let found = (f32::sin_cos_phase(phase), x.sqrt_or_zero(), x.one_minus_exp_neg());
        prop_assert_eq!(found, expected(phase, x));
    }

    #[test]
    fn every_library_is_bounded_for_any_bits(phase: u32, bits: u32) {
        let x = f32::from_bits(bits);
        for (sine_cosine, square_root, one_minus_exp_neg) in LIBRARIES {
            let (sine, cosine) = sine_cosine(phase);
            prop_assert!(sine.abs() < 1.01 && cosine.abs() < 1.01, "{phase}: {sine} {cosine}");
            if x.is_finite() {
                prop_assert!(square_root(x).is_finite() && square_root(x) >= 0.0, "{x}");
                prop_assert!((0.0..=1.0).contains(&one_minus_exp_neg(x.abs())), "{x}");
            }
        }
    }
}
