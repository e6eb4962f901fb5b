//! Past estimates of the output's angle, which a delayed reading is compared with.
//!
//! ```text
//! innovation = theta_o(k) - past(k - D)            D: delay of the reading
//! past(k - D + j) += c_j*innovation                j = 1..=D;   c_j = C F^j l_o,  state += F^D l_o*innovation
//! ```
//!
//! F = (1 - l_m C_m)*A is the transition of the observer's error between two readings. A correction at the reading's
//! instant has become F^j of itself j periods later, in the state as in the past, so that the error obeys the same
//! equation as without delay: as stable, and no slower but for the delay itself. Angles are phases of 2^32 counts a
//! revolution; a correction is rounded to one, 1.5e-9 rad.
//!
//! D is counted in periods of the observer, the delay rounded up; the innovation in control periods: between two
//! angles of the past is their mean.
//!
//! T. Larsen, N. Andersen, O. Ravn, N. Poulsen, "Incorporation of time delayed measurements in a discrete-time Kalman
//! filter", IEEE Conference on Decision and Control (1998).

use crate::compensator::schedule::{OBSERVER_PERIODS, SLOW_PERIODS};
use crate::real::{RADIANS_PER_COUNT, Real};

/// Longest delay of a reading (control periods).
pub const LONGEST_DELAY: usize = 16;

/// The same in periods of the observer.
pub const STEPS: usize = LONGEST_DELAY / OBSERVER_PERIODS as usize;

/// Angles that are stored: as many as the oldest reading that is used, a round old, may lie behind.
const STORED: usize = (LONGEST_DELAY + SLOW_PERIODS as usize) / OBSERVER_PERIODS as usize + 1;

/// A power of two above it: an index is masked.
const PLACES: usize = 16;

/// Estimated output angles, newest last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Past {
    phases: [u32; PLACES],
    newest: usize,
    /// Number of stored angles, up to [`STORED`].
    stored: usize,
}

impl Default for Past {
    fn default() -> Self {
        Self { phases: [0; PLACES], newest: 0, stored: 0 }
    }
}

impl Past {
    /// Adds the angle of this period.
    #[inline(always)]
    pub fn push(&mut self, phase: u32) {
        self.newest = (self.newest + 1) % PLACES;
        self.phases[self.newest] = phase;
        self.stored = (self.stored + 1).min(STORED);
    }

    /// The angle so many control periods before the newest, between two of them their mean; `None` where it is not
    /// stored.
    #[inline(always)]
    pub fn before(&self, periods: usize) -> Option<u32> {
        let steps = periods / OBSERVER_PERIODS as usize;
        let between = !periods.is_multiple_of(OBSERVER_PERIODS as usize);
        let phase = |steps: usize| self.phases[self.newest.wrapping_sub(steps) % PLACES];
        (steps + usize::from(between) < self.stored).then(|| {
            let later = phase(steps);
            let step = if between { later.wrapping_sub(phase(steps + 1)).cast_signed() } else { 0 };
            later.wrapping_sub((step >> 1).cast_unsigned())
        })
    }

    /// Corrects the angles after the one so many periods before the newest by `by[0]`, `by[1]`, ... times the
    /// innovation (rad).
    #[inline(always)]
    pub fn correct<R: Real>(&mut self, periods: usize, by: &[R; STEPS], innovation: R) {
        let counts = innovation * R::lit(1.0 / RADIANS_PER_COUNT);
        for (back, gain) in (0..periods).rev().zip(by) {
            let phase = &mut self.phases[self.newest.wrapping_sub(back) % PLACES];
            *phase = phase.wrapping_add((*gain * counts).to_i32().cast_unsigned());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stored_angles_are_found_and_none_before_the_first() {
        let mut past = Past::default();
        assert_eq!(past.before(0), None);
        for phase in 1..100 {
            // Two control periods between two of them: in between is their mean.
            past.push(2 * phase);
            for back in 0..=LONGEST_DELAY as u32 + SLOW_PERIODS {
                let expected = (2 * phase >= back + 2).then(|| 2 * phase - back);
                assert_eq!(past.before(back as usize), expected, "{back} before {phase}");
            }
        }
        assert_eq!(past.before(LONGEST_DELAY + SLOW_PERIODS as usize + 1), None);
    }

    #[test]
    fn a_correction_reaches_the_periods_after_the_reading_and_no_other() {
        let mut past = Past::default();
        (0..20).for_each(|_| past.push(u32::MAX));
        let gains = core::array::from_fn(|k| (k + 1) as f64);
        past.correct(3, &gains, 2.0 * RADIANS_PER_COUNT * (1.0 + 1e-9));
        let phases = [0, 2, 4, 6, 8].map(|back| past.before(back).unwrap());
        assert_eq!(phases, [5, 3, 1, u32::MAX, u32::MAX]);
    }
}
