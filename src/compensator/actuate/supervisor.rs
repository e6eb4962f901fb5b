//! Supervisor of the feedback functions: an oscillation that does not decay ramps them down.
//!
//! ```text
//! s = observed torsion at rest, commanded torque in motion;   L = max(32 ms, 2*pi*sqrt(J_fs/K_1))
//! v_k, w_k = variance of s in the window k about its linear trend, and of the trend
//! oscillates:  v_k > a^2,  v_k > w_k  and  v_k > 0.75*v_(k-1),  in three windows on end, or in most of more
//! a = max(0.005*T_n/K_1, count/N) at rest, 0.5*tau_max in motion
//! gain:        1 -> 0 in 20 ms,   0 for H after the last such window,   0 -> 1 in 0.5 s
//! stiffness:   of the cascade, down with the gain,   back in 8 s
//! ```
//!
//! The gain multiplies what responds to the output's measured and estimated angle, P, D and damping, and to the estimated
//! load; while it is below 1, the output's integral stands still and nothing is learnt. What is left is the motor-side cascade with all
//! feed-forward, softer by the same gain ([`crate::compensator::actuate::cascade::Stiffness`]): on a joint whose load swings on a
//! flexible link the cascade as it was built may have no margin of its own. It stays softer when the functions are back, as they are built
//! for its margins, and is as it was after 8 s without an oscillation. Of a resting joint the slow part of the estimated load follows the
//! estimate by the same gain ([`crate::compensator::estimate::disturbance`]): at 0 it stands, and only one estimate is left to the cascade:
//! with a coarse encoder the observer's speed of a resting motor ([`crate::compensator::actuate::cascade`]), without which a count would
//! keep that cascade moving.
//!
//! A resting gear winds up for a load, to another place, and vibrates about it; but within a period of the torsion mode, of the
//! load J_fs on the softest slope K_1 of the stiffness line, a damping ratio of 0.025 takes more than a quarter of
//! the variance. What loses less in two successive windows is kept up by the loop: by a count of an encoder, a drive that is later than
//! declared, a load or a stiffness beyond their tolerances, or a friction that no model has. In motion a torque is normal that
//! accelerates and brakes, but not one that goes from limit to limit in three windows on end. Static friction lets go of the motor at no
//! regular times: a window that oscillates counts two, one that does not takes one off, and six are an oscillation. H is 0.5 s, and doubles each time that the
//! oscillation comes back in the same rest, up to 8 s.
//!
//! In a limit cycle of the torque ([`super::limit_cycle`]) the gain is 0 at once.
//!
//! An oscillation of a period up to L is named within four windows of its begin: 0.13 s for a mode above 31 Hz, four of its periods
//! below. T_n is the gear's rated torque, count/N one count of the motor's encoder at the output, tau_max the motor's peak torque. Units:
//! rad at the output, N m at the motor, s.

use crate::branch::seldom;
use crate::compensator::Faults;
use crate::compensator::actuate::cascade::Stiffness;
use crate::compensator::schedule::SLOW_PERIODS;
use crate::compensator::tuned::{
    DECAYED, FADING_TIME, LIMIT_CYCLE_TORSION, LIMIT_TO_LIMIT, LONGEST_HOLD, OSCILLATION_TIME, OSCILLATIONS,
    SETTLED_TIME,
};
use crate::constants::constants;
use crate::gear::GearParams;
use crate::real::Real;

/// What a window counts that oscillates; one that does not takes 1 off, so that it is an oscillation where most windows do.
const OSCILLATES: u32 = 2;

/// The built supervisor.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Supervisor<R> {
    /// Rounds of a window, and their inverse.
    window: u32,
    inverse_window: R,
    /// Mean and inverse variance of the rounds' numbers in a window.
    middle: R,
    inverse_spread: R,
    /// Count of windows that is an oscillation.
    windows: u32,
    /// What a variance is multiplied by that has not decayed.
    decayed: R,
    /// a^2 in motion and at rest.
    levels: [R; 2],
    /// Change of the gain in a round: down and back.
    down: R,
    back: R,
    /// Rounds of H, the first and the longest.
    hold: [u32; 2],
}

/// State of the supervisor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupervisorState<R> {
    /// Gain of the feedback functions, 0..=1.
    gain: R,
    /// Stiffness of the cascade.
    stiffness: Stiffness<R>,
    /// First s of the window, and sums of the differences to it, of their squares and of their products with the round.
    first: R,
    sum: R,
    squares: R,
    products: R,
    rounds: u32,
    /// Variance of the last window, and count of those that oscillate.
    variance: R,
    windows: u32,
    /// Whether the setpoint rested.
    rests: bool,
    /// Rounds until the gain comes back, and H of the last time.
    held: u32,
    hold: u32,
}

impl<R: Real> Default for SupervisorState<R> {
    fn default() -> Self {
        let zero = R::ZERO;
        Self {
            gain: R::ONE,
            stiffness: Stiffness::FULL,
            first: zero,
            sum: zero,
            squares: zero,
            products: zero,
            rounds: 0,
            variance: zero,
            windows: 0,
            rests: false,
            held: 0,
            hold: 0,
        }
    }
}

impl<R: Real> SupervisorState<R> {
    /// Gain of the feedback functions, 0..=1.
    #[inline(always)]
    pub fn gain(&self) -> R {
        self.gain
    }

    /// Stiffness of the cascade.
    #[inline(always)]
    pub fn stiffness(&self) -> Stiffness<R> {
        self.stiffness
    }

    /// Sets the gain of the feedback functions; the cascade is no stiffer than it allows.
    #[inline(always)]
    fn reduce(&mut self, gain: R) {
        self.gain = gain;
        self.stiffness = self.stiffness.softer(gain);
    }

    /// Begins a window with its first s.
    #[inline(always)]
    fn begin(&mut self, first: R) {
        (self.first, self.rounds) = (first, 1);
        (self.sum, self.squares, self.products) = (R::ZERO, R::ZERO, R::ZERO);
    }

    /// Adds the next s to the window.
    #[inline(always)]
    fn add(&mut self, supervised: R) {
        let difference = supervised - self.first;
        self.sum += difference;
        self.squares += difference * difference;
        self.products += R::from_i32(self.rounds.cast_signed()) * difference;
        self.rounds += 1;
    }
}

impl<R: Real> Supervisor<R> {
    /// For a gear, a motor of this peak torque (N m), one count of its encoder (rad) and the control period dt (s).
    pub fn build(gear: &GearParams<R>, peak_torque: R, count: R, dt: R) -> Self {
        let round = R::from_i32(SLOW_PERIODS as i32) * dt;
        let rounds = |time: R| ((time / round + R::lit(0.5)).to_i32().max(2)).cast_unsigned();
        let [softest, ..] = gear.flexspline.line.stiffness;
        let period = R::lit(core::f64::consts::TAU) * (gear.flexspline_inertia / softest).sqrt();
        let in_time = (OSCILLATION_TIME - SETTLED_TIME.get()) / (OSCILLATIONS.get() + 1.0);
        let window = ((R::lit(in_time) / round).to_i32().max(2)).cast_unsigned().max(rounds(period));
        let length = R::from_i32(window.cast_signed());
        let at_rest = (R::lit(LIMIT_CYCLE_TORSION.get()) * gear.rated_torque / softest)
            .max(count / R::from_i32(gear.ratio).abs());
        let in_motion = R::lit(LIMIT_TO_LIMIT) * peak_torque;
        Self {
            window,
            inverse_window: R::ONE / length,
            middle: R::lit(0.5) * (length - R::ONE),
            inverse_spread: R::lit(12.0) / (length * length - R::ONE),
            windows: OSCILLATES * OSCILLATIONS.get() as u32,
            decayed: R::lit(DECAYED.get()),
            levels: [in_motion * in_motion, at_rest * at_rest],
            down: round / R::lit(SETTLED_TIME.get()),
            back: round / R::lit(FADING_TIME.get()),
            hold: [FADING_TIME, LONGEST_HOLD].map(|time| rounds(R::lit(time.get()))),
        }
    }

    /// Once a round: the torsion (rad), the torque command (N m), and whether the setpoint rests.
    #[inline(always)]
    pub fn step(
        &self,
        state: &mut SupervisorState<R>,
        torsion: R,
        torque: R,
        rests: bool,
        faults: &mut Faults,
    ) {
        let supervised = if rests { torsion } else { torque };
        if rests != state.rests {
            seldom();
            *state = SupervisorState { rests, variance: R::ZERO, windows: 0, hold: 0, ..*state };
            state.begin(supervised);
        } else if state.rounds < self.window {
            state.add(supervised);
        } else {
            self.judge(state);
            state.begin(supervised);
        }
        if state.stiffness != Stiffness::FULL {
            seldom();
            let change = if state.held > 0 { -self.down } else { self.back };
            state.held = state.held.saturating_sub(1);
            let stiffer = self.back * R::lit(FADING_TIME.get() / LONGEST_HOLD.get());
            state.stiffness = state.stiffness.stiffer(stiffer);
            state.reduce((state.gain + change).max(R::ZERO).min(R::ONE));
            faults.raise_if(true, Faults::FEEDBACK_REDUCED);
        }
    }

    /// Judges a window that is full.
    fn judge(&self, state: &mut SupervisorState<R>) {
        let mean = self.inverse_window * state.sum;
        let covariance = self.inverse_window * state.products - self.middle * mean;
        let by_trend = self.inverse_spread * covariance * covariance;
        let variance = self.inverse_window * state.squares - mean * mean - by_trend;
        let oscillates = variance > self.levels[usize::from(state.rests)]
            && variance > by_trend
            && variance > self.decayed * state.variance;
        state.windows = if oscillates { state.windows + OSCILLATES } else { state.windows.saturating_sub(1) };
        state.variance = variance;
        if state.windows < self.windows {
            return;
        }
        seldom();
        state.windows = self.windows;
        self.hold(state);
        state.reduce(state.gain.min(R::ONE - self.down));
    }

    /// Takes the feedback functions away at once, where the torque steps from limit to limit as it is.
    pub fn take_away(&self, state: &mut SupervisorState<R>) {
        self.hold(state);
        state.reduce(R::ZERO);
    }

    /// Begins to hold the gain down, or goes on.
    fn hold(&self, state: &mut SupervisorState<R>) {
        let [first, longest] = self.hold;
        if state.held == 0 {
            state.hold = (2 * state.hold).max(first).min(longest);
        }
        state.held = state.hold;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensator::schedule::CONTROL_PERIOD;
    use core::f64::consts::TAU;
    use std::vec;
    use std::vec::Vec;

    const ROUND: f64 = SLOW_PERIODS as f64 * CONTROL_PERIOD;
    const PEAK: f64 = 2.4;

    fn supervisor() -> Supervisor<f64> {
        Supervisor::build(&crate::gear::tests::params(), PEAK, TAU / 524288.0, CONTROL_PERIOD)
    }

    /// Torsion of the rated torque (rad).
    fn rated() -> f64 {
        let gear = crate::gear::tests::params();
        gear.rated_torque / gear.flexspline.line.stiffness[0]
    }

    /// A round with this torsion (rad) of a resting joint or torque (N m) of a moving one.
    fn step(state: &mut SupervisorState<f64>, supervised: f64, rests: bool) -> Faults {
        let mut faults = Faults::NONE;
        let [torsion, torque] = if rests { [supervised, 0.0] } else { [0.0, supervised] };
        supervisor().step(state, torsion, torque, rests, &mut faults);
        faults
    }

    /// The gain each round with this torsion or torque at a time (s).
    fn gains(seconds: f64, rests: bool, supervised: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut state = SupervisorState::default();
        let rounds = 0..(seconds / ROUND) as usize;
        rounds
            .map(|k| {
                let faults = step(&mut state, supervised(k as f64 * ROUND), rests);
                assert!(state.gain() == 1.0 || faults.contains(Faults::FEEDBACK_REDUCED));
                state.gain()
            })
            .collect()
    }

    fn stays(seconds: f64, rests: bool, supervised: impl Fn(f64) -> f64) -> bool {
        gains(seconds, rests, supervised).iter().all(|gain| *gain == 1.0)
    }

    #[test]
    fn an_oscillation_at_rest_ends_within_its_time() {
        for frequency in [35.0, 94.0, 300.0] {
            let gains = gains(0.4, true, |time| 0.05 * rated() * (TAU * frequency * time).sin());
            let off = gains.iter().position(|gain| *gain == 0.0).unwrap();
            assert!(off as f64 * ROUND < 0.15, "{frequency}: {off}");
            assert_eq!(gains.last(), Some(&0.0));
        }
    }

    /// As static friction holds the motor for a while in each period, every second window has a tenth of the variance.
    #[test]
    fn an_irregular_oscillation_ends() {
        let window = f64::from(supervisor().window) * ROUND;
        let torsion = |level: f64| {
            move |time: f64| {
                let part = if ((time / window) as u32).is_multiple_of(2) { 1.0 } else { 0.3 };
                level * part * rated() * (TAU * 94.0 * time).sin()
            }
        };
        assert!(!stays(0.5, true, torsion(0.05)));
        assert!(stays(0.5, true, torsion(0.005)));
    }

    #[test]
    fn a_vibration_that_decays_is_left_to_the_feedback() {
        for (damping, stays_on) in [(0.05, true), (0.002, false)] {
            let omega = TAU * 34.0;
            let torsion = |time: f64| 0.5 * rated() * (-damping * omega * time).exp() * (omega * time).sin();
            assert_eq!(stays(1.0, true, torsion), stays_on, "{damping}");
        }
    }

    #[test]
    fn a_load_that_comes_is_no_oscillation() {
        assert!(stays(1.0, true, |time| 8.0 * rated() * time));
        for rise in [0.001, 0.02, 0.1, 0.3] {
            assert!(stays(1.0, true, |time| 0.8 * rated() * (time / rise).min(1.0)), "{rise}");
        }
    }

    #[test]
    fn in_motion_only_a_torque_from_limit_to_limit_is_an_oscillation() {
        let swings = |level: f64| move |time: f64| level * PEAK * (TAU * 40.0 * time).sin();
        assert!(stays(0.5, false, swings(0.6)));
        assert!(!stays(0.5, false, swings(1.0)));
        // As much torque as there is, to accelerate and to brake.
        assert!(stays(0.5, false, |time| if time < 0.1 { PEAK } else { -PEAK }));
    }

    #[test]
    fn the_gain_comes_back_slowly_and_later_each_time() {
        let ends = |end: f64| move |time: f64| if time < end { rated() * (300.0 * time).sin() } else { 0.0 };
        let gains_after = gains(2.5, true, ends(0.3));
        let at = |time: f64| gains_after[(time / ROUND) as usize];
        assert!(at(0.7) == 0.0 && (0.1..0.9).contains(&at(1.1)) && at(1.5) == 1.0);
        // Kept up whenever the gain is back: half a second off, then one, then two.
        let mut state = SupervisorState::default();
        let mut holds = vec![0];
        for k in 0..(20.0 / ROUND) as usize {
            let amplitude = if state.gain() == 1.0 { 0.3 * rated() } else { 0.0 };
            step(&mut state, amplitude * (300.0 * k as f64 * ROUND).sin(), true);
            if *holds.last().unwrap() != state.hold {
                holds.push(state.hold);
            }
        }
        let [first, longest] = supervisor().hold;
        assert_eq!(holds[..4], [0, first, 2 * first, 4 * first]);
        assert!(holds.iter().all(|hold| *hold <= longest));
    }

    #[test]
    fn a_gain_that_is_taken_away_comes_back_slowly() {
        let mut state = SupervisorState::default();
        supervisor().take_away(&mut state);
        assert_eq!(state.gain(), 0.0);
        let gains: Vec<_> = (0..(2.0 / ROUND) as u32)
            .map(|_| {
                step(&mut state, 0.0, true);
                state.gain()
            })
            .collect();
        let at = |time: f64| gains[(time / ROUND) as usize];
        assert!(at(0.4) == 0.0 && (0.1..0.9).contains(&at(0.75)) && at(1.1) == 1.0);
    }

    /// Also through moves, which end no softness.
    #[test]
    fn the_cascade_is_soft_with_the_gain_and_stays_so_when_it_is_back() {
        let mut state = SupervisorState::default();
        supervisor().take_away(&mut state);
        assert_eq!(state.stiffness(), Stiffness::FULL.softer(0.0));
        let mut after = |seconds: f64| {
            for k in 0..(seconds / ROUND) as u32 {
                let is_softer = state.stiffness() != Stiffness::FULL;
                let faults = step(&mut state, 0.0, k / 500 % 2 == 0);
                assert_eq!(faults.contains(Faults::FEEDBACK_REDUCED), is_softer);
            }
            state
        };
        let back = after(1.1);
        assert!(back.gain() == 1.0 && back.stiffness() != Stiffness::FULL);
        assert_ne!(after(LONGEST_HOLD.get() - 1.0).stiffness(), Stiffness::FULL);
        assert_eq!(after(1.1).stiffness(), Stiffness::FULL);
    }

    #[test]
    fn a_move_forgets_how_long_it_was_off_but_not_that_it_is() {
        let mut state = SupervisorState::default();
        for k in 0..500 {
            step(&mut state, rated() * f64::from(k).sin(), true);
        }
        step(&mut state, 0.0, false);
        assert!(state.gain() == 0.0 && state.held > 0 && state.hold == 0);
    }
}
