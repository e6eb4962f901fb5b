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
const SHORTEST: f64 = 0.25;
const LONGEST: f64 = 16.0;

/// The built clock.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock<R> {
    dt: R,
    inverse_dt: R,
}

/// Time of one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elapsed<R> {
    /// T (s).
    pub time: R,
    /// T/dt.
    pub periods: R,
    /// dt/T.
    pub per_period: R,
    /// Square of T/dt, of at least 1.
    pub stretch: R,
}

impl<R: Real> Clock<R> {
    /// For the control period dt (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `dt` unless above 0 and up to 1.
    pub fn build(dt: R) -> Result<Self, Error> {
        require(dt > R::ZERO && dt <= R::ONE, "dt")?;
        Ok(Self { dt, inverse_dt: R::ONE / dt })
    }

    /// Time since the last step from what the board has measured (s).
    #[inline(always)]
    pub fn step(&self, measured: R, faults: &mut Faults) -> Elapsed<R> {
        if measured.is_same(self.dt) || measured.is_same(R::ZERO) {
            return Elapsed { time: self.dt, periods: R::ONE, per_period: R::ONE, stretch: R::ONE };
        }
        seldom();
        let mut time = measured;
        let mut periods = measured * self.inverse_dt;
        if !(periods >= R::lit(SHORTEST) && periods <= R::lit(LONGEST)) {
            seldom();
            faults.raise_if(true, Faults::PERIOD_OUT_OF_RANGE);
            periods = end_of_range(periods);
            time = periods * self.dt;
        }
        let whole = periods.max(R::ONE);
        Elapsed { time, periods, per_period: self.dt / time, stretch: whole * whole }
    }
}

/// In the place of a time outside the range (periods); 1 in that of one that is not finite.
fn end_of_range<R: Real>(periods: R) -> R {
    if !periods.is_finite() {
        R::ONE
    } else if periods > R::ONE {
        R::lit(LONGEST)
    } else {
        R::lit(SHORTEST)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_that_is_not_measured_is_a_control_period() {
        let (clock, mut faults) = (Clock::build(1e-4).unwrap(), Faults::NONE);
        for measured in [0.0, 1e-4] {
            let regular = Elapsed { time: 1e-4, periods: 1.0, per_period: 1.0, stretch: 1.0 };
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
