//! Motor encoder: a count is accepted within the range that the motor can reach.
//!
//! ```text
//! predicted = theta + dtheta*T           a reading is accepted within  (a*dt^2 + 13 counts)*m^2 + |dtheta*T|/16  of it
//! m = max(T/dt, 1) + refused readings since the last accepted one
//! a = 1.5*(tau_max + 2*tau_p/|n| + tau_s)/J_wg
//! ```
//!
//! dtheta is from the last readings, T the time since the last step, dt the control period. a is the acceleration of the rotor alone by the largest torques of motor, gear (twice its peak rating)
//! and friction, with half as much again for their uncertainty; the sixteenth of the step is for an unmeasured clock; 13 counts are the noise
//! of a reading, which a slow rotor with a coarse encoder shows more than its acceleration. A
//! refused reading is replaced by the predicted one, so that single bad frames do not disturb the joint. Counts are
//! within the revolution, so that the first accepted reading after a few refused ones gives the right angle. A reading that goes
//! on from the refused one before it, at the joint's speed within half of a period's range or at none at all, is refused too,
//! wherever it lies: an encoder that has jumped or stands still does not come into range because range grows. The second
//! reading of all may be anywhere that the motor's fastest speed admits: a joint that moves when its controller starts has its
//! speed from two readings.
//!
//! Error counter: +40 for a refused reading, -4 for an accepted one: a reading in eleven may be bad. At 800, 2 ms of bad
//! frames, the angle is lost and the next valid count begins a new one, which is used after a reset only.

use core::mem::offset_of;

use crate::angle::Angle;
use crate::compensator::schedule::CONTROL_PERIOD;
use crate::compensator::sense::clock::Elapsed;
use crate::compensator::sense::encoder::Reading;
use crate::compensator::sense::pulleys::Pulleys;
use crate::compensator::tuned::{FAULT_TIME, RECOVERY, UNCERTAINTY_MARGIN};
use crate::compensator::{Faults, Limits};
use crate::constants::constants;
use crate::error::{Error, require};
use crate::gear::GearParams;
use crate::real::{RADIANS_PER_COUNT, Real};

/// The error counter after the first reading, which the next one confirms. It is odd then and at no other time: increment and
/// decrement are even.
const UNCONFIRMED: u32 = 1;

/// Noise of a reading about the predicted one, in counts, of one period: readings that are rounded and have a count's noise besides, each of
/// the variance 1 + 1/12, and their second difference the sixfold, deviate by five standard deviations once in a million and a half.
/// After m periods, over which the last difference is carried on, they deviate by less than m^2 times as much.
const NOISE: f64 = 13.0;

/// Increment of the error counter by a refused reading: so large that the decrement is even with half of its factor, too.
const ERROR_INCREMENT: u32 = 40;

/// Decrement of the error counter by an accepted reading.
#[inline(always)]
fn error_decrement() -> u32 {
    (f64::from(ERROR_INCREMENT) * RECOVERY.get()) as u32
}

/// Error count at which the angle is lost.
#[inline(always)]
fn error_count_limit() -> u32 {
    ERROR_INCREMENT * FAULT_TIME.periods(CONTROL_PERIOD)
}

/// [`NOISE`] of an encoder whose raw counts are shifted by so much, in counts of 2^32 a revolution.
fn noise<R: Real>(shift: u32) -> R {
    R::lit(NOISE) * R::from_i32(1 << shift)
}

/// The built encoder.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorEncoder<R> {
    /// From raw counts to counts of 2^32 a revolution.
    shift: u32,
    /// a*dt^2 with the noise, and the fastest speed times dt, in counts of 2^32 a revolution.
    reach: R,
    fastest: R,
    /// Speed of one count in a control period (rad/s).
    speed_of_count: R,
}

/// Foreseen change of the angle since the last reading, and how far from it a count may lie, in counts.
struct Foreseen<R> {
    moved: i32,
    reach: R,
}

/// The encoder's angle so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotorEncoderState<R> {
    phase: u32,
    counts: i64,
    /// Counts in a control period.
    step: R,
    refused: u32,
    /// The last reading, where it was sound and refused.
    refused_phase: Option<u32>,
    error_count: u32,
    started: bool,
    /// The last reading was accepted.
    accepted: bool,
}

impl<R: Real> MotorEncoderState<R> {
    /// The last reading was accepted.
    #[inline(always)]
    pub fn is_accepted(&self) -> bool {
        self.accepted
    }

    /// Its angle.
    pub fn angle(&self) -> Angle<R> {
        Angle::from_counts(self.counts)
    }
}

impl<R: Real> MotorEncoder<R> {
    /// For 2^bits counts a revolution of a motor with these limits, and the control period dt (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `encoder_bits` outside 10..=32.
    pub fn build(bits: u32, gear: &GearParams<R>, limits: &Limits<R>, dt: R) -> Result<Self, Error> {
        require((10..=32).contains(&bits), "encoder_bits")?;
        let gear_torque = R::lit(2.0) * limits.output_torque / R::from_i32(gear.ratio).abs();
        let torque = limits.motor_torque + gear_torque + gear.input_friction.largest_level();
        let acceleration = R::lit(UNCERTAINTY_MARGIN.get()) * torque / gear.wave_generator_inertia;
        let counts = |angle: R| angle * R::lit(1.0 / RADIANS_PER_COUNT);
        let shift = 32 - bits;
        Ok(Self {
            shift,
            reach: counts(acceleration * dt * dt) + noise(shift),
            fastest: counts(limits.motor_speed * dt),
            speed_of_count: R::lit(RADIANS_PER_COUNT) * (R::ONE / dt),
        })
    }

    /// The same in front of a belt: the motor's acceleration is not the wave generator's.
    #[must_use]
    pub fn in_front_of(self, pulleys: &Pulleys<R>) -> Self {
        if !pulleys.are_present() {
            return self;
        }
        let ratio = pulleys.ratio();
        Self {
            reach: (self.reach - noise(self.shift)) / ratio + noise(self.shift),
            fastest: self.fastest / ratio,
            speed_of_count: ratio * self.speed_of_count,
            ..self
        }
    }

    /// Where the shift lies in memory, in bytes.
    pub(crate) const SHIFT_OFFSET: usize = offset_of!(Self, shift);

    /// Resolution: 2^bits counts a revolution.
    pub fn bits(&self) -> u32 {
        Self::bits_of(self.shift)
    }

    /// Resolution that this shift brings to 2^32 counts a revolution.
    pub(crate) const fn bits_of(shift: u32) -> u32 {
        32 - shift
    }

    /// Speed of the motor, or in front of a belt of the wave generator, in the last control period (rad/s).
    #[inline(always)]
    pub fn speed(&self, state: &MotorEncoderState<R>) -> R {
        state.step * self.speed_of_count
    }

    /// Takes a raw count whose frame was `valid`; the second value: it is accepted, as the one before it was.
    #[inline(always)]
    pub fn step(
        &self,
        state: &mut MotorEncoderState<R>,
        raw: u32,
        valid: bool,
        elapsed: &Elapsed<R>,
        faults: &mut Faults,
    ) -> (Reading<R>, bool) {
        let phase = raw << self.shift;
        let sound = valid && phase >> self.shift == raw;
        let delta = phase.wrapping_sub(state.phase).cast_signed();
        let foreseen = self.foreseen(state, elapsed.periods, elapsed.stretch);
        if !(sound && state.accepted && foreseen.admits(delta)) {
            return (self.irregular(state, phase, sound, elapsed, faults), false);
        }
        state.step = elapsed.per_period * R::from_i32(delta);
        state.error_count = state.error_count.saturating_sub(error_decrement());
        (state.reading(phase, delta, true), true)
    }

    /// What is foreseen after so many periods, where the reach by acceleration is `stretch` times that of one.
    #[inline(always)]
    fn foreseen(&self, state: &MotorEncoderState<R>, periods: R, stretch: R) -> Foreseen<R> {
        let moved = periods * state.step;
        let reach = stretch * self.reach + R::lit(1.0 / 16.0) * moved.abs();
        Foreseen { moved: moved.to_i32(), reach }
    }

    /// A reading goes on from the refused one before it, by the foreseen motion within half of the reach, or not at all.
    #[inline(always)]
    fn goes_on(&self, state: &MotorEncoderState<R>, phase: u32, elapsed: &Elapsed<R>) -> bool {
        let foreseen = self.foreseen(state, elapsed.periods, R::lit(0.5) * elapsed.stretch);
        state.refused_phase.is_some_and(|refused| {
            let moved = phase.wrapping_sub(refused).cast_signed();
            moved == 0 || foreseen.admits(moved)
        })
    }

    /// The first reading, a second that shows a motion, one that is refused, or the first after one that was.
    #[cold]
    #[inline(never)]
    fn irregular(
        &self,
        state: &mut MotorEncoderState<R>,
        phase: u32,
        sound: bool,
        elapsed: &Elapsed<R>,
        faults: &mut Faults,
    ) -> Reading<R> {
        if !state.started && sound {
            let counts = i64::from(phase.cast_signed());
            *state = MotorEncoderState {
                phase,
                counts,
                error_count: UNCONFIRMED,
                started: true,
                accepted: true,
                ..MotorEncoderState::default()
            };
            return state.reading(phase, 0, true);
        }
        // Since the last reading that was accepted.
        let periods = elapsed.periods.max(R::ONE) + R::from_i32(state.refused.cast_signed());
        let mut foreseen = self.foreseen(state, elapsed.periods, periods * periods);
        let delta = phase.wrapping_sub(state.phase).cast_signed();
        if state.error_count == UNCONFIRMED {
            foreseen.reach += periods * self.fastest;
        }
        let goes_on = self.goes_on(state, phase, elapsed);
        state.accepted = sound && state.started && !goes_on && foreseen.admits(delta);
        if state.accepted {
            state.step += R::from_i32(delta.wrapping_sub(foreseen.moved)) / periods;
            (state.refused, state.refused_phase) = (0, None);
            state.error_count = state.error_count.saturating_sub(error_decrement());
            return state.reading(phase, delta, true);
        }
        faults.raise_if(true, Faults::MOTOR_ENCODER_JUMP);
        state.refused = state.refused.saturating_add(1);
        state.refused_phase = sound.then_some(phase);
        state.error_count = (state.error_count & !UNCONFIRMED) + ERROR_INCREMENT;
        if state.error_count >= error_count_limit() {
            faults.raise_if(true, Faults::MOTOR_ENCODER_LOST);
            let counts = state.counts;
            *state = MotorEncoderState { counts, ..MotorEncoderState::default() };
            return state.reading(0, 0, false);
        }
        let moved = if state.started { foreseen.moved } else { 0 };
        state.reading(state.phase.wrapping_add(moved.cast_unsigned()), moved, false)
    }
}

impl<R: Real> Foreseen<R> {
    /// A reading may have moved by so many counts.
    #[inline(always)]
    fn admits(&self, moved: i32) -> bool {
        R::from_i32(moved.wrapping_sub(self.moved)).is_within(self.reach)
    }
}

impl<R: Real> MotorEncoderState<R> {
    #[inline(always)]
    fn reading(&mut self, phase: u32, moved: i32, accepted: bool) -> Reading<R> {
        self.phase = phase;
        self.counts = self.counts.wrapping_add(i64::from(moved));
        let moved = R::from_i32(moved) * R::lit(RADIANS_PER_COUNT);
        Reading { angle: Angle::from_counts(self.counts), moved, accepted }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensator::schedule::CONTROL_PERIOD;
    use crate::compensator::sense::clock::Clock;
    use proptest::prelude::*;
    use std::vec::Vec;

    const BITS: u32 = 19;
    const COUNT: f64 = core::f64::consts::TAU / (1u32 << BITS) as f64;

    /// 1.4e5 rad/s^2.
    fn encoder() -> MotorEncoder<f64> {
        MotorEncoder {
            shift: 32 - BITS,
            reach: 1.4e5 * CONTROL_PERIOD * CONTROL_PERIOD / RADIANS_PER_COUNT
                + NOISE * f64::from(1 << (32 - BITS)),
            fastest: 586.0 * CONTROL_PERIOD / RADIANS_PER_COUNT,
            speed_of_count: RADIANS_PER_COUNT / CONTROL_PERIOD,
        }
    }

    fn count(angle: f64) -> u32 {
        ((angle / COUNT).round() as i64 as u32) & ((1 << BITS) - 1)
    }

    fn elapsed(periods: f64) -> Elapsed<f64> {
        Clock::build(CONTROL_PERIOD).unwrap().step(periods * CONTROL_PERIOD, &mut Faults::NONE.clone())
    }

    fn on_time() -> Elapsed<f64> {
        elapsed(1.0)
    }

    /// Angles accepted after each reading.
    fn go(
        state: &mut MotorEncoderState<f64>,
        angles: impl IntoIterator<Item = u32>,
    ) -> Vec<(f64, bool, bool)> {
        let encoder = encoder();
        angles
            .into_iter()
            .map(|raw| {
                let mut faults = Faults::NONE;
                let (reading, _) = encoder.step(state, raw, true, &on_time(), &mut faults);
                assert_ne!(reading.accepted, faults.contains(Faults::MOTOR_ENCODER_JUMP));
                (reading.angle.to_radians(), reading.accepted, faults.contains(Faults::MOTOR_ENCODER_LOST))
            })
            .collect()
    }

    /// A rotor that no torque accelerates by a count in a period, at rest, its readings rounded and with the noise of a count.
    #[test]
    fn noise_of_a_count_is_no_jump() {
        let noise = f64::from(1 << (32 - BITS));
        let encoder = MotorEncoder { reach: NOISE * noise, ..encoder() };
        let (mut state, mut seed) = (MotorEncoderState::default(), 1u32);
        // Twelve uniform numbers have the variance 1.
        let mut uniform = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(seed >> 8) / f64::from(1 << 24)
        };
        let mut step = |from: f64| {
            let noise = (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
            let raw = (from + noise).round() as u32;
            encoder.step(&mut state, raw, true, &on_time(), &mut Faults::NONE.clone()).0.accepted
        };
        assert!((0..100_000).all(|_| step(1000.0)));
        assert!(!step(1040.0));
    }

    /// As fast as a motor turns up, 5e4 rad/s^2 to 500 rad/s and back.
    #[test]
    fn a_motion_is_accepted() {
        let angle = |k: i32| {
            let t = CONTROL_PERIOD * f64::from(k);
            if t < 0.01 { 2.5e4 * t * t } else { 2.5 + 500.0 * (t - 0.01) - 2.5e4 * (t - 0.01).powi(2) }
        };
        let mut state = MotorEncoderState::default();
        for (k, (at, accepted, _)) in (0..200).zip(go(&mut state, (0..200).map(|k| count(angle(k))))) {
            assert!(accepted && (at - angle(k)).abs() < COUNT, "{k}: {at}");
        }
    }

    #[test]
    fn a_bad_frame_is_replaced_by_the_predicted_count() {
        let mut state = MotorEncoderState::default();
        let angle = |k: i32| 1e-3 * f64::from(k);
        go(&mut state, [0, count(1e-3)]);
        let seen = go(&mut state, (2..20).map(|k| if k == 10 { 0x2aaaa } else { count(angle(k)) }));
        for (k, (at, accepted, lost)) in (2..20).zip(seen) {
            assert_eq!((accepted, lost), (k != 10, false), "{k}");
            assert!((at - angle(k)).abs() < 4.0 * COUNT, "{k}: {at}");
        }
    }

    /// A joint that moves when its controller starts has its angle and speed at once, unless it is faster than it can be.
    #[test]
    fn a_motion_that_has_begun_is_accepted() {
        for (speed, possible) in [(-580.0, true), (300.0, true), (900.0, false)] {
            let angle = |k: i32| 0.3 + speed * CONTROL_PERIOD * f64::from(k);
            let seen = go(&mut MotorEncoderState::default(), (0..5).map(|k| count(angle(k))));
            for (k, (at, accepted, _)) in (0..5).zip(seen) {
                assert_eq!(accepted, possible || k == 0, "{speed} {k}");
                assert!(!accepted || (at - angle(k)).abs() < COUNT, "{speed} {k}: {at}");
            }
        }
    }

    #[test]
    fn two_milliseconds_of_bad_frames_lose_the_angle() {
        let mut state = MotorEncoderState::default();
        go(&mut state, [0; 5]);
        let seen = go(&mut state, [1 << 18; 22]);
        assert_eq!(seen.iter().position(|(_, _, lost)| *lost), Some(19));
        assert!(seen[20].1, "and begins anew");
    }

    /// The range grows with every refused reading, up to 0.5 rad. Neither a count that has jumped by less comes into it, nor one that
    /// no longer changes at speed: both are lost after 2 ms.
    #[test]
    fn a_count_that_jumps_or_stands_still_is_lost() {
        for (speed, jump) in [(0.0, 5e-3), (0.0, -0.3), (200.0, 0.02), (-200.0, 0.3), (400.0, 0.1)] {
            let angle = |k: i32| speed * CONTROL_PERIOD * f64::from(k);
            let mut state = MotorEncoderState::default();
            go(&mut state, (0..50).map(|k| count(angle(k))));
            let seen = go(&mut state, (50..70).map(|k| count(angle(k) + jump)));
            assert!(seen.iter().all(|(_, accepted, _)| !accepted) && seen[19].2, "{speed} {jump}");
        }
        for speed in [50.0, -100.0, 300.0] {
            let angle = |k: i32| speed * CONTROL_PERIOD * f64::from(k);
            let mut state = MotorEncoderState::default();
            go(&mut state, (0..50).map(|k| count(angle(k))));
            let seen = go(&mut state, [count(angle(49)); 20]);
            assert!(seen.iter().all(|(_, accepted, _)| !accepted) && seen[19].2, "{speed}");
        }
    }

    /// A bit that is stuck spoils a reading now and then. One in 20 is borne for a second, one in 8 for 53 ms.
    #[test]
    fn bad_frames_that_come_again_and_again_lose_the_angle() {
        for (every, lost) in [(20, None), (8, Some(0.06))] {
            let seen = go(
                &mut MotorEncoderState::default(),
                (0..10_000).map(|k| if k % every == 5 { 1 << 18 } else { 0 }),
            );
            let found = seen.iter().position(|(_, _, lost)| *lost).map(|k| k as f64 * CONTROL_PERIOD);
            assert!(found.is_some() == lost.is_some() && found <= lost, "{every}: {found:?}");
        }
    }

    /// A period that is late is no jump.
    #[test]
    fn a_late_reading_is_predicted_by_the_elapsed_time() {
        let (encoder, mut state) = (encoder(), MotorEncoderState::default());
        let mut angle = 0.0;
        for k in 0..50 {
            let periods = if k > 0 && k % 7 == 0 { 3.0 } else { 1.0 };
            let speed = (k as f64 * 10.0f64).min(400.0);
            angle += speed * CONTROL_PERIOD * periods;
            let mut faults = Faults::NONE;
            let (reading, usual) =
                encoder.step(&mut state, count(angle), true, &elapsed(periods), &mut faults);
            assert!(reading.accepted && faults == Faults::NONE, "{k}");
            assert_eq!(usual, k > 0, "only the first one is not");
        }
    }

    proptest! {
        #[test]
        fn any_counts_and_times(raws in prop::collection::vec((any::<u32>(), any::<bool>(), 0.25..16.0f64), 1..200)) {
            let (encoder, mut state) = (encoder(), MotorEncoderState::default());
            for (raw, valid, periods) in raws {
                let (reading, _) = encoder.step(&mut state, raw, valid, &elapsed(periods), &mut Faults::NONE.clone());
                prop_assert!(reading.moved.is_finite());
            }
        }
    }
}
