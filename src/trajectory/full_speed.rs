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
        let periods = i64::from(periods);
        let divide = |of: i64| of.checked_div_euclid(periods).unwrap_or(0);
        let whole = divide(path.counts);
        let left = path.counts.wrapping_sub(whole.wrapping_mul(periods));
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
