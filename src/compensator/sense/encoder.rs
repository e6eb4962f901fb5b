//! Encoder: from a raw count within the revolution to an unbounded angle.
//!
//! The difference of two raw counts, taken modulo a revolution, is the shortest angle between them; its sum is the
//! unbounded angle, exactly. A step that no motor can make is refused: the angle is held, and the range of the next
//! reading grows with every refused one.

use crate::angle::Angle;
use crate::constants::constants;
use crate::error::{Error, require};
use crate::real::{RADIANS_PER_COUNT, Real};

/// Parameters of an encoder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EncoderParams<R> {
    /// Resolution, counts in a revolution = 2^bits, 10..=32.
    pub bits: u32,
    /// Fastest possible speed (rad/s); below a quarter revolution per step.
    pub speed_limit: R,
}

/// A built encoder.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encoder {
    /// From raw counts to counts of 2^32 a revolution.
    shift: u32,
    /// Farthest possible step, in counts of 2^32 a revolution.
    farthest: u32,
}

/// The encoder's angle so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EncoderState {
    phase: u32,
    counts: i64,
    refused: u32,
    started: bool,
}

/// Unbounded angle and validity of a raw count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading<R> {
    /// Unbounded angle.
    pub angle: Angle<R>,
    /// Difference to the last one (rad).
    pub moved: R,
    /// The count was accepted; otherwise the angle is held.
    pub accepted: bool,
}

/// Readings that may be refused in a row before the allowed range stops growing.
const MOST_REFUSED: u32 = 1 << 12;

impl<R: Real> EncoderParams<R> {
    /// Prepares the encoder for the control period dt (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `encoder_bits` outside 10..=32, `speed_limit` unless positive and below a
    /// quarter revolution per dt.
    pub fn build(&self, dt: R) -> Result<Encoder, Error> {
        require((10..=32).contains(&self.bits), "encoder_bits")?;
        let farthest = self.speed_limit * dt;
        let quarter = R::lit(core::f64::consts::FRAC_PI_2);
        require(farthest > R::ZERO && farthest < quarter, "speed_limit")?;
        let shift = 32 - self.bits;
        let counts = (farthest * R::lit(1.0 / RADIANS_PER_COUNT)).to_i32().unsigned_abs();
        // Two readings are each rounded to a raw count.
        Ok(Encoder { shift, farthest: counts + (2 << shift) })
    }
}

impl EncoderState {
    /// Its angle.
    pub fn angle<R: Real>(&self) -> Angle<R> {
        Angle::from_counts(self.counts)
    }

    /// The last reading was accepted.
    #[inline(always)]
    pub fn is_accepted(&self) -> bool {
        self.started && self.refused == 0
    }
}

impl Encoder {
    /// Takes a raw count.
    #[inline(always)]
    pub fn step<R: Real>(&self, state: &mut EncoderState, raw: u32) -> Reading<R> {
        let phase = self.phase(raw);
        let in_range = phase >> self.shift == raw;
        if !state.started && in_range {
            *state =
                EncoderState { phase, counts: i64::from(phase.cast_signed()), refused: 0, started: true };
        }
        let delta = phase.wrapping_sub(state.phase).cast_signed();
        let accepted = in_range && self.reaches(delta.unsigned_abs(), state.refused);
        if accepted {
            state.phase = phase;
            state.counts = state.counts.wrapping_add(i64::from(delta));
            state.refused = 0;
        } else {
            state.refused = (state.refused + 1).min(MOST_REFUSED);
        }
        let counts = if accepted { delta } else { 0 };
        let moved = R::from_i32(counts) * R::lit(RADIANS_PER_COUNT);
        Reading { angle: Angle::from_counts(state.counts), moved, accepted }
    }

    /// Raw count in counts of 2^32 a revolution.
    #[inline(always)]
    pub fn phase(&self, raw: u32) -> u32 {
        raw << self.shift
    }

    /// From the last accepted count to this `phase` (counts of 2^32 a revolution) it is a possible step.
    #[inline(always)]
    pub fn is_near(&self, state: &EncoderState, phase: u32) -> bool {
        let delta = phase.wrapping_sub(state.phase).cast_signed();
        state.is_accepted() && delta.unsigned_abs() <= self.farthest
    }

    /// A step of so many counts is possible after so many refused ones.
    #[inline(always)]
    fn reaches(&self, counts: u32, refused: u32) -> bool {
        counts <= self.farthest || counts <= self.farthest.saturating_mul(1 + refused)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensator::schedule::CONTROL_PERIOD;
    use proptest::prelude::*;

    fn encoder() -> Encoder {
        EncoderParams { bits: 19, speed_limit: 700.0 }.build(CONTROL_PERIOD).unwrap()
    }

    fn raw(angle: f64) -> u32 {
        (Angle::<f64>::from_radians_f64(angle).phase()) >> 13
    }

    #[test]
    fn follows_many_revolutions_in_both_directions() {
        let mut state = EncoderState::default();
        for speed in [600.0, -600.0] {
            let start = encoder().step::<f64>(&mut state, 0).angle.to_radians();
            let steps = 20_000;
            let end = (1..=steps)
                .map(|k| {
                    encoder().step::<f64>(&mut state, raw(start + speed * CONTROL_PERIOD * f64::from(k)))
                })
                .inspect(|reading| assert!(reading.accepted))
                .last();
            let expected = start + speed * CONTROL_PERIOD * f64::from(steps);
            assert!((end.unwrap().angle.to_radians() - expected).abs() < 2e-5);
            while encoder().step::<f64>(&mut state, 0).angle.phase() != 0 {}
        }
    }

    #[test]
    fn a_jump_is_refused_and_the_angle_held_until_it_could_be_true() {
        let mut state = EncoderState::default();
        let encoder = encoder();
        let before = encoder.step::<f64>(&mut state, raw(0.1)).angle;
        let during = encoder.step::<f64>(&mut state, raw(2.0));
        assert!(!during.accepted && during.angle == before && during.moved == 0.0);
        let after = encoder.step::<f64>(&mut state, raw(0.1));
        assert!(after.accepted && after.angle == before);
        assert!(
            (0..40).any(|_| encoder.step::<f64>(&mut state, raw(2.0)).accepted),
            "a lasting value is taken"
        );
    }

    #[test]
    fn a_count_with_too_many_bits_is_refused() {
        let mut state = EncoderState::default();
        let encoder = encoder();
        encoder.step::<f64>(&mut state, 0);
        assert!(!encoder.step::<f64>(&mut state, 1 << 19).accepted);
    }

    proptest! {
        #[test]
        fn any_counts_are_total(counts in prop::collection::vec(any::<u32>(), 1..200)) {
            let mut state = EncoderState::default();
            for count in counts {
                let angle = encoder().step::<f32>(&mut state, count).angle;
                prop_assert!(angle.minus(Angle::default()).is_finite());
            }
        }
    }
}
