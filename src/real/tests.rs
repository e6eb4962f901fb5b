use super::*;
use crate::elementary::ours;

#[test]
fn f32_sine_and_cosine_stay_within_their_stated_error() {
    let worst = (0..1 << 22)
        .map(|k: u32| {
            let phase = k.wrapping_mul(1021);
            let (s, c) = ours::sine_cosine(phase);
            let (exact_s, exact_c) = f64::sin_cos_phase(phase);
            (f64::from(s) - exact_s).abs().max((f64::from(c) - exact_c).abs())
        })
        .fold(0.0, f64::max);
    assert!(worst <= SIN_COS_ERROR && worst > 0.9 * SIN_COS_ERROR, "{worst:e}");
}

#[test]
fn f32_square_root_stays_within_its_stated_error() {
    let worst = (0..1 << 22)
        .map(|k: u32| f32::from_bits(0x0080_0000 + k * 509))
        .filter(|x| x.is_finite())
        .map(|x| (f64::from(ours::square_root_or_zero(x)) / f64::from(x).sqrt() - 1.0).abs())
        .fold(0.0, f64::max);
    assert!(worst <= SQRT_ERROR && worst > 0.8 * SQRT_ERROR, "{worst:e}");
    assert_eq!([0.0, -1.0].map(ours::square_root_or_zero), [0.0, 0.0]);
    assert_eq!(((-1f64).sqrt_or_zero(), 4f64.sqrt_or_zero()), (0.0, 2.0));
}

fn worst_relative(f: fn(f32) -> f32, exact: fn(f64) -> f64, top: f32) -> f64 {
    (0..200_000)
        .map(|k| {
            let x = top * (k as f32 / 200_000.0) * (k as f32 / 200_000.0) + 1e-9;
            let expected = exact(f64::from(x));
            ((f64::from(f(x)) - expected) / expected).abs()
        })
        .fold(0.0, f64::max)
}

#[test]
fn exponentials_stay_within_their_stated_error() {
    let worst = worst_relative(ours::one_minus_exp_neg, libm_one_minus_exp_neg, 100.0);
    assert!(worst <= ONE_MINUS_EXP_NEG_ERROR && worst > 0.7 * ONE_MINUS_EXP_NEG_ERROR, "{worst:e}");
    let worst = (0..400_000)
        .map(|k| 1e-9 + 50.0 * (f64::from(k) / 4e5).powi(2))
        .map(|x| (Real::one_minus_exp_neg(x) / libm_one_minus_exp_neg(x) - 1.0).abs())
        .fold(0.0, f64::max);
    assert!(worst <= ONE_MINUS_EXP_NEG_ERROR_F64 && worst > 0.7 * ONE_MINUS_EXP_NEG_ERROR_F64, "{worst:e}");
}

fn libm_one_minus_exp_neg(x: f64) -> f64 {
    -libm::expm1(-x)
}

proptest::proptest! {
    #[test]
    fn exponentials_are_a_share_for_any_finite_number(bits: u32, wide: u64) {
        let (x, y) = (f32::from_bits(bits).abs(), f64::from_bits(wide).abs());
        proptest::prop_assert!(!x.is_finite() || (0.0..=1.0).contains(&ours::one_minus_exp_neg(x)), "{x}");
        proptest::prop_assert!(!y.is_finite() || (0.0..=1.0).contains(&y.one_minus_exp_neg()), "{y}");
        proptest::prop_assert_eq!(ours::one_minus_exp_neg(0.0), 0.0);
    }
}
