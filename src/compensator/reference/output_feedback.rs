//! Output feedback: the motor's reference gives way so that the output behaves like a well-damped reference model.
//!
//! ```text
//! e      = theta_fs - q,   e' = omega_fs - dq,   e'' = (tau_t - tau_fric_out + d - J_fs*ddq)/J_fs
//! shift  = -(a*e + b*e' + z),   dshift = -(a*e' + b*e'' + k*m),   dz/dt = k*m
//! ```
//!
//! theta_fs, omega_fs, tau_t and tau_fric_out are the observer's, q the setpoint, J_fs as the feed-forward winds the
//! gear up for it, and the external torque d too, but for one that comes suddenly, which counts at once
//! ([`FollowedLoad::at_once`]). The friction is that of the believed motion: at rest it holds whatever there is, and
//! so the shift rests with it. m is e, less what an output encoder hides. The shift (rad at the output) is added to
//! where the motor side should be, and the cascade follows it. With a motor that follows, the load on its spring,
//! J_fs*e'' = K*(shift - e), obeys the reference model
//!
//! ```text
//! e'' + 2*zeta*omega_m*e' + omega_m^2*e = 0,     omega_m^2 = (1 + a)*K/J_fs,   2*zeta*omega_m = b*K/J_fs
//! ```
//!
//! a stiffens the joint against its load, b damps the torsional vibration, k takes away what stays. Lyapunov: with V
//! = (e'^2 + omega_m^2*e^2)/2, dV/dt = -2*zeta*omega_m*e'^2 <= 0, and LaSalle gives e -> 0; the motor's own lag is
//! not in it: that the loop stays quiet with the cascade and its filter is judged on gears all over the box that a
//! controller may meet (`strainwave verify compensator`).
//!
//! Where the setpoint rests, m with an output encoder is what of e exceeds 0.4 of its counts: static friction and the
//! integral would answer every change of the last count. It is the believed output that is fed back, not the measured
//! one, which changes by whole counts. z only runs where the setpoint is slow: what a fast move leaves, the wind-up
//! of a gear that is stiffer or softer than believed, changes its sign before z could follow. z and the shift are
//! limited. Discretisation: explicit Euler for z. Units: rad, rad/s, N m; signs as in [`crate::gear`].
//!
//! A. Albu-Schaeffer, Ch. Ott, G. Hirzinger, "A unified passivity-based control framework for position, torque and
//! impedance control of flexible joint robots", International Journal of Robotics Research 26 (2007).
//!
//! [`FollowedLoad::at_once`]: crate::compensator::estimate::disturbance::FollowedLoad::at_once

use crate::error::{Error, require};
use crate::real::Real;

/// Gains of the output feedback for one set of sensors; all zero for none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OutputFeedbackParams<R> {
    /// a, 0..=10.
    pub stiffening: R,
    /// b (s), 0..=1.
    pub damping: R,
    /// k (1/s), 0..=1000.
    pub integral: R,
}

/// Largest shift of the motor's reference, at the output (rad): more than peak torque winds a gear up.
const LARGEST: f64 = 0.01;

/// Fastest setpoint at which z runs, as a share of the joint's fastest speed.
const SLOW: f64 = 0.05;
/// What of a resting output its encoder does not show, in counts.
const HIDDEN: f64 = 0.4;

/// The built output feedback.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutputFeedback<R> {
    /// Without and with an output encoder.
    gains: [OutputFeedbackParams<R>; 2],
    inverse_flexspline_inertia: R,
    /// Fastest setpoint at which z runs (rad/s).
    slow: R,
    /// What a count of the output encoder hides (rad).
    hidden: R,
    dt: R,
}

/// z (rad).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OutputFeedbackState<R> {
    integral: R,
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
    /// J_fs*e'' (N m).
    pub torque: R,
    /// An output encoder shows it.
    pub measured: bool,
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
    /// From the gains without and with an output encoder, J_fs (kg m^2), the output's fastest speed (rad/s), one
    /// count of its encoder (rad) and the time dt between its turns (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `stiffening`, `damping`, `integral` or `flexspline_inertia`.
    pub fn build(
        gains: &[OutputFeedbackParams<R>; 2],
        flexspline_inertia: R,
        fastest: R,
        count: R,
        dt: R,
    ) -> Result<Self, Error> {
        let within = |value: R, most: f64| value >= R::ZERO && value <= R::lit(most);
        for set in gains {
            require(within(set.stiffening, 10.0), "stiffening")?;
            require(within(set.damping, 1.0), "damping")?;
            require(within(set.integral, 1000.0), "integral")?;
        }
        require(flexspline_inertia > R::ZERO, "flexspline_inertia")?;
        Ok(Self {
            gains: *gains,
            inverse_flexspline_inertia: R::ONE / flexspline_inertia,
            slow: R::lit(SLOW) * fastest,
            hidden: R::lit(HIDDEN) * count,
            dt,
        })
    }

    /// m.
    #[inline(always)]
    fn error(&self, deviation: &Deviation<R>) -> R {
        let speed = deviation.asked_velocity.abs();
        if speed >= self.slow {
            return R::ZERO;
        }
        let hidden = if deviation.measured && speed == R::ZERO { self.hidden } else { R::ZERO };
        deviation.position - deviation.position.limit(hidden)
    }

    /// One turn; `runs` is false while the motor cannot follow, and z stands still.
    #[inline(always)]
    pub fn step(&self, state: &mut OutputFeedbackState<R>, deviation: &Deviation<R>, runs: bool) -> Shift<R> {
        let gains = &self.gains[usize::from(deviation.measured)];
        let to_integrate = gains.integral * self.error(deviation);
        if runs {
            state.integral = (state.integral + self.dt * to_integrate).limit(R::lit(LARGEST));
        }
        let acceleration = deviation.torque * self.inverse_flexspline_inertia;
        let angle =
            gains.stiffening * deviation.position + gains.damping * deviation.velocity + state.integral;
        let rate = gains.stiffening * deviation.velocity + gains.damping * acceleration + to_integrate;
        Shift { angle: -angle.limit(R::lit(LARGEST)), rate: -rate }
    }
}

#[cfg(test)]
mod tests {
    use std::vec;
    use std::vec::Vec;

    use super::*;

    const DT: f64 = 1e-4;
    const INERTIA: f64 = 1.2;
    const STIFFNESS: f64 = 4e4;
    const GAINS: OutputFeedbackParams<f64> =
        OutputFeedbackParams { stiffening: 0.5, damping: 0.0081, integral: 0.0 };

    fn feedback(gains: OutputFeedbackParams<f64>) -> OutputFeedback<f64> {
        OutputFeedback::build(&[gains; 2], INERTIA, 5.86, 1.2e-5, DT).unwrap()
    }

    /// Largest deviation after each quarter second of a load on its spring, whose motor follows at once, that starts
    /// 1 mrad off under a constant `load` (N m); what the observer knows of it is taken for the truth.
    fn decay(gains: OutputFeedbackParams<f64>, load: f64, seconds: f64) -> (Vec<f64>, f64) {
        let (feedback, mut state) = (feedback(gains), OutputFeedbackState::default());
        let (mut e, mut rate, mut torque) = (1e-3, 0.0, 0.0);
        let mut largest = vec![0.0; (seconds * 4.0) as usize];
        for k in 0..(seconds / DT) as usize {
            let deviation =
                Deviation { position: e, velocity: rate, torque, measured: false, asked_velocity: 0.0 };
            let shift = feedback.step(&mut state, &deviation, true);
            torque = STIFFNESS * (shift.angle - e);
            rate += DT * (torque + load) / INERTIA;
            e += DT * rate;
            let place = (k as f64 * DT * 4.0) as usize;
            largest[place] = f64::max(largest[place], e.abs());
        }
        (largest, e)
    }

    /// omega_m^2 = (1 + a)*K/J and 2*zeta*omega_m = b*K/J.
    #[test]
    fn a_load_obeys_the_reference_model() {
        let frequency = (1.5 * STIFFNESS / INERTIA).sqrt();
        let damping = GAINS.damping * STIFFNESS / INERTIA / (2.0 * frequency);
        assert!((0.59..0.62).contains(&damping), "{damping}");
        let (with, _) = decay(GAINS, 0.0, 0.5);
        let (without, _) = decay(OutputFeedbackParams::default(), 0.0, 0.5);
        assert!(with[1] < 1e-3 * (-0.9 * damping * frequency * 0.25).exp(), "{with:?}");
        assert!(without[1] > 0.99e-3, "{without:?}");
    }

    #[test]
    fn what_stays_is_less_by_the_stiffening_and_gone_with_the_integral() {
        let alone = 40.0 / STIFFNESS;
        let (_, stiffened) = decay(GAINS, 40.0, 2.0);
        assert!((stiffened - alone / 1.5).abs() < 1e-3 * alone, "{stiffened}");
        let (_, integrated) = decay(OutputFeedbackParams { integral: 20.0, ..GAINS }, 40.0, 2.0);
        assert!(integrated.abs() < 1e-3 * alone, "{integrated}");
    }

    #[test]
    fn the_shift_is_bounded_and_the_integral_waits() {
        let feedback = feedback(OutputFeedbackParams { integral: 30.0, ..GAINS });
        let far = Deviation { position: 1e3, velocity: 1e3, ..Deviation::default() };
        let mut state = OutputFeedbackState::default();
        for _ in 0..10_000 {
            assert!(feedback.step(&mut state, &far, true).angle.abs() <= LARGEST);
        }
        for (deviation, runs) in [
            (Deviation { position: 1e-3, ..Deviation::default() }, false),
            (Deviation { position: 1e-3, asked_velocity: 1.0, ..Deviation::default() }, true),
        ] {
            let before = state;
            feedback.step(&mut state, &deviation, runs);
            assert_eq!(state, before);
        }
    }

    #[test]
    fn at_rest_the_last_count_moves_nothing() {
        let feedback = feedback(OutputFeedbackParams { integral: 30.0, ..GAINS });
        let integral = |position, asked_velocity| {
            let mut state = OutputFeedbackState::default();
            let deviation = Deviation { position, measured: true, asked_velocity, ..Deviation::default() };
            feedback.step(&mut state, &deviation, true);
            state.integral
        };
        assert_eq!(integral(4.7e-6, 0.0), 0.0);
        assert!(integral(4.7e-6, 0.1) > 0.0 && integral(6e-6, 0.0) > 0.0);
    }

    #[test]
    fn a_gain_out_of_range_is_named() {
        let build = |gains| OutputFeedback::build(&[GAINS, gains], INERTIA, 5.86, 1.2e-5, DT).unwrap_err();
        let named = |name| Error::OutOfRange(name);
        assert_eq!(build(OutputFeedbackParams { stiffening: f64::NAN, ..GAINS }), named("stiffening"));
        assert_eq!(build(OutputFeedbackParams { damping: -0.1, ..GAINS }), named("damping"));
        assert_eq!(build(OutputFeedbackParams { integral: 2000.0, ..GAINS }), named("integral"));
    }
}
