//! The stretch of constant speed: a straight line between two angles, exact at both.

use crate::angle::Angle;
use crate::real::Real;

/// A straight line through an angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FullSpeed<R> {
    start: Angle<R>,
    /// 2^-32 counts a period.
    rate: i64,
}

impl<R: Real> FullSpeed<R> {
    /// From `start` to `end`, less than 2^31 counts a period, in this number of periods; if that is none, it stands.
    pub fn between(start: Angle<R>, end: Angle<R>, periods: u32) -> Self {
        let path = end.less(start);
        let divide = |of: i64| quotient(of, periods);
        let whole = divide(path.counts);
        let left = path.counts.wrapping_sub(whole.wrapping_mul(i64::from(periods)));
        let rest = i64::from((path.rest * R::lit(16_777_216.0)).to_i32()) << 8;
        Self { start, rate: (whole << 32).wrapping_add(divide((left << 32).wrapping_add(rest))) }
    }

    /// The parallel through another angle.
    pub fn from(&self, start: Angle<R>) -> Self {
        Self { start, ..*self }
    }

    /// The angle after this number of periods.
    #[inline]
    pub fn at(&self, periods: u32) -> Angle<R> {
        let whole = (self.rate >> 32).wrapping_mul(i64::from(periods));
        let part = (self.rate & 0xffff_ffff).wrapping_mul(i64::from(periods));
        let rest = R::from_i32(((part as u32) >> 8).cast_signed()) * R::lit(1.0 / 16_777_216.0);
        let counts = self.start.counts.wrapping_add(whole).wrapping_add(part >> 32);
        Angle { counts, rest: self.start.rest + rest }
    }
}

/// floor(of/by); 0 by 0. Bit by bit: the division of 64 bits that a compiler brings is a kilobyte of code on a processor without one.
fn quotient(of: i64, by: u32) -> i64 {
    if by == 0 {
        return 0;
    }
    let (mut left, mut rest, mut quotient) = (of.unsigned_abs(), 0, 0_i64);
    for _ in 0..u64::BITS {
        rest = (rest << 1) | (left >> (u64::BITS - 1));
        left <<= 1;
        let goes = rest >= u64::from(by);
        rest -= if goes { u64::from(by) } else { 0 };
        quotient = (quotient << 1) | i64::from(goes);
    }
    if of >= 0 { quotient } else { quotient.wrapping_neg() - i64::from(rest > 0) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_quotient_is_rounded_down(of in any::<i64>(), shift in 0u32..64, by in 1..=u32::MAX) {
            prop_assert_eq!(quotient(of >> shift, by), (of >> shift).div_euclid(by.into()));
        }
    }

    #[test]
    fn nothing_is_divided_by_nothing() {
        assert_eq!([quotient(7, 0), quotient(i64::MIN, 0)], [0, 0]);
        assert_eq!(quotient(i64::MIN, 1), i64::MIN);
    }
}
