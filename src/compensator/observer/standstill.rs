//! Whether the motor stands: its encoder has stayed within a few counts of one place for [`STANDSTILL`] periods.
//!
//! Which of s and b is corrected depends on it ([`super`]). A way from there beyond those counts is a motion, and its
//! end the new place.

use crate::compensator::turns::OBSERVED;

/// Periods of the observer without motion after which the motor stands: 20 ms.
pub const STANDSTILL: u32 = 200 / OBSERVED;

/// Since when, and where, the motor has not moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Standstill {
    phase: u32,
    periods: u32,
}

impl Standstill {
    /// At the zero angle for long.
    pub(super) const RESTING: Self = Self { phase: 0, periods: STANDSTILL };

    /// One more period at this phase; whether the motor moves.
    #[inline(always)]
    pub(super) fn step(&mut self, phase: u32, stir: u32) -> bool {
        self.periods = (self.periods + 1).min(STANDSTILL);
        if phase.wrapping_sub(self.phase).cast_signed().unsigned_abs() > stir {
            *self = Self { phase, periods: 0 };
        }
        self.periods < STANDSTILL
    }
}
