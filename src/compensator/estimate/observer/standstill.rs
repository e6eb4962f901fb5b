//! Whether the motor stands: for [`STANDSTILL`] periods its encoder has stayed within a few counts of one place, or the
//! joint has been asked to rest, and no period has taken it further from where the observer foresaw it than those
//! counts.
//!
//! Which of s and b is corrected depends on it ([`super`]), and by how much: nothing changes where nothing moves, so
//! that the gains of a motor that stands are small.

use crate::compensator::schedule::OBSERVER_PERIODS;

/// Periods of the observer without motion after which the motor stands: 20 ms.
pub const STANDSTILL: u32 = 200 / OBSERVER_PERIODS;

/// Since when, and where, the motor has not moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Standstill {
    phase: u32,
    periods: u32,
}

impl Standstill {
    /// At the zero angle for long.
    pub(super) const RESTING: Self = Self { phase: 0, periods: STANDSTILL };

    /// One more period at this phase, which was `foreseen` or not, of a joint that may be asked to rest; whether the
    /// motor moves.
    #[inline(always)]
    pub(super) fn step(&mut self, phase: u32, foreseen: bool, rests: bool, stir: u32) -> bool {
        self.periods = (self.periods + 1).min(STANDSTILL);
        let left = phase.wrapping_sub(self.phase).cast_signed().unsigned_abs() > stir;
        if left {
            self.phase = phase;
        }
        if !foreseen || left && !rests {
            self.periods = 0;
        }
        self.periods < STANDSTILL
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STIR: u32 = 40;

    /// Whether it moves after these periods, each a way back or forth.
    fn moves(standstill: &mut Standstill, periods: u32, way: u32, foreseen: bool, rests: bool) -> bool {
        let mut step = |k: u32| standstill.step(1000 + way * (k % 2), foreseen, rests, STIR);
        (0..periods).map(&mut step).last().unwrap()
    }

    #[test]
    fn a_motor_stands_after_a_while_at_one_place() {
        let mut standstill = Standstill { phase: 1000, periods: 0 };
        assert!(moves(&mut standstill, STANDSTILL - 1, STIR, true, false));
        assert!(!moves(&mut standstill, 1, STIR, true, false));
        assert!(moves(&mut standstill, 2, STIR + 1, true, false));
    }

    #[test]
    fn one_that_is_asked_to_rest_stands_wherever_it_creeps_to() {
        let mut standstill = Standstill { phase: 1000, periods: 0 };
        assert!(moves(&mut standstill, STANDSTILL - 1, STIR + 1, true, true));
        assert!(!moves(&mut standstill, 1, STIR + 1, true, true));
        assert!(moves(&mut standstill, 2, STIR + 1, true, false));
    }

    #[test]
    fn what_was_not_foreseen_is_a_motion() {
        let mut standstill = Standstill { phase: 1000, periods: STANDSTILL };
        assert!(!moves(&mut standstill, 1, 0, true, true));
        assert!(moves(&mut standstill, 1, 0, false, true));
        assert!(moves(&mut standstill, STANDSTILL - 1, 0, true, true));
        assert!(!moves(&mut standstill, 1, 0, true, true));
    }
}
