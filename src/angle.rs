//! Angles that grow without bound, and the gear ratio between two of them.
//!
//! An angle is an integer number of counts, 2^32 to a revolution (the low word is the phase, the high
//! word the revolutions), plus the fraction of a count that has not yet become a whole one:
//!
//! ```text
//! theta = (counts + rest) * 2*pi/2^32      1 count = 1.46e-9 rad
//! ```
//!
//! After [`Angle::plus`] |rest| <= 1. The exact operations leave what theirs add up to, a few counts.
//!
//! so a difference of two angles is as exact after 10^6 revolutions as after none, in f32 too. Counts
//! wrap after 2^31 revolutions (248 days at 100 revolutions a second); differences stay right across the wrap.
//!
//! The signed ratio r = 1/n is applied as a binary fraction of 63 bits. After 10^6
//! wave-generator revolutions (2^52 counts) its rounding is below 2^-12 counts.
//! Turning back, n is an integer: no count is rounded, only the fraction of one.

use crate::branch::seldom;
use crate::constants::constants;
use crate::error::{Error, require};
use crate::real::{RADIANS_PER_COUNT, Real};

/// An unbounded angle.
///
/// An f32 alone would resolve a motor's angle after a million turns to 0.5 rad; this is exact to a count, and where the
/// counts wrap, differences go on:
///
/// ```
/// use strainwave::Angle;
///
/// let million_turns = Angle::<f32>::from_counts(1_000_000 << 32);
/// let moved = million_turns.plus(1e-6).plus(1e-6);
/// assert!((moved.minus(million_turns) - 2e-6).abs() < 1e-12);
/// assert_eq!(1_000_000.0_f32 * std::f32::consts::TAU + 1e-6, 1_000_000.0_f32 * std::f32::consts::TAU);
///
/// let last = Angle::<f32>::from_counts(i64::MAX);
/// assert!((last.plus(0.25).minus(last) - 0.25).abs() < 1e-7);
/// // A quarter turn: what an encoder of 19 bits shows, and its direction.
/// let quarter = Angle::<f32>::from_turn_fraction(1, 4);
/// assert_eq!(quarter.phase() >> (32 - 19), (1 << 19) / 4);
/// assert!((quarter.sin_cos().0 - 1.0).abs() < 1e-6);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Angle<R> {
    /// Whole counts, 2^32 to a revolution.
    pub counts: i64,
    /// Fraction of a count that is carried to the next sum.
    pub rest: R,
}

impl<R: Real> Angle<R> {
    /// Exactly `counts` counts.
    #[inline(always)]
    pub const fn from_counts(counts: i64) -> Self {
        Self { counts, rest: R::ZERO }
    }

    /// An angle of at most half a revolution either way (rad); larger ones saturate there.
    #[inline]
    pub fn from_radians(angle: R) -> Self {
        Self::default().plus(angle)
    }

    /// The fraction numerator/denominator of a revolution; the denominator is not 0. For `build` only.
    pub fn from_turn_fraction(numerator: i32, denominator: i32) -> Self {
        let (numerator, denominator) = (i64::from(numerator) << 32, i64::from(denominator));
        let rest = R::from_i32((numerator % denominator) as i32) / R::from_i32(denominator as i32);
        Self { counts: numerator / denominator, rest }
    }

    /// Sine and cosine, the fraction of a count included.
    #[inline]
    pub fn sin_cos(self) -> (R, R) {
        let (sine, cosine) = R::sin_cos_phase(self.phase());
        let rest = self.rest * R::lit(RADIANS_PER_COUNT);
        (sine + cosine * rest, cosine - sine * rest)
    }

    /// Counts within the revolution.
    #[inline(always)]
    pub fn phase(self) -> u32 {
        self.counts as u32
    }

    /// Cosine and sine.
    #[inline(always)]
    pub fn heading(self) -> Heading<R> {
        Heading::of_phase(self.phase())
    }

    /// `self + delta` (rad); a `delta` beyond half a revolution saturates there, NaN moves by a few counts at most.
    #[inline]
    #[must_use]
    pub fn plus(self, delta: R) -> Self {
        let exact = delta * R::lit(1.0 / RADIANS_PER_COUNT) + self.rest;
        let whole = exact.to_i32();
        let rest = exact - R::from_i32(whole);
        Self { counts: self.counts.wrapping_add(i64::from(whole)), rest: rest.limit(R::ONE) }
    }

    /// `self - other` (rad); saturates at 2^15 revolutions either way.
    #[inline]
    pub fn minus(self, other: Self) -> R {
        let counts = self.counts.wrapping_sub(other.counts);
        let narrow = counts as i32;
        let whole = if i64::from(narrow) == counts {
            R::from_i32(narrow)
        } else {
            seldom();
            rounded(counts)
        };
        (whole + (self.rest - other.rest)) * R::lit(RADIANS_PER_COUNT)
    }

    /// `self - other` (rad) of two angles that are less than half a revolution apart; of others so many revolutions less.
    #[inline(always)]
    pub fn since(self, other: Self) -> R {
        let counts = self.phase().wrapping_sub(other.phase()).cast_signed();
        (R::from_i32(counts) + (self.rest - other.rest)) * R::lit(RADIANS_PER_COUNT)
    }

    /// `self - other` as an angle, exact.
    #[inline]
    #[must_use]
    pub fn less(self, other: Self) -> Self {
        Self { counts: self.counts.wrapping_sub(other.counts), rest: self.rest - other.rest }
    }

    /// The whole angle (rad), in f64: for files and plots, not for the control step.
    pub fn to_radians(self) -> f64 {
        (self.counts as f64 + self.rest.to_f64()) * RADIANS_PER_COUNT
    }

    /// An angle of any size (rad), from f64: for files and tests, not for the control step.
    pub fn from_radians_f64(angle: f64) -> Self {
        let counts = angle / RADIANS_PER_COUNT;
        let whole = counts as i64;
        Self { counts: whole, rest: R::lit(counts - whole as f64) }
    }
}

/// Counts as a number, saturating at 2^15 revolutions either way.
#[inline(always)]
fn rounded<R: Real>(counts: i64) -> R {
    let high = (counts >> 16).clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32;
    // In two pieces that are each exact in f32 when the difference is small.
    R::from_i32(high) * R::lit(65536.0) + R::from_i32((counts & 0xffff) as i32)
}

/// A gear ratio r = 1/n, n positive or negative, as an exact map of angles.
///
/// With the circular spline fixed the output turns against the motor, once in N turns of it; there and back nothing is
/// lost:
///
/// ```
/// use strainwave::{Angle, Ratio};
///
/// let gear = Ratio::one_over(-100)?;
/// let motor = Angle::<f32>::from_counts(100 << 32);
/// assert_eq!(gear.apply(motor).counts, -(1 << 32));
/// let output = Angle::<f32>::from_radians(0.3);
/// assert!(gear.apply(gear.to_motor(output)).minus(output).abs() < 1e-12); // rad
/// # Ok::<(), strainwave::Error>(())
/// ```
#[constants]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ratio {
    n: i32,
    /// 2^63/n, rounded, as high*2^32 + low.
    high: i32,
    low: i32,
}

impl Ratio {
    /// r = 1/n, |n| in 2..=1000.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `ratio`.
    pub fn one_over(n: i32) -> Result<Self, Error> {
        let magnitude = u64::from(n.unsigned_abs());
        require((2..=1000).contains(&magnitude), "ratio")?;
        let fraction = (((1 << 63) + magnitude / 2) / magnitude).cast_signed() * i64::from(n.signum());
        // Both signed: each product of the step is one instruction.
        let low = fraction as i32;
        Ok(Self { n, high: ((fraction - i64::from(low)) >> 32) as i32, low })
    }

    /// r * angle: from the wave generator to the ideal output.
    #[inline]
    pub fn apply<R: Real>(self, angle: Angle<R>) -> Angle<R> {
        let (high, low) = ((angle.counts >> 32) as i32, angle.phase());
        // In 2^-31 counts; of the product of the lower words only whole ones.
        let lower = (i64::from(low) * i64::from(self.low)) >> 32;
        let below = i64::from(high) * i64::from(self.low) + i64::from(low) * i64::from(self.high) + lower;
        let counts = (2 * i64::from(high) * i64::from(self.high)).wrapping_add(below >> 31);
        let fraction = R::from_i32((below & 0x7fff_ffff) as i32) * R::lit(1.0 / 2_147_483_648.0);
        Angle { counts, rest: fraction + angle.rest * self.rounded::<R>() }
    }

    /// angle / r: from the ideal output to the wave generator.
    #[inline]
    pub fn to_motor<R: Real>(self, angle: Angle<R>) -> Angle<R> {
        let fraction = angle.rest * R::from_i32(self.n);
        let whole = fraction.to_i32();
        let counts = angle.counts.wrapping_mul(i64::from(self.n)).wrapping_add(i64::from(whole));
        Angle { counts, rest: fraction - R::from_i32(whole) }
    }

    /// r without a division, to 2^-31.
    #[inline(always)]
    pub(crate) fn rounded<R: Real>(self) -> R {
        R::from_i32(self.high) * R::lit(1.0 / 2_147_483_648.0)
    }

    /// n = 1/r.
    pub fn n(self) -> i32 {
        self.n
    }

    /// r as a number, for `build`.
    pub fn value<R: Real>(self) -> R {
        R::ONE / R::from_i32(self.n)
    }
}

/// Cosine and sine of an angle, taken once for all that depends on them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heading<R> {
    /// Cosine.
    pub cosine: R,
    /// Sine.
    pub sine: R,
}

impl<R: Real> Default for Heading<R> {
    fn default() -> Self {
        Self { cosine: R::ONE, sine: R::ZERO }
    }
}

impl<R: Real> Heading<R> {
    /// Of a phase of 2^32 counts a revolution.
    #[inline(always)]
    pub fn of_phase(phase: u32) -> Self {
        let (sine, cosine) = R::sin_cos_phase(phase);
        Self { cosine, sine }
    }

    /// The sum of two angles.
    #[inline(always)]
    pub fn plus(self, other: Self) -> Self {
        Self {
            cosine: self.cosine * other.cosine - self.sine * other.sine,
            sine: self.sine * other.cosine + self.cosine * other.sine,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Torsion r*theta_wg - theta_fs resolves equally well after a million revolutions, in f32.
    #[test]
    fn resolution_after_a_million_turns() {
        let worst = [0, 1_000_000, -1_000_000]
            .into_iter()
            .flat_map(|revolutions: i64| (-1000..1000).map(move |step| (revolutions, step)))
            .map(|(revolutions, step)| {
                let ratio = Ratio::one_over(-100).unwrap();
                let torsion = f64::from(step) * 1e-7;
                let motor = Angle::<f32>::from_counts((revolutions << 32) + 12_345_678);
                let exact_output = -(motor.counts as f64) / 100.0 * RADIANS_PER_COUNT;
                let residue = (-(i128::from(motor.counts)) % 100) as f64 / 100.0 * RADIANS_PER_COUNT;
                let output = Angle::<f32>::from_counts(-motor.counts / 100).plus((residue - torsion) as f32);
                assert!(
                    (output.to_radians() - (exact_output - torsion)).abs()
                        < 1e-9 * (1.0 + exact_output.abs())
                );
                (f64::from(ratio.apply(motor).minus(output)) - torsion).abs()
            })
            .fold(0.0, f64::max);
        assert!(worst < 1e-9, "{worst:e} rad");
    }

    #[test]
    fn ratios_outside_the_range_are_refused() {
        for n in [0, 1, -1, 1001, i32::MIN] {
            assert_eq!(Ratio::one_over(n), Err(Error::OutOfRange("ratio")));
        }
    }

    proptest! {
        #[test]
        fn what_is_added_comes_back_as_the_difference(counts: i64, delta in -3.0..3.0f64) {
            let angle = Angle::<f64>::from_counts(counts);
            prop_assert!((angle.plus(delta).minus(angle) - delta).abs() < 1e-15 * (1.0 + delta.abs()));
            let angle = Angle::<f32>::from_counts(counts);
            let error = f64::from(angle.plus(delta as f32).minus(angle)) - f64::from(delta as f32);
            prop_assert!(error.abs() <= 2e-7 * delta.abs() + 1e-15);
        }

        /// Increments far below a count are carried, not lost.
        #[test]
        fn small_increments_add_up(increment in 1e-12..1e-9f32) {
            let sum = (0..1000).fold(Angle::<f32>::default(), |angle, _| angle.plus(increment));
            let expected = 1000.0 * f64::from(increment);
            prop_assert!((sum.to_radians() - expected).abs() <= 1e-4 * expected);
        }

        #[test]
        fn a_ratio_divides_exactly(revolutions in -2_000_000..2_000_000i64, phase: u32, n in 2..1000i32) {
            let angle = Angle::<f64>::from_counts((revolutions << 32) + i64::from(phase));
            for n in [n, -n] {
                let ratio = Ratio::one_over(n).unwrap();
                let applied = ratio.apply(angle);
                let (n, counts) = (i128::from(n), i128::from(angle.counts));
                let error = (i128::from(applied.counts) * n - counts) as f64 / n as f64 + applied.rest;
                prop_assert!(error.abs() < 1e-3, "{} counts", error);
                prop_assert!((ratio.to_motor(applied).minus(angle)).abs() < 1e-9);
            }
        }

        #[test]
        fn any_input_is_total(counts: i64, bits: u32) {
            let angle = Angle::<f32>::from_counts(counts).plus(f32::from_bits(bits));
            prop_assert!(angle.rest.abs() <= 1.0);
            let not_a_number = angle.plus(f32::NAN);
            prop_assert!(not_a_number.counts == angle.counts && not_a_number.rest.abs() <= 1.0);
            prop_assert!(angle.minus(Angle::default()).is_finite());
        }
    }
}
