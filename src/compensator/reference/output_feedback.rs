//! Output feedback: shift of the motor's reference that damps the torsional vibration and removes the steady error.
//!
//! ```text
//! e      = theta_fs - q,   e' = omega_fs - dq,   e'' = (tau_t - tau_fric_out + d - J_fs*ddq)/J_fs
//! shift  = -(b*e' + z),    dshift = -(b*e'' + k*y),    dz/dt = k*y,    y = two poles at omega_y on m + c*r*x
//! ```
//!
//! theta_fs, omega_fs, tau_t and tau_fric_out are the observer's, q the setpoint, J_fs*ddq as in the feed-forward's
//! wind-up, d the external torque: its slow part whole, its fast part as far as it is compensated
//! ([`crate::compensator::estimate::disturbance`]). With the slow part behind its dead zone, too, e'' would not be zero
//! under a constant load, and the reference would ramp between two slots and jump back in each. m is the output encoder's
//! angle less q, of which P and D act in every second control period ([`super::measured_feedback`]); without that encoder e. x is
//! what a motor at rest has yet to go to its reference, 0 in motion, r the gear's ratio. The shift (rad at the output) is
//! added to the motor's reference, and the cascade follows it.
//!
//! With a motor that follows, the load on its spring obeys J_fs*e'' = K*(shift - e): the torsion mode of frequency
//! omega = sqrt(K/J_fs) is damped by b*omega/2, and z closes a loop of crossover k through two poles and that
//! mode, of which it takes a damping ratio of k/(2*omega)*cos(2*a)/(1 + tan(a)^2), a = atan(omega/omega_y): none where
//! omega_y is omega, k/(2*omega) where it is far above. b becomes a negative damping only where the motor's delay passes a
//! quarter of the mode's period. The gains scale with omega. b has a value of its own at rest, where friction that does not slide holds the
//! motor, from the round after the setpoint's last on.
//!
//! A motor in static friction does not move until the cascade's torque has grown to the break-away torque. An integral of m
//! alone would by then have sent its reference far beyond, and the joint would hunt: with c*r*x added z stands still where
//! it has asked for 1/c of what is missing.
//!
//! While the setpoint rests, m with an output encoder passes a dead zone of half a count, its rounding: static friction
//! and the integral would respond to every change of the last count. z integrates the measured angle, not the estimated
//! one, whose error is that of the friction's structure. z only runs at slow setpoints: the error after a fast move, the
//! wind-up of a gear that is stiffer or softer than its model, changes its sign before z could follow. z and the shift are
//! limited. Where the motor cannot follow, or the supervisor has reduced the feedback, z stands still, and dz/dt is 0 in the
//! shift, too: a speed that follows y without the angle would be a feedback of its own. z is integrated in a slot after the
//! shift's. Discretisation: explicit Euler. Units: rad, rad/s, N m; signs as in [`crate::gear`].
//!
//! A. De Luca, W. Book, "Robots with flexible elements", Springer Handbook of Robotics (2016), chapter 11: damping by
//! link-side velocity, and the effect of the motor's lag on it.

use crate::compensator::tuned::{MOTOR_LAG, SLOW_SPEED};
use crate::constants::constants;
use crate::error::{Error, require};
use crate::low_pass::LowPass;
use crate::real::Real;

/// Gains of the output feedback for one set of sensors; all zero for none.
#[constants]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OutputFeedbackParams<R> {
    /// b in motion (s), 0..=1.
    pub damping: R,
    /// b at rest (s), 0..=1.
    pub damping_at_rest: R,
    /// k (1/s), 0..=1000.
    pub integral: R,
    /// omega_y (rad/s), 0..=1e5.
    pub filter_corner: R,
}

/// Half width of the dead zone of a resting output, in counts of its encoder: its rounding.
const DEAD_ZONE: f64 = 0.5;

/// The built output feedback.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutputFeedback<R> {
    /// Without and with an output encoder.
    gains: [OutputFeedbackParams<R>; 2],
    /// Each pole of y.
    filters: [LowPass<R>; 2],
    inverse_flexspline_inertia: R,
    /// Fastest setpoint at which z runs (rad/s).
    slow: R,
    /// Half width of the dead zone of a resting output (rad).
    dead_zone: R,
    /// Largest z, and shift by z and b (rad).
    largest: R,
    dt: R,
}

/// z, m behind the first and the second pole (rad), and b.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OutputFeedbackState<R> {
    integral: R,
    first_pole: R,
    filtered: R,
    /// b of the next shift (s), 0 before the first integration.
    damping: R,
    /// dz/dt (rad/s).
    integral_rate: R,
    /// m of the last slot (rad), whether it was measured, and whether the setpoint rested.
    error: R,
    measures: bool,
    rests: bool,
}

/// Error of the output against its setpoint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OutputError<R> {
    /// m where the output encoder reads, else e (rad).
    pub position: R,
    /// e' (rad/s).
    pub velocity: R,
    /// dq (rad/s).
    pub setpoint_velocity: R,
    /// J_fs*e'' (N m).
    pub torque: R,
    /// The output encoder reads.
    pub measures: bool,
}

/// Shift of the motor's reference, at the output.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shift<R> {
    /// (rad)
    pub angle: R,
    /// (rad/s)
    pub rate: R,
}

impl<R: Real> OutputFeedback<R> {
    /// From the gains without and with an output encoder, J_fs (kg m^2), the output's fastest speed (rad/s), one count of its encoder
    /// and the `largest` shift (rad), and the period dt of its slot (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the name of the gain outside its range, or `flexspline_inertia`.
    pub fn build(
        gains: &[OutputFeedbackParams<R>; 2],
        flexspline_inertia: R,
        fastest: R,
        count: R,
        largest: R,
        dt: R,
    ) -> Result<Self, Error> {
        let within = |value: R, most: f64| value >= R::ZERO && value <= R::lit(most);
        for set in gains {
            require(within(set.damping, 1.0), "damping")?;
            require(within(set.damping_at_rest, 1.0), "damping_at_rest")?;
            require(within(set.integral, 1000.0), "integral")?;
            require(within(set.filter_corner, 1e5), "filter_corner")?;
        }
        require(flexspline_inertia > R::ZERO, "flexspline_inertia")?;
        Ok(Self {
            gains: *gains,
            filters: [0, 1].map(|k: usize| LowPass::build(gains[k].filter_corner, dt)),
            inverse_flexspline_inertia: R::ONE / flexspline_inertia,
            slow: R::lit(SLOW_SPEED.get()) * fastest,
            dead_zone: R::lit(DEAD_ZONE) * count,
            largest,
            dt,
        })
    }

    /// Shift for an error of the output, in the feed-forward's slot, with the fraction `supervised` of b, 0..=1.
    #[inline(always)]
    pub fn step(
        &self,
        state: &mut OutputFeedbackState<R>,
        output: &OutputError<R>,
        supervised: R,
    ) -> Shift<R> {
        state.error = if self.is_slow(output.setpoint_velocity) { output.position } else { R::ZERO };
        state.rests = output.setpoint_velocity == R::ZERO;
        state.measures = output.measures;
        let damping = supervised * state.damping;
        let angle = damping * output.velocity + state.integral;
        let acceleration = output.torque * self.inverse_flexspline_inertia;
        let rate = damping * acceleration + state.integral_rate;
        Shift { angle: -angle.limit(self.largest), rate: -rate }
    }

    /// The setpoint is slow enough for z, and for P and D of the measured angle.
    #[inline(always)]
    pub fn is_slow(&self, setpoint_velocity: R) -> bool {
        setpoint_velocity.abs() < self.slow
    }

    /// Integrates z by the last error and `motor_lag`, r*x (rad), and chooses b of the next shift, in a later slot, which has more time;
    /// `runs` is false while the motor cannot follow, and z is held.
    #[inline(always)]
    pub fn integrate(&self, state: &mut OutputFeedbackState<R>, motor_lag: R, runs: bool) {
        let set = usize::from(state.measures);
        let (gains, filter) = (&self.gains[set], self.filters[set]);
        state.damping = if state.rests { gains.damping_at_rest } else { gains.damping };
        let dead_zone = if state.measures && state.rests { self.dead_zone } else { R::ZERO };
        let missing = state.error + R::lit(MOTOR_LAG.get()) * motor_lag;
        filter.step(&mut state.first_pole, missing.dead_zone(dead_zone));
        filter.step(&mut state.filtered, state.first_pole);
        let gain = if runs { gains.integral } else { R::ZERO };
        state.integral_rate = gain * state.filtered;
        state.integral = (state.integral + self.dt * state.integral_rate).limit(self.largest);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 4e-4;
    const INERTIA: f64 = 1.2;
    const STIFFNESS: f64 = 4e4;
    const LARGEST: f64 = 0.01;
    const GAINS: OutputFeedbackParams<f64> =
        OutputFeedbackParams { damping: 1.4e-3, damping_at_rest: 1.4e-3, integral: 0.0, filter_corner: 60.0 };

    fn feedback(gains: OutputFeedbackParams<f64>) -> OutputFeedback<f64> {
        OutputFeedback::build(&[gains; 2], INERTIA, 5.86, 1.2e-5, LARGEST, DT).unwrap()
    }

    fn stepped(
        feedback: &OutputFeedback<f64>,
        state: &mut OutputFeedbackState<f64>,
        output: &OutputError<f64>,
        runs: bool,
    ) -> Shift<f64> {
        let shift = feedback.step(state, output, 1.0);
        feedback.integrate(state, 0.0, runs);
        shift
    }

    /// Largest error after `seconds`, and the last, of a load on its spring, whose motor follows at once, that starts
    /// with an error of 1 mrad under a constant `load` (N m); the estimates are exact.
    fn decay(gains: OutputFeedbackParams<f64>, load: f64, seconds: f64) -> (f64, f64) {
        let (feedback, mut state) = (feedback(gains), OutputFeedbackState::default());
        let (mut e, mut rate, mut torque, mut largest) = (1e-3f64, 0.0, 0.0, 0.0f64);
        let periods = (seconds / DT) as usize;
        for k in 0..periods {
            let error = OutputError { position: e, velocity: rate, torque, ..OutputError::default() };
            let shift = stepped(&feedback, &mut state, &error, true);
            for _ in 0..16 {
                torque = STIFFNESS * (shift.angle - e) + load;
                rate += DT / 16.0 * torque / INERTIA;
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
    fn at_rest_the_damping_is_its_own() {
        let feedback = feedback(OutputFeedbackParams { damping_at_rest: 0.7e-3, ..GAINS });
        let mut state = OutputFeedbackState::default();
        let mut shift = |setpoint_velocity| {
            let error = OutputError { velocity: 1.0, setpoint_velocity, ..OutputError::default() };
            stepped(&feedback, &mut state, &error, true).angle
        };
        let shifts = [1e-3, 1e-3, 0.0, 0.0].map(&mut shift);
        assert_eq!(shifts, [0.0, -1.4e-3, -1.4e-3, -0.7e-3]);
    }

    #[test]
    fn the_integral_removes_the_steady_error() {
        let alone = 40.0 / STIFFNESS;
        let (_, damped) = decay(GAINS, 40.0, 2.0);
        assert!((damped - alone).abs() < 1e-3 * alone, "{damped}");
        let (_, integrated) = decay(OutputFeedbackParams { integral: 20.0, ..GAINS }, 40.0, 2.0);
        assert!(integrated.abs() < 1e-3 * alone, "{integrated}");
    }

    /// A motor that does not move: the reference goes beyond by 1/c of the error; without its lag, to the bound.
    #[test]
    fn a_motor_in_static_friction_is_not_sent_far() {
        const ERROR: f64 = 1e-3;
        let feedback = feedback(OutputFeedbackParams { integral: 30.0, ..GAINS });
        let shift = |moves: f64| {
            let (mut state, mut shift) = (OutputFeedbackState::default(), Shift::default());
            for _ in 0..5000 {
                let error = OutputError { position: ERROR, ..OutputError::default() };
                shift = feedback.step(&mut state, &error, 1.0);
                feedback.integrate(&mut state, (1.0 - moves) * shift.angle, true);
            }
            shift.angle
        };
        assert!((shift(0.0) + ERROR / MOTOR_LAG.get()).abs() < 1e-3 * ERROR, "{}", shift(0.0));
        assert_eq!(shift(1.0), -LARGEST);
    }

    /// The decay of the mode does not depend on an integral whose poles are at the mode.
    #[test]
    fn an_integral_with_its_poles_at_the_mode_takes_no_damping() {
        let frequency = (STIFFNESS / INERTIA).sqrt();
        let decayed = |integral, filter_corner| {
            decay(OutputFeedbackParams { integral, filter_corner, ..GAINS }, 0.0, 0.5).0
        };
        let (without, at_the_mode) = (decayed(0.0, frequency), decayed(0.2 * frequency, frequency));
        let far_above = decayed(0.2 * frequency, 10.0 * frequency);
        assert!(
            at_the_mode < 3.0 * without && far_above > 20.0 * without,
            "{without} {at_the_mode} {far_above}"
        );
    }

    #[test]
    fn the_shift_is_bounded_and_the_integral_waits() {
        let feedback = feedback(OutputFeedbackParams { integral: 30.0, ..GAINS });
        let far = OutputError { position: 1e3, velocity: 1e3, ..OutputError::default() };
        let mut state = OutputFeedbackState::default();
        for _ in 0..10_000 {
            assert!(stepped(&feedback, &mut state, &far, true).angle.abs() <= LARGEST);
        }
        let before = state.integral;
        stepped(&feedback, &mut state, &OutputError { position: -1e3, ..OutputError::default() }, false);
        assert_eq!((state.integral, state.integral_rate), (before, 0.0));
        let fast = OutputError { position: 1e-3, setpoint_velocity: 1.0, ..OutputError::default() };
        let mut state = OutputFeedbackState::default();
        stepped(&feedback, &mut state, &fast, true);
        assert_eq!((state.integral, state.integral_rate), (0.0, 0.0));
    }

    #[test]
    fn at_rest_the_rounding_of_the_encoder_is_not_integrated() {
        let feedback = feedback(OutputFeedbackParams { integral: 30.0, ..GAINS });
        let integral = |position, setpoint_velocity| {
            let mut state = OutputFeedbackState::default();
            let error = OutputError { position, measures: true, setpoint_velocity, ..OutputError::default() };
            stepped(&feedback, &mut state, &error, true);
            state.integral
        };
        assert_eq!(integral(5.9e-6, 0.0), 0.0);
        assert!(integral(5.9e-6, 0.1) > 0.0 && integral(6.1e-6, 0.0) > 0.0);
    }

    #[test]
    fn a_gain_out_of_range_is_named() {
        let build =
            |gains| OutputFeedback::build(&[GAINS, gains], INERTIA, 5.86, 1.2e-5, LARGEST, DT).unwrap_err();
        let named = |name| Error::OutOfRange(name);
        assert_eq!(build(OutputFeedbackParams { filter_corner: f64::NAN, ..GAINS }), named("filter_corner"));
        assert_eq!(build(OutputFeedbackParams { damping: -0.1, ..GAINS }), named("damping"));
        assert_eq!(build(OutputFeedbackParams { damping_at_rest: 1.1, ..GAINS }), named("damping_at_rest"));
        assert_eq!(build(OutputFeedbackParams { integral: 2000.0, ..GAINS }), named("integral"));
    }
}
