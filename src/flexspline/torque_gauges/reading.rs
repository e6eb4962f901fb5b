//! A reading of the gauges, and how an observer takes it.
//!
//! ```text
//! tau_s = tau_t + w*(tau - tau_t)          w = sd_0^2/max(sd_0^2, sd^2)
//! ```
//!
//! tau and sd are torque and standard deviation of the reading, tau_t what the observer expects of it (N m), sd_0 the deviation for
//! which its gains are. An observer with constant gains corrects by l*(tau_s - tau_t): with tau_s in the place of tau its gain is l*w, as
//! that of a Kalman filter falls with the variance of a reading while the prediction's is much smaller. So gauges that have not
//! yet learnt, or that disagree, move it little. No state.

use crate::real::Real;

/// A reading of all gauges.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GaugeTorque<R> {
    /// Torque through the shell (N m), within [`RANGE`](crate::flexspline::reduced::RANGE) times the rated torque.
    pub torque: R,
    /// Its standard deviation (N m).
    pub standard_deviation: R,
}

impl<R: Real> GaugeTorque<R> {
    /// The torque for an observer that expects `expected` (N m) and has gains for the deviation `designed` (N m, positive).
    #[inline]
    pub fn for_observer(&self, designed: R, expected: R) -> R {
        let (design, variance) = (designed * designed, self.standard_deviation * self.standard_deviation);
        expected + design / design.max(variance) * (self.torque - expected)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The share of the reading is the ratio of the variances, and 1 for one that is as good as designed for.
        #[test]
        fn an_uncertain_reading_is_drawn_to_what_is_expected(
            torque in -300.0..300.0f64,
            expected in -300.0..300.0f64,
            standard_deviation in 0.0..300.0f64,
            designed in 0.1..10.0f64,
        ) {
            let reading = GaugeTorque { torque, standard_deviation };
            let taken = reading.for_observer(designed, expected);
            let share = (designed / standard_deviation).powi(2).min(1.0);
            prop_assert!((taken - expected - share * (torque - expected)).abs() < 1e-9);
            if standard_deviation <= designed {
                prop_assert!((taken - torque).abs() < 1e-12 * 600.0);
            }
        }
    }
}
