//! Limit cycle of the torque: a command that keeps going from one limit of the motor to the other.
//!
//! A torque that comes back to the other limit, each time faster than a ramp from limit to limit takes, is none that a motion asks
//! for: a loop is no longer stable. After eight of them on end, [`OSCILLATIONS`] and one more there and back, the feedback functions are taken away at once
//! ([`super::supervisor`]); after as many without them the fault "limit cycle" switches the drive off, for it is the cascade that
//! oscillates: by a motor encoder that is late, or a drive that is far from what is declared. Both take 23 ms at 350 Hz and 0.13 s at
//! 60 Hz, the slowest that counts. Once a round ([`crate::compensator::schedule`]). Units: N m at the motor.

use crate::branch::seldom;
use crate::compensator::schedule::{CONTROL_PERIOD, SLOW_PERIODS};
use crate::compensator::tuned::{OSCILLATIONS, TRANSIENT_TIME};
use crate::real::Real;

/// Swings that are a limit cycle: two a period, of as many as the supervisor has windows until it acts, with the one in which they begin.
#[inline(always)]
fn largest() -> u8 {
    (2.0 * (OSCILLATIONS.get() + 1.0)) as u8
}

/// Swings of the torque from limit to limit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Swings {
    /// The torque was negative when it was last at a limit.
    negative: bool,
    /// Rounds since it came there from the other one, and swings on end.
    rounds: u8,
    count: u8,
}

impl Swings {
    /// Takes the torque command of a round, with the motor's peak torque as `limit` (N m); whether it is a limit cycle, for which
    /// as many further swings are needed then.
    #[inline(always)]
    pub fn step<R: Real>(&mut self, torque: R, limit: R) -> bool {
        let slow = TRANSIENT_TIME.periods(f64::from(SLOW_PERIODS) * CONTROL_PERIOD) as u8 + 1;
        self.rounds = (self.rounds + 1).min(slow);
        if torque.abs() < limit {
            return false;
        }
        seldom();
        let negative = torque < R::ZERO;
        if negative != self.negative {
            self.count = if self.rounds < slow { self.count + 1 } else { 1 };
            self.rounds = 0;
        }
        self.negative = negative;
        let cycles = self.count >= largest();
        if cycles {
            self.count = 0;
        }
        cycles
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::TAU;

    const PEAK: f64 = 2.4;
    const ROUND: f64 = SLOW_PERIODS as f64 * CONTROL_PERIOD;

    /// When the torque at a time (s) is a limit cycle (s); none within a second.
    fn named(torque: impl Fn(f64) -> f64) -> Option<f64> {
        let mut swings = Swings::default();
        let mut times = (0..(1.0 / ROUND) as u32).map(|k| f64::from(k) * ROUND);
        times.find(|time| swings.step(torque(*time).clamp(-PEAK, PEAK), PEAK))
    }

    fn sine(frequency: f64, amplitude: f64) -> impl Fn(f64) -> f64 {
        move |time| amplitude * PEAK * (TAU * frequency * time).sin()
    }

    /// As soon as it has so many half periods, for a frequency that a round resolves.
    #[test]
    fn a_torque_from_limit_to_limit_is_named() {
        for frequency in [70.0, 150.0, 400.0] {
            let time = named(sine(frequency, 3.0)).unwrap();
            let half = 0.5 / frequency;
            let least = f64::from(largest()) * half;
            assert!((least..least + 3.0 * half).contains(&time), "{frequency}: {time}");
        }
    }

    #[test]
    fn neither_a_smaller_nor_a_slower_torque_is_one() {
        for torque in [sine(150.0, 0.99), sine(40.0, 3.0), sine(0.0, 3.0)] {
            assert_eq!(named(torque), None);
        }
        // Noise about one limit does not reach the other.
        assert_eq!(named(|time| PEAK + sine(300.0, 0.5)(time)), None);
    }

    /// Swings before a rest do not count for those after it.
    #[test]
    fn only_swings_on_end_count() {
        let some = 0.5 * f64::from(largest() - 1) / 100.0;
        let often = move |time: f64| time % (some + 0.05);
        assert_eq!(named(|time| if often(time) < some { sine(100.0, 3.0)(often(time)) } else { 0.0 }), None);
    }
}
