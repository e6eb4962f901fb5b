//! Standstill of the motor: for [`SETTLED_TIME`] its encoder has stayed within the motion threshold of one angle,
//! or rest has been commanded, and in no period its prediction error has exceeded the motion threshold.
//!
//! It selects which of s and b is corrected ([`super`]), and the gains: those of a motor that stands are small.

use crate::compensator::schedule::{CONTROL_PERIOD, OBSERVER_PERIODS};
use crate::compensator::tuned::SETTLED_TIME;

/// Periods of the observer without motion after which the motor stands.
#[inline(always)]
fn standstill_periods() -> u32 {
    SETTLED_TIME.periods(OBSERVER_PERIODS as f64 * CONTROL_PERIOD)
}

/// Phase at which the motor stands, and the periods since it moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Standstill {
    phase: u32,
    periods: u32,
}

impl Standstill {
    /// At rest at the zero angle.
    pub(super) fn resting() -> Self {
        Self { phase: 0, periods: standstill_periods() }
    }

    /// Whether the motor moves, after one more period at this phase, which was `predicted` within the threshold or not;
    /// `rests`: rest is commanded.
    #[inline(always)]
    pub(super) fn step(&mut self, phase: u32, predicted: bool, rests: bool, motion_threshold: u32) -> bool {
        self.periods = (self.periods + 1).min(standstill_periods());
        let left = phase.wrapping_sub(self.phase).cast_signed().unsigned_abs() > motion_threshold;
        if left {
            self.phase = phase;
        }
        if !predicted || left && !rests {
            self.periods = 0;
        }
        self.periods < standstill_periods()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const THRESHOLD: u32 = 40;

    /// Whether it moves after these periods, each a displacement back or forth.
    fn moves(standstill: &mut Standstill, periods: u32, step: u32, predicted: bool, rests: bool) -> bool {
        let mut step = |k: u32| standstill.step(1000 + step * (k % 2), predicted, rests, THRESHOLD);
        (0..periods).map(&mut step).last().unwrap()
    }

    #[test]
    fn a_motor_stands_after_20_ms_at_one_angle() {
        let mut standstill = Standstill { phase: 1000, periods: 0 };
        assert!(moves(&mut standstill, standstill_periods() - 1, THRESHOLD, true, false));
        assert!(!moves(&mut standstill, 1, THRESHOLD, true, false));
        assert!(moves(&mut standstill, 2, THRESHOLD + 1, true, false));
    }

    #[test]
    fn with_rest_commanded_it_stands_though_it_creeps() {
        let mut standstill = Standstill { phase: 1000, periods: 0 };
        assert!(moves(&mut standstill, standstill_periods() - 1, THRESHOLD + 1, true, true));
        assert!(!moves(&mut standstill, 1, THRESHOLD + 1, true, true));
        assert!(moves(&mut standstill, 2, THRESHOLD + 1, true, false));
    }

    #[test]
    fn a_prediction_error_is_a_motion() {
        let mut standstill = Standstill { phase: 1000, periods: standstill_periods() };
        assert!(!moves(&mut standstill, 1, 0, true, true));
        assert!(moves(&mut standstill, 1, 0, false, true));
        assert!(moves(&mut standstill, standstill_periods() - 1, 0, true, true));
        assert!(!moves(&mut standstill, 1, 0, true, true));
    }
}
