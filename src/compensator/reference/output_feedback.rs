//! Output feedback: the motor's reference is shifted so that the torsional vibration is damped and no error stays.
//!
//! ```text
//! e      = theta_fs - q,   e' = omega_fs - dq,   e'' = domega_fs/dt - ddq
//! shift  = -(b*e' + P*m_f + D*dm_f/dt + z),    dshift = -(b*e'' + k*y),    dz/dt = k*y
//! y      = two poles at omega_y on m,   m_f = one pole at omega_m on m in slow motion, on 0 at rest and in a fast one
//! ```
//!
//! theta_fs and omega_fs are the observer's, domega_fs/dt what it predicts with, so that e'' is zero where e' stands still,
//! whatever the load is: any other balance of torques would make of a constant load a reference that ramps between two
//! slots and jumps back in each. q is the setpoint.
//! m is the output encoder's angle less q, less what a count hides; without that encoder e. The shift (rad at the output) is added to where the motor side should
//! be, and the cascade follows it.
//!
//! With a motor that follows, the load on its spring obeys J_fs*e'' = K*(shift - e): the torsion mode of frequency
//! omega = sqrt(K/J_fs) is damped by (b + D)*omega/2, and z closes a loop of crossover k through two poles and that
//! mode. P stiffens the joint through a motor that is late, whose delay turns it into negative damping of the mode, which
//! D outweighs; b and D do so only where the delay passes a quarter of the mode's
//! period. The gains are shares of omega. P and D act on what is measured, so that they are right where the model is
//! not, and only in slow motion: at rest a count of noise would be torque, and in a fast move the flexible mode of a
//! load would be.
//!
//! Where the setpoint rests, m with an output encoder is what exceeds one of its counts: static friction and the
//! integral would answer every change of the last count. It is the measured angle that z integrates, not the estimated
//! one, which is off by what friction of another structure than the model's does. z only runs where the setpoint is slow: what a fast move
//! leaves, the wind-up of a gear that is stiffer or softer than its model, changes its sign before z could follow. z
//! and the shift are limited. z moves on in a slot after the shift's. Discretisation: explicit Euler. Units: rad, rad/s, N m; signs as in [`crate::gear`].
//!
//! A. De Luca, W. Book, "Robots with flexible elements", Springer Handbook of Robotics (2016), chapter 11: damping by
//! link-side velocity, and what a motor's lag makes of it.

use crate::error::{Error, require};
use crate::real::Real;

/// Gains of the output feedback for one set of sensors; all zero for none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OutputFeedbackParams<R> {
    /// b (s), 0..=1.
    pub damping: R,
    /// k in slow motion (1/s), 0..=1000.
    pub integral: R,
    /// k at rest (1/s), 0..=1000.
    pub integral_at_rest: R,
    /// omega_y (rad/s), 0..=1e5.
    pub filter_corner: R,
    /// P, 0..=1.
    pub proportional: R,
    /// D (s), 0..=1.
    pub derivative: R,
    /// omega_m (rad/s), 0..=1e5.
    pub measured_corner: R,
}

/// Largest shift of the motor's reference, at the output (rad): more than peak torque winds a gear up.
const LARGEST: f64 = 0.01;

/// Fastest setpoint at which z runs, as a share of the joint's fastest speed.
const SLOW: f64 = 0.05;
/// What of a resting output its encoder does not show, in counts.
const HIDDEN: f64 = 1.0;

/// The built output feedback.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutputFeedback<R> {
    /// Without and with an output encoder.
    gains: [OutputFeedbackParams<R>; 2],
    /// Share of the way that each pole of y takes in a round.
    filter_gains: [R; 2],
    /// Share of the way that m_f takes in a round; P and D/dt of either set.
    measured_gain: R,
    by_measurement: [[R; 2]; 2],
    /// Fastest setpoint at which z runs (rad/s).
    slow: R,
    /// What a count of the output encoder hides (rad).
    hidden: R,
    dt: R,
}

/// z, m behind the first and the second pole, and m_f (rad).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OutputFeedbackState<R> {
    integral: R,
    first_pole: R,
    filtered: R,
    measured: R,
    /// dz/dt (rad/s).
    integral_rate: R,
    /// m of the last deviation (rad), whether it was measured, and whether the setpoint rested.
    error: R,
    measures: bool,
    rests: bool,
}

/// How far the output is off its setpoint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation<R> {
    /// e (rad).
    pub position: R,
    /// e' (rad/s).
    pub velocity: R,
    /// dq (rad/s).
    pub asked_velocity: R,
    /// e'' (rad/s^2).
    pub acceleration: R,
    /// Output encoder's angle less q (rad), where it reads.
    pub measured: Option<R>,
}

/// What is added to where the motor side should be, at the output.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shift<R> {
    /// (rad)
    pub angle: R,
    /// (rad/s)
    pub rate: R,
}

impl<R: Real> OutputFeedback<R> {
    /// From the gains without and with an output encoder, the output's fastest speed (rad/s), one
    /// count of its encoder (rad) and the time dt between its turns (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the name of the gain outside its range.
    pub fn build(gains: &[OutputFeedbackParams<R>; 2], fastest: R, count: R, dt: R) -> Result<Self, Error> {
        let within = |value: R, most: f64| value >= R::ZERO && value <= R::lit(most);
        for set in gains {
            require(within(set.damping, 1.0), "damping")?;
            require(within(set.integral, 1000.0), "integral")?;
            require(within(set.integral_at_rest, 1000.0), "integral_at_rest")?;
            require(within(set.filter_corner, 1e5), "filter_corner")?;
            require(within(set.proportional, 1.0), "proportional")?;
            require(within(set.derivative, 1.0), "derivative")?;
            require(within(set.measured_corner, 1e5), "measured_corner")?;
        }
        Ok(Self {
            gains: *gains,
            filter_gains: [0, 1].map(|k: usize| (dt * gains[k].filter_corner).one_minus_exp_neg()),
            measured_gain: (dt * gains[1].measured_corner).one_minus_exp_neg(),
            by_measurement: [0, 1].map(|k: usize| [gains[k].proportional, gains[k].derivative / dt]),
            slow: R::lit(SLOW) * fastest,
            hidden: R::lit(HIDDEN) * count,
            dt,
        })
    }

    /// Shift for a deviation, in the feed-forward's slot.
    #[inline(always)]
    pub fn step(&self, state: &mut OutputFeedbackState<R>, deviation: &Deviation<R>) -> Shift<R> {
        let set = usize::from(deviation.measured.is_some());
        let speed = deviation.asked_velocity.abs();
        let rests = speed == R::ZERO;
        let error =
            if speed < self.slow { deviation.measured.unwrap_or(deviation.position) } else { R::ZERO };
        state.error = error;
        state.rests = rests;
        state.measures = deviation.measured.is_some();
        let damping = self.gains[set].damping;
        let change = self.measured_gain * (if rests { R::ZERO } else { error } - state.measured);
        state.measured += change;
        let measured = self.by_measurement[set][0] * state.measured + self.by_measurement[set][1] * change;
        let angle = damping * deviation.velocity + measured + state.integral;
        let rate = damping * deviation.acceleration + state.integral_rate;
        Shift { angle: -angle.limit(R::lit(LARGEST)), rate: -rate }
    }

    /// Moves z on by the last deviation, in a later slot; `runs` is false while the motor cannot follow, and z stands
    /// still.
    #[inline(always)]
    pub fn integrate(&self, state: &mut OutputFeedbackState<R>, runs: bool) {
        let set = usize::from(state.measures);
        let (gains, filter_gain) = (&self.gains[set], self.filter_gains[set]);
        let hidden = if state.measures && state.rests { self.hidden } else { R::ZERO };
        state.first_pole += filter_gain * (state.error.dead_zone(hidden) - state.first_pole);
        state.filtered += filter_gain * (state.first_pole - state.filtered);
        let gain = if state.rests { gains.integral_at_rest } else { gains.integral };
        state.integral_rate = gain * state.filtered;
        if runs {
            state.integral = (state.integral + self.dt * state.integral_rate).limit(R::lit(LARGEST));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 4e-4;
    const INERTIA: f64 = 1.2;
    const STIFFNESS: f64 = 4e4;
    const GAINS: OutputFeedbackParams<f64> = OutputFeedbackParams {
        damping: 1.4e-3,
        integral: 0.0,
        integral_at_rest: 0.0,
        filter_corner: 60.0,
        proportional: 0.0,
        derivative: 0.0,
        measured_corner: 1000.0,
    };

    fn feedback(gains: OutputFeedbackParams<f64>) -> OutputFeedback<f64> {
        OutputFeedback::build(&[gains; 2], 5.86, 1.2e-5, DT).unwrap()
    }

    fn stepped(
        feedback: &OutputFeedback<f64>,
        state: &mut OutputFeedbackState<f64>,
        deviation: &Deviation<f64>,
        runs: bool,
    ) -> Shift<f64> {
        let shift = feedback.step(state, deviation);
        feedback.integrate(state, runs);
        shift
    }

    /// Largest deviation after `seconds`, and the last, of a load on its spring, whose motor follows at once, that starts
    /// 1 mrad off under a constant `load` (N m); what the observer knows of it is taken for the truth.
    fn decay(gains: OutputFeedbackParams<f64>, load: f64, seconds: f64) -> (f64, f64) {
        let (feedback, mut state) = (feedback(gains), OutputFeedbackState::default());
        let (mut e, mut rate, mut acceleration, mut largest) = (1e-3f64, 0.0, 0.0, 0.0f64);
        let periods = (seconds / DT) as usize;
        for k in 0..periods {
            let deviation =
                Deviation { position: e, velocity: rate, acceleration, measured: None, asked_velocity: 0.0 };
            let shift = stepped(&feedback, &mut state, &deviation, true);
            for _ in 0..16 {
                acceleration = (STIFFNESS * (shift.angle - e) + load) / INERTIA;
                rate += DT / 16.0 * acceleration;
                e += DT / 16.0 * rate;
            }
            // The last quarter of a second.
            if (periods - k) as f64 * DT < 0.25 {
                largest = largest.max(e.abs());
            }
        }
        (largest, e)
    }

    /// The mode's damping ratio is b*omega/2.
    #[test]
    fn the_mode_is_damped() {
        let frequency = (STIFFNESS / INERTIA).sqrt();
        let damping = GAINS.damping * frequency / 2.0;
        assert!((0.12..0.13).contains(&damping), "{damping}");
        let (with, _) = decay(GAINS, 0.0, 0.5);
        let (without, _) = decay(OutputFeedbackParams::default(), 0.0, 0.5);
        assert!(with < 1e-3 * (-0.8 * damping * frequency * 0.25).exp(), "{with}");
        assert!(without > 0.9e-3, "{without}");
    }

    #[test]
    fn what_stays_is_gone_with_the_integral() {
        let alone = 40.0 / STIFFNESS;
        let (_, damped) = decay(GAINS, 40.0, 2.0);
        assert!((damped - alone).abs() < 1e-3 * alone, "{damped}");
        let (_, integrated) = decay(OutputFeedbackParams { integral_at_rest: 20.0, ..GAINS }, 40.0, 2.0);
        assert!(integrated.abs() < 1e-3 * alone, "{integrated}");
    }

    #[test]
    fn the_shift_is_bounded_and_the_integral_waits() {
        let feedback = feedback(OutputFeedbackParams { integral: 30.0, integral_at_rest: 30.0, ..GAINS });
        let far = Deviation { position: 1e3, velocity: 1e3, ..Deviation::default() };
        let mut state = OutputFeedbackState::default();
        for _ in 0..10_000 {
            assert!(stepped(&feedback, &mut state, &far, true).angle.abs() <= LARGEST);
        }
        let before = state.integral;
        stepped(&feedback, &mut state, &Deviation { position: -1e3, ..Deviation::default() }, false);
        assert_eq!(state.integral, before);
        let fast = Deviation { position: 1e-3, asked_velocity: 1.0, ..Deviation::default() };
        let mut state = OutputFeedbackState::default();
        stepped(&feedback, &mut state, &fast, true);
        assert_eq!(state, OutputFeedbackState::default());
    }

    #[test]
    fn at_rest_the_last_count_moves_nothing() {
        let feedback = feedback(OutputFeedbackParams { integral: 30.0, integral_at_rest: 30.0, ..GAINS });
        let integral = |position, asked_velocity| {
            let mut state = OutputFeedbackState::default();
            let deviation = Deviation { measured: Some(position), asked_velocity, ..Deviation::default() };
            stepped(&feedback, &mut state, &deviation, true);
            state.integral
        };
        assert_eq!(integral(11.0e-6, 0.0), 0.0);
        assert!(integral(11.0e-6, 0.1) > 0.0 && integral(13e-6, 0.0) > 0.0);
    }

    #[test]
    fn a_gain_out_of_range_is_named() {
        let build = |gains| OutputFeedback::build(&[GAINS, gains], 5.86, 1.2e-5, DT).unwrap_err();
        let named = |name| Error::OutOfRange(name);
        assert_eq!(build(OutputFeedbackParams { filter_corner: f64::NAN, ..GAINS }), named("filter_corner"));
        assert_eq!(build(OutputFeedbackParams { damping: -0.1, ..GAINS }), named("damping"));
        assert_eq!(build(OutputFeedbackParams { integral: 2000.0, ..GAINS }), named("integral"));
    }
}
