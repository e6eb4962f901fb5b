//! Clock: time from one step to the next, as measured by the board.
//!
//! ```text
//! T = elapsed where dt/4 <= elapsed <= 16*dt,   T = dt where it is not measured (0)
//! ```
//!
//! dt is the control period (s). Late and missed steps are inputs: speeds are differences over T, references and
//! observer advance by T. A time outside the range means that the control has stood still: it is reported, and T is the
//! end of the range. Units: s.

use crate::branch::seldom;
use crate::compensator::Faults;
use crate::constants::constants;
use crate::error::{Error, require};
use crate::real::Real;

/// Shortest and longest time between two steps, in control periods.
const RANGE: [f64; 2] = [0.25, 16.0];

/// The built clock.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock<R> {
    dt: R,
    inverse_dt: R,
    shortest: R,
    longest: R,
}

/// Time of one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elapsed<R> {
    /// T (s).
    pub time: R,
    /// 1/T (1/s).
    pub inverse: R,
    /// T is dt.
    pub regular: bool,
}

impl<R: Real> Clock<R> {
    /// For the control period dt (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `dt` unless above 0 and up to 1.
    pub fn build(dt: R) -> Result<Self, Error> {
        require(dt > R::ZERO && dt <= R::ONE, "dt")?;
        let [shortest, longest] = RANGE.map(|periods| R::lit(periods) * dt);
        Ok(Self { dt, inverse_dt: R::ONE / dt, shortest, longest })
    }

    /// Time since the last step from what the board has measured (s).
    #[inline(always)]
    pub fn step(&self, measured: R, faults: &mut Faults) -> Elapsed<R> {
        if measured == self.dt || measured == R::ZERO {
            return Elapsed { time: self.dt, inverse: self.inverse_dt, regular: true };
        }
        seldom();
        let possible = measured >= self.shortest && measured <= self.longest;
        faults.raise_if(!possible, Faults::PERIOD_OUT_OF_RANGE);
        let time = if possible { measured } else { self.end_of_range(measured) };
        Elapsed { time, inverse: R::ONE / time, regular: false }
    }

    /// In the place of a time outside the range; dt in that of one that is not finite.
    #[inline(always)]
    fn end_of_range(&self, measured: R) -> R {
        if !measured.is_finite() {
            self.dt
        } else if measured > self.longest {
            self.longest
        } else {
            self.shortest
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_that_is_not_measured_is_a_control_period() {
        let (clock, mut faults) = (Clock::build(1e-4).unwrap(), Faults::NONE);
        for measured in [0.0, 1e-4] {
            let regular = Elapsed { time: 1e-4, inverse: 1.0 / 1e-4, regular: true };
            assert_eq!(clock.step(measured, &mut faults), regular);
        }
        assert_eq!(clock.step(2e-4, &mut faults).time, 2e-4);
        assert_eq!(faults, Faults::NONE);
    }

    #[test]
    fn an_impossible_time_is_limited_and_reported() {
        let clock = Clock::build(1e-4).unwrap();
        for (measured, time) in [(1.0, 16e-4), (-1.0, 0.25e-4), (f64::NAN, 1e-4), (f64::INFINITY, 1e-4)] {
            let mut faults = Faults::NONE;
            assert!((clock.step(measured, &mut faults).time - time).abs() < 1e-18);
            assert!(faults.contains(Faults::PERIOD_OUT_OF_RANGE));
        }
    }
}
