//! Standard deviations of the estimates.
//!
//! ```text
//! s_in   = b_in  + u_F*|tau_fric_in|            s_out = b_out*(1 - |omega_fs|/v_s, at least a tenth) + u_F*|tau_fric_out|
//! e     += g*(l_d.innovation - e)                persistent correction of d by the innovations, low-passed
//! h      = max(T*|e|, (1 - 1/T)*h)               residual of d; T: slowest mode of the observer (periods)
//! w      = w + rated*T_o while the motor stands, up to rated/sqrt(3); 0 where it moves, or where the output is measured
//! s_t    = b_t + n*s_in + u_K*|tau_t|*k + h + w
//! s_d    = b_d + s_t - b_t + s_out + u_J*J_fs*|ddtheta_fs|
//! s_phi  = b_phi + c*s_t + u_K*|phi|*a           output angle alike
//! s_omega= b_omega + c'*(h + u_K*a*K*|dphi|)
//! ```
//!
//! b is the steady-state covariance of the Kalman filter, computed off line for each set of sensors. u_F, u_K, u_J
//! are the declared uncertainties of friction, stiffness and inertia: a uniform span over sqrt(3). n, k, a, c are their
//! sensitivities with this set of sensors: with the motor's encoder alone the torque follows from the motor's, less its
//! friction (n = 1/|r|), and the torsion from the torque; with the output's the torsion is measured, and where the motor
//! stands the torque follows from it (k = 1). Torque in N m, angle in rad.
//!
//! Evaluated once in about [`PERIODS`] periods T_o of the observer, with the sum of the corrections of d in them, and
//! held in between; while a gain is ramped, once in half as many again.
//!
//! It is a declared uncertainty, not a propagated covariance: terms are added as if fully correlated, so that the true
//! error lies inside three of them at least as often as a normal distribution would have it. A load that a standing
//! motor cannot observe (a brake may hold any) is covered by w.

use crate::compensator::EstimateDeviation;
use crate::compensator::schedule::{CONTROL_PERIOD, OBSERVER_PERIODS, SLOW_PERIODS};
use crate::compensator::tuned::FAULT_TIME;
use crate::constants::constants;
use crate::real::Real;

/// Periods of the observer from one evaluation to the next.
pub const PERIODS: u32 = 2 * SLOW_PERIODS / OBSERVER_PERIODS;

/// [`PERIODS`] as a number.
const STEP: f64 = PERIODS as f64;

/// Period of the observer (s).
const OBSERVER_PERIOD: f64 = OBSERVER_PERIODS as f64 * CONTROL_PERIOD;

/// Uncertainty of the model: standard deviations relative to the parameter.
#[constants]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Uncertainty<R> {
    /// u_F, of the friction of either side.
    pub friction: R,
    /// u_K, of the stiffness.
    pub stiffness: R,
    /// u_J*J_fs, of the inertia of flexspline and load (kg m^2).
    pub inertia: R,
}

/// Coefficients of the standard deviations for one set of sensors.
#[constants]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread<R> {
    /// b.
    pub base: EstimateDeviation<R>,
    /// n, torque at the output per friction at the wave generator.
    pub torque_by_friction: R,
    /// k, 1 where the torque follows from the torsion.
    pub torque_by_stiffness: R,
    /// a, 1 where the torsion follows from the torque.
    pub angle_by_stiffness: R,
    /// c (rad/(N m)).
    pub angle_by_torque: R,
    /// c' (rad/(N m s)).
    pub velocity_by_torque: R,
    /// Rate of w (N m per period of the observer), and its largest value (N m).
    pub unobserved: [R; 2],
    /// T (periods of the observer).
    pub settling: R,
    /// 1/T.
    pub inverse_settling: R,
    /// 1/v_s, v_s the Stribeck speed of the output (s/rad).
    pub inverse_sliding_speed: R,
}

/// State of the standard deviations.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpreadState<R> {
    /// e (N m per period of the observer).
    correction_mean: R,
    /// h (N m).
    residual: R,
    /// w (N m).
    unobserved: R,
}

/// Magnitudes that the standard deviations scale with, from the observer's last period.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Magnitudes<R> {
    /// l_d.innovation, all of the [`PERIODS`] (N m).
    pub load_correction: R,
    /// The motor moved lately.
    pub moved: bool,
    /// tau_fric_in (N m).
    pub input_friction: R,
    /// tau_fric_out (N m).
    pub output_friction: R,
    /// tau_t (N m).
    pub transmitted: R,
    /// phi (rad).
    pub torsion: R,
    /// dphi (rad/s).
    pub torsion_rate: R,
    /// omega_fs (rad/s).
    pub output_speed: R,
    /// ddtheta_fs (rad/s^2).
    pub acceleration: R,
}

impl<R: Real> Spread<R> {
    /// Every coefficient is finite.
    pub fn is_finite(&self) -> bool {
        let EstimateDeviation {
            output_position,
            output_velocity,
            torsion,
            transmitted_torque,
            input_friction,
            output_friction,
            external_torque,
        } = self.base;
        [
            [output_position, output_velocity, torsion, transmitted_torque],
            [input_friction, output_friction, external_torque, self.settling],
            [
                self.torque_by_friction,
                self.torque_by_stiffness,
                self.angle_by_stiffness,
                self.angle_by_torque,
            ],
            [self.velocity_by_torque, self.unobserved[0], self.unobserved[1], self.inverse_settling],
        ]
        .iter()
        .flatten()
        .chain([&self.inverse_sliding_speed])
        .all(|number| number.is_finite())
    }

    /// Standard deviations after [`PERIODS`] more periods; `uncertainty` is the model's.
    #[inline(always)]
    pub fn step(
        &self,
        state: &mut SpreadState<R>,
        uncertainty: &Uncertainty<R>,
        now: &Magnitudes<R>,
    ) -> EstimateDeviation<R> {
        let Uncertainty { friction, stiffness, inertia } = *uncertainty;
        let residual = self.residual(state, now.load_correction);
        let unobserved = self.unobserved(state, now.moved);
        let input_friction = self.base.input_friction + friction * now.input_friction.abs();
        let resting = (R::ONE - now.output_speed.abs() * self.inverse_sliding_speed).max(R::lit(0.1));
        let output_friction = self.base.output_friction * resting + friction * now.output_friction.abs();
        let torque = self.torque_by_friction * input_friction
            + self.torque_by_stiffness * stiffness * now.transmitted.abs()
            + residual
            + unobserved;
        let flexible = stiffness * self.angle_by_stiffness;
        let angle = self.angle_by_torque * torque + flexible * now.torsion.abs();
        EstimateDeviation {
            output_position: self.base.output_position + angle,
            output_velocity: self.base.output_velocity
                + self.velocity_by_torque * residual
                + flexible * now.torsion_rate.abs(),
            torsion: self.base.torsion + angle,
            transmitted_torque: self.base.transmitted_torque + torque,
            input_friction,
            output_friction,
            external_torque: self.base.external_torque
                + torque
                + output_friction
                + inertia * now.acceleration.abs(),
        }
    }

    /// h: residual of d that the innovations show.
    #[inline(always)]
    fn residual(&self, state: &mut SpreadState<R>, load_correction: R) -> R {
        let filter = R::lit(1.0 / f64::from(FAULT_TIME.periods(OBSERVER_PERIOD)));
        state.correction_mean += filter * (load_correction - R::lit(STEP) * state.correction_mean);
        let fallen = state.residual - R::lit(STEP) * state.residual * self.inverse_settling;
        state.residual = (self.settling * state.correction_mean.abs()).max(fallen);
        state.residual
    }

    /// w: load that the sensors do not observe.
    #[inline(always)]
    fn unobserved(&self, state: &mut SpreadState<R>, moved: bool) -> R {
        let [rate, most] = self.unobserved;
        state.unobserved = if moved { R::ZERO } else { (state.unobserved + R::lit(STEP) * rate).min(most) };
        state.unobserved
    }
}
