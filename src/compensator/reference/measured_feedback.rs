//! Output feedback by the measured angle, in every second control period: P and D of the output encoder's angle shift the motor's
//! reference. It runs in those without the observer; in every period m goes on by -dq.
//!
//! ```text
//! m      = theta_o(t - T_d) - q(t - T_d),   q extrapolated by dq from the feed-forward's slot on
//! m_h    = m in slow motion; at rest it follows m with a play of a count, so that |m - m_h| <= h
//! m_f    = one pole at omega_m on Z(m_h)
//! shift  = -(P*Z(m) + D*dm_f/dt), no larger than s_max
//! Z(u)   = u in slow motion, at rest what exceeds 1.5 counts of u, 0 in a fast move
//! ```
//!
//! T_d is by how much the reading is late; between two readings m is extrapolated by -dq. The shift, at the motor, is
//! added to its position error, not to the speed of its reference. P and D have gains of their own at rest.
//!
//! With a motor that follows, the load on its spring obeys J_fs*e'' = K*(shift - e): P stiffens the joint by 1 + P, D damps
//! the torsion mode of frequency omega = sqrt(K/J_fs) by the ratio D*omega/2. Through a motor with a delay T, P is a
//! negative damping P*omega*T/2, which D outweighs. Both act on the angle as it is read, not on an estimate, so that they do
//! not depend on the model. In a fast move they do not act: they would excite the flexible mode of a load.
//!
//! At rest they do not act on the rounding and a count of noise, which they would convert to torque. About the setpoint Z hides
//! both. A joint that rests beyond it, in static friction or under a load that is not yet integrated, would still turn each
//! change of a count into a pulse of D; the play hides these, wherever the joint rests. It stores no energy: m_h moves only with
//! m, and in its direction, so that the power of D, K*D*(dm_h/dt)*(dm/dt), never excites the load whose motor follows; P
//! acts on m itself, without the play, whose lag would make of it a negative damping. What the play leaves undamped is a
//! vibration of less than a count. The side of Z that P acts beyond, or that it does not act, is set once a round.
//!
//! A motor at its torque's limit follows late: with P and D in proportion to any error, a load step could keep a light joint
//! swinging, its motor from limit to limit. So a shift is bounded, and a larger error has less gain, down to the cascade's alone.
//!
//! The mean of m over a round is for who integrates it ([`super::output_feedback`]): one reading of each round, at a speed
//! that is a multiple of a count a round, would be off by the same part of a count each time.
//!
//! A count further from the last one than the fastest joint moves between two steps is refused; m is held, and the next slot of the
//! feed-forward starts from the last accepted reading. Discretisation: the pole exactly for an m that is constant over
//! two control periods, dm_f/dt by backward differences; the play in whole parts of a revolution of 2^32. Units: rad, s; signs as
//! in [`crate::gear`].
//!
//! A. De Luca, W. Book, "Robots with flexible elements", Springer Handbook of Robotics (2016), chapter 11.

use crate::compensator::schedule::{OBSERVER_PERIODS, SLOW_PERIODS};
use crate::compensator::tuned::ENCODER_NOISE;
use crate::constants::constants;
use crate::error::{Error, require};
use crate::low_pass::LowPass;
use crate::real::{RADIANS_PER_COUNT, Real};

/// Steps in a round.
const STEPS: u32 = SLOW_PERIODS / OBSERVER_PERIODS;

/// Largest rounding of a reading, in counts.
const ROUNDING: f64 = 0.5;

/// Gains of the measured angle; all zero for none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeasuredFeedbackParams<R> {
    /// P in slow motion, 0..=1.
    pub proportional: R,
    /// P at rest, 0..=1.
    pub proportional_at_rest: R,
    /// D in slow motion (s), 0..=1.
    pub derivative: R,
    /// D at rest (s), 0..=1.
    pub derivative_at_rest: R,
    /// omega_m (rad/s), 0..=1e5.
    pub corner: R,
    /// Largest shift, above 0 (rad at the motor).
    pub largest_shift: R,
}

/// The built feedback.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredFeedback<R> {
    low_pass: LowPass<R>,
    /// P, and D over the time between two steps, in slow motion and at rest.
    proportional: [R; 2],
    derivative: [R; 2],
    /// Half width of the dead zone of Z at rest (rad).
    dead_zone: R,
    /// h at rest, in counts of 2^32 a revolution.
    play: i32,
    /// Largest shift (rad at the motor).
    largest_shift: R,
    /// Farthest motion between two steps, in counts of 2^32 a revolution.
    farthest: i32,
    dt: R,
}

/// m, m_f, and the reading that m is continued from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeasuredFeedbackState<R> {
    /// Last accepted reading, counts of 2^32 a revolution.
    phase: u32,
    /// m and m_f (rad).
    error: R,
    filtered: R,
    /// dq (rad/s).
    velocity: R,
    /// Half width of the dead zone (rad); larger than any m where the feedback does not act.
    dead_zone: R,
    /// h, and m - m_h, -h..=h (counts of 2^32 a revolution).
    play: i32,
    within_play: i32,
    /// Bound of Z's dead zone that m lies beyond in this round (rad), 0 in motion.
    bound: R,
    /// -P, 0 where m lies within the dead zone, and -D over the time between two steps, times the gain from the output's angle to the motor's.
    proportional: R,
    derivative: R,
    /// Sum of m over the steps of the round (rad).
    sum: R,
    /// Shift of the motor's reference (rad at the motor).
    shift: R,
}

/// Measured error in the feed-forward's slot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredError<R> {
    /// Accepted reading, counts of 2^32 a revolution.
    pub phase: u32,
    /// m (rad).
    pub error: R,
}

impl<R: Real> MeasuredFeedbackState<R> {
    /// Takes a reading, which moves m_h as far as it leaves the play.
    #[inline(always)]
    fn read(&mut self, phase: u32) {
        let counts = phase.wrapping_sub(self.phase).cast_signed();
        self.phase = phase;
        self.within_play = self.within_play.saturating_add(counts).min(self.play).max(-self.play);
    }

    /// Shift of the motor's reference in the next control period, which takes `elapsed` (s), by the last step (rad at the motor).
    #[inline(always)]
    pub fn advance(&mut self, elapsed: R) -> R {
        self.error -= elapsed * self.velocity;
        self.shift
    }

    /// Leaves the next step out of the mean: the round has one more, for a slot that waits.
    #[inline(always)]
    pub fn leave_out(&mut self) {
        self.sum -= self.error;
    }
}

impl<R: Real> MeasuredFeedback<R> {
    /// From the gains, the output's fastest speed (rad/s), one count of its encoder (rad), the control period dt and the time between
    /// two steps (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `proportional`, `proportional_at_rest`, `derivative`, `derivative_at_rest`, `measured_corner` or
    /// `largest_shift`.
    pub fn build(
        gains: &MeasuredFeedbackParams<R>,
        fastest: R,
        count: R,
        [dt, between]: [R; 2],
    ) -> Result<Self, Error> {
        let within = |value: R, most: f64| value >= R::ZERO && value <= R::lit(most);
        require(within(gains.proportional, 1.0), "proportional")?;
        require(within(gains.proportional_at_rest, 1.0), "proportional_at_rest")?;
        require(within(gains.derivative, 1.0), "derivative")?;
        require(within(gains.derivative_at_rest, 1.0), "derivative_at_rest")?;
        require(within(gains.corner, 1e5), "measured_corner")?;
        require(gains.largest_shift.is_positive(), "largest_shift")?;
        let farthest = (fastest * between + R::lit(2.0) * count) * R::lit(1.0 / RADIANS_PER_COUNT);
        Ok(Self {
            low_pass: LowPass::build(gains.corner, between),
            proportional: [gains.proportional, gains.proportional_at_rest],
            derivative: [gains.derivative, gains.derivative_at_rest].map(|gain| gain / between),
            dead_zone: R::lit(0.5 * ENCODER_NOISE.get()) * count,
            play: (R::lit((0.5 * ENCODER_NOISE.get() - ROUNDING) / RADIANS_PER_COUNT) * count).to_i32(),
            largest_shift: gains.largest_shift,
            farthest: farthest.to_i32().min(i32::MAX / 2),
            dt,
        })
    }

    /// Sets m in the feed-forward's slot, before the step of that period, for a setpoint that moves at `velocity` (rad/s), and the
    /// `gain` from the output's angle to the motor's. Without a measured error P ends at once, and D dies away with omega_m.
    #[inline(always)]
    pub fn plan(
        &self,
        state: &mut MeasuredFeedbackState<R>,
        measured: Option<MeasuredError<R>>,
        velocity: R,
        gain: R,
    ) {
        let rests = velocity == R::ZERO;
        let set = usize::from(rests);
        state.derivative = -gain * self.derivative[set];
        state.velocity = velocity;
        state.dead_zone = R::MAX;
        state.proportional = R::ZERO;
        state.sum = R::ZERO;
        state.play = if rests { self.play } else { 0 };
        if let Some(MeasuredError { phase, error }) = measured {
            state.read(phase);
            // This same period takes q from a reading that is not new to it.
            state.error = error + self.dt * velocity;
            state.dead_zone = if rests { self.dead_zone } else { R::ZERO };
            state.bound = error.limit(state.dead_zone);
            if state.bound != error || !rests {
                state.proportional = -gain * self.proportional[set];
            }
        }
    }

    /// Mean of m over the steps of the round that ends (rad), where the feedback acted; of one that began within the round, 0
    /// for the steps before.
    #[inline(always)]
    pub fn mean(&self, state: &MeasuredFeedbackState<R>) -> Option<R> {
        (state.dead_zone < R::MAX).then(|| R::lit(1.0 / STEPS as f64) * state.sum)
    }

    /// Shift of the motor's reference (rad at the motor), from the output encoder's newest reading, where it came after the last step.
    #[inline(always)]
    pub fn step(&self, state: &mut MeasuredFeedbackState<R>, phase: Option<u32>) -> R {
        if let Some(phase) = phase {
            let counts = phase.wrapping_sub(state.phase).cast_signed();
            if counts.wrapping_add(self.farthest).cast_unsigned() <= 2 * self.farthest.cast_unsigned() {
                state.read(phase);
                state.error += R::from_i32(counts) * R::lit(RADIANS_PER_COUNT);
            }
        }
        state.sum += state.error;
        let with_play = state.error - R::from_i32(state.within_play) * R::lit(RADIANS_PER_COUNT);
        let change = self.low_pass.step(&mut state.filtered, with_play.dead_zone(state.dead_zone));
        let beyond = state.error - state.bound;
        state.shift = (state.proportional * beyond + state.derivative * change).limit(self.largest_shift);
        state.shift
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 1e-4;
    const COUNT: f64 = 1.2e-5;
    const GAINS: MeasuredFeedbackParams<f64> = MeasuredFeedbackParams {
        proportional: 0.2,
        proportional_at_rest: 0.4,
        derivative: 4e-3,
        derivative_at_rest: 4e-3,
        corner: 1000.0,
        largest_shift: 1.0,
    };

    fn feedback(gains: MeasuredFeedbackParams<f64>) -> MeasuredFeedback<f64> {
        MeasuredFeedback::build(&gains, 5.86, COUNT, [DT; 2]).unwrap()
    }

    /// A step in every control period.
    fn step(
        feedback: &MeasuredFeedback<f64>,
        state: &mut MeasuredFeedbackState<f64>,
        phase: Option<u32>,
    ) -> f64 {
        state.advance(DT);
        feedback.step(state, phase)
    }

    fn phase(angle: f64) -> u32 {
        ((angle / RADIANS_PER_COUNT) as i32).cast_unsigned()
    }

    fn read(angle: f64) -> Option<MeasuredError<f64>> {
        Some(MeasuredError { phase: phase(angle), error: angle })
    }

    /// Under a constant error the shift is -P times what exceeds the dead zone; in slow motion, without it.
    #[test]
    fn a_constant_error_is_answered_by_the_proportional_gain() {
        let feedback = feedback(GAINS);
        let mut rests = MeasuredFeedbackState::default();
        feedback.plan(&mut rests, read(1e-4), 0.0, 1.0);
        let shift = (0..1000).map(|_| step(&feedback, &mut rests, Some(phase(1e-4)))).last().unwrap();
        assert!((shift + 0.4 * (1e-4 - 1.5 * COUNT)).abs() < 1e-9, "{shift}");
        let mut moves = MeasuredFeedbackState::default();
        feedback.plan(&mut moves, read(1e-4), 0.01, 1.0);
        let follows = |k: i32| phase(1e-4 + 0.01 * DT * f64::from(k));
        let shift = (0..1000).map(|k| step(&feedback, &mut moves, Some(follows(k)))).last().unwrap();
        assert!((shift + 0.2 * 1e-4).abs() < 1e-8, "{shift}");
    }

    /// Whatever the error, the shift is within its bound, of the sign that it has for a small one.
    #[test]
    fn a_large_error_asks_for_no_more_than_the_largest_shift() {
        let feedback = feedback(MeasuredFeedbackParams { largest_shift: 1e-4, ..GAINS });
        let mut state = MeasuredFeedbackState::default();
        feedback.plan(&mut state, read(0.0), 0.0, 1.0);
        let shifts = |error: f64| {
            [1, 2, 3].map(|k| step(&feedback, &mut state.clone(), Some(phase(k as f64 * error))))
        };
        assert_eq!(shifts(2e-4), [-1e-4; 3]);
        assert_eq!(shifts(-2e-4), [1e-4; 3]);
    }

    #[test]
    fn the_rounding_of_a_resting_encoder_moves_nothing() {
        let (feedback, mut state) = (feedback(GAINS), MeasuredFeedbackState::default());
        feedback.plan(&mut state, read(0.0), 0.0, 1.0);
        for k in 0..100 {
            let angle = if k % 2 == 0 { 1.4 * COUNT } else { -1.4 * COUNT };
            assert_eq!(step(&feedback, &mut state, Some(phase(angle))), 0.0);
        }
    }

    /// At a count of the encoder a round a reading of each round has the same rounding error, of which little is left in
    /// the mean; it is that of the error, and there is none without the feedback.
    #[test]
    fn the_mean_of_a_round_is_nearly_free_of_rounding() {
        const ERROR: f64 = 3e-4;
        let (feedback, mut state) = (feedback(GAINS), MeasuredFeedbackState::default());
        let speed = COUNT / (DT * f64::from(STEPS));
        for place in 0..10 {
            let start = f64::from(place) / 10.0;
            let counts = |k: u32| (start + f64::from(k) / f64::from(STEPS)).floor() + 0.5 - start;
            let read = |k: u32| phase(ERROR + COUNT * counts(k));
            let first = MeasuredError { phase: read(0), error: ERROR + COUNT * counts(0) };
            feedback.plan(&mut state, Some(first), speed, 1.0);
            for k in 0..STEPS {
                step(&feedback, &mut state, Some(read(k)));
            }
            let mean = feedback.mean(&state).unwrap();
            assert!((mean - ERROR).abs() <= (0.5 / f64::from(STEPS) + 0.01) * COUNT, "{mean}");
        }
        feedback.plan(&mut state, None, speed, 1.0);
        (0..STEPS).for_each(|_| _ = step(&feedback, &mut state, None));
        assert_eq!(feedback.mean(&state), None);
    }

    /// Damping ratio of a load on its spring, whose motor follows at once, from the decay of its energy; zero without D.
    fn damping_ratio(gains: MeasuredFeedbackParams<f64>) -> f64 {
        const STEPS: i32 = 2000;
        let feedback = feedback(gains);
        let (omega, mut state) = (180.0, MeasuredFeedbackState::default());
        let (mut e, mut rate) = (1e-3, 0.0);
        feedback.plan(&mut state, read(e), 1e-9, 1.0);
        for _ in 0..STEPS {
            let shift = step(&feedback, &mut state, Some(phase(e)));
            for _ in 0..16 {
                rate += DT / 16.0 * omega * omega * (shift - e);
                e += DT / 16.0 * rate;
            }
        }
        let stiffened = omega * (1.0 + gains.proportional).sqrt();
        let amplitude = (e * e + (rate / stiffened).powi(2)).sqrt();
        -(amplitude / 1e-3).ln() / (stiffened * f64::from(STEPS) * DT)
    }

    /// The mode is damped by the ratio D*omega/2, over the root of 1 + P.
    #[test]
    fn the_derivative_damps_the_mode() {
        let fast = MeasuredFeedbackParams { proportional: 0.0, derivative: 1e-3, corner: 2e4, ..GAINS };
        let ratio = damping_ratio(fast);
        assert!((ratio / (0.5 * 1e-3 * 180.0) - 1.0).abs() < 0.1, "{ratio}");
        let with_both = damping_ratio(MeasuredFeedbackParams { proportional: 0.4, ..fast });
        assert!(with_both > 0.6 * ratio && with_both < ratio, "{with_both} {ratio}");
    }

    #[test]
    fn a_count_that_no_joint_reaches_is_refused() {
        let (feedback, mut state) = (feedback(GAINS), MeasuredFeedbackState::default());
        feedback.plan(&mut state, read(0.0), 0.0, 1.0);
        assert_eq!(step(&feedback, &mut state, Some(phase(0.1))), 0.0);
        assert_eq!(step(&feedback, &mut state, Some(phase(1e-5))), 0.0);
        assert_ne!(step(&feedback, &mut state, Some(phase(5e-4))), 0.0);
    }

    /// A joint that rests away from its setpoint: a count to and fro changes P's part alone, by that count; more moves D, too.
    #[test]
    fn a_count_of_noise_is_no_pulse_wherever_the_joint_rests() {
        const REST: f64 = 20.0 * COUNT;
        let feedback = feedback(GAINS);
        let mut state = MeasuredFeedbackState::default();
        feedback.plan(&mut state, read(REST), 0.0, 1.0);
        let mut shift = |counts: f64| step(&feedback, &mut state, Some(phase(REST + counts * COUNT)));
        shift(1.0);
        let still = (0..1000).map(|_| shift(0.0)).last().unwrap();
        for k in 0..100 {
            let change = (shift(f64::from(k % 2) - f64::from(k % 3 % 2)) - still).abs();
            assert!(change <= 1.02 * GAINS.proportional_at_rest * COUNT, "{k}: {change}");
        }
        let by_derivative = GAINS.derivative_at_rest / DT * 0.09 * COUNT;
        assert!(shift(4.0) - still < -by_derivative, "{}", shift(4.0));
    }

    /// Over a cycle of any amplitude P and D take energy from the load whose motor follows, or leave it as it is.
    #[test]
    fn at_rest_the_play_gives_no_energy() {
        const STEPS: i32 = 2000;
        let fast = MeasuredFeedbackParams { corner: 1e5, ..GAINS };
        let feedback = feedback(fast);
        let energy = |amplitude: f64, middle: f64| {
            let at = |k: i32| {
                middle + amplitude * (core::f64::consts::TAU * f64::from(k) / f64::from(STEPS)).sin()
            };
            let mut state = MeasuredFeedbackState::default();
            feedback.plan(&mut state, read(at(0)), 0.0, 1.0);
            let mut cycle = || -> f64 {
                let step =
                    |k| 0.5 * (at(k + 1) - at(k - 1)) * step(&feedback, &mut state, Some(phase(at(k))));
                (1..=STEPS).map(step).sum()
            };
            cycle();
            cycle()
        };
        for counts in [0.5, 0.9, 1.1, 1.5, 3.0, 10.0] {
            for middle in [0.0, 1.0, 2.0, 20.0] {
                let energy = energy(counts * COUNT, middle * COUNT) / (COUNT * COUNT);
                assert!(energy < 1e-3, "{counts} {middle}: {energy}");
            }
        }
        assert!(energy(10.0 * COUNT, 20.0 * COUNT) < -COUNT * COUNT);
    }

    /// Where the encoder is lost or the setpoint fast, the shift dies away.
    #[test]
    fn without_a_reading_the_shift_dies_away() {
        let (feedback, mut state) = (feedback(GAINS), MeasuredFeedbackState::default());
        feedback.plan(&mut state, read(1e-3), 0.01, 1.0);
        (0..100).for_each(|_| {
            step(&feedback, &mut state, None);
        });
        feedback.plan(&mut state, None, 0.01, 1.0);
        let shift = (0..200).map(|_| step(&feedback, &mut state, None)).last().unwrap();
        assert!(shift.abs() < 1e-9, "{shift}");
    }

    #[test]
    fn a_gain_out_of_range_is_named() {
        let error = |gains| MeasuredFeedback::build(&gains, 5.86, COUNT, [DT; 2]).unwrap_err();
        let named = |name| Error::OutOfRange(name);
        assert_eq!(error(MeasuredFeedbackParams { proportional: 1.1, ..GAINS }), named("proportional"));
        assert_eq!(error(MeasuredFeedbackParams { derivative: f64::NAN, ..GAINS }), named("derivative"));
        assert_eq!(error(MeasuredFeedbackParams { corner: -1.0, ..GAINS }), named("measured_corner"));
        assert_eq!(error(MeasuredFeedbackParams { largest_shift: 0.0, ..GAINS }), named("largest_shift"));
    }
}
