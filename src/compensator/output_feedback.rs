//! Output feedback: the motor's reference gives way so that the output behaves like a well-damped reference model.
//!
//! ```text
//! e      = theta_fs - q,   e' = omega_fs - dq,   e'' = (tau_t - tau_asked)/(s_J*J_fs)
//! shift  = -(a*e + b*e' + z),   dshift = -(a*e' + b*e'' + k*m),   dz/dt = k*m
//! ```
//!
//! theta_fs, omega_fs and tau_t are the observer's, q the setpoint, tau_asked what the feed-forward winds the gear up for;
//! m is e, or the measured output less q where an output encoder shows it. The shift (rad at the output) is added to where the motor
//! side should be, and the cascade follows it. With a motor that follows, the load on its spring,
//! J_fs*e'' = K*(shift - e), obeys the reference model
//!
//! ```text
//! e'' + 2*zeta*omega_m*e' + omega_m^2*e = 0,     omega_m^2 = (1 + a)*K/J_fs,   2*zeta*omega_m = b*K/J_fs
//! ```
//!
//! a stiffens the joint against its load, b damps the torsional vibration, k takes away what stays. Lyapunov: with
//! V = (e'^2 + omega_m^2*e^2)/2, dV/dt = -2*zeta*omega_m*e'^2 <= 0, and LaSalle gives e -> 0; the motor's own lag is
//! kept out by b: over the whole box of gears that a controller may meet, the linearised loop with the cascade, its filter and
//! its integral keeps a damping ratio above 0.4 (`desktop/src/joint.rs`).
//!
//! z and the shift are limited. Discretisation: explicit Euler for z. Units: rad, rad/s, N m; signs as in [`crate::gear`].
//!
//! A. Albu-Schaeffer, Ch. Ott, G. Hirzinger, "A unified passivity-based control framework for position, torque and impedance
//! control of flexible joint robots", International Journal of Robotics Research 26 (2007).

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

/// The built output feedback.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutputFeedback<R> {
    /// Without and with an output encoder.
    gains: [OutputFeedbackParams<R>; 2],
    inverse_flexspline_inertia: R,
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
    /// tau_t - tau_asked (N m).
    pub torque: R,
    /// Measured output less setpoint (rad), where there is an output encoder.
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
    /// From the gains without and with an output encoder, J_fs (kg m^2) and the control period dt (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `stiffening`, `damping`, `integral` or `flexspline_inertia`.
    pub fn build(
        gains: &[OutputFeedbackParams<R>; 2],
        flexspline_inertia: R,
        dt: R,
    ) -> Result<Self, Error> {
        let within = |value: R, most: f64| value >= R::ZERO && value <= R::lit(most);
        for set in gains {
            require(within(set.stiffening, 10.0), "stiffening")?;
            require(within(set.damping, 1.0), "damping")?;
            require(within(set.integral, 1000.0), "integral")?;
        }
        require(flexspline_inertia > R::ZERO, "flexspline_inertia")?;
        Ok(Self { gains: *gains, inverse_flexspline_inertia: R::ONE / flexspline_inertia, dt })
    }

    /// One control period; `runs` is false while the motor cannot follow, and z stands still.
    #[inline(always)]
    pub fn step(&self, state: &mut OutputFeedbackState<R>, deviation: &Deviation<R>, runs: bool) -> Shift<R> {
        let gains = &self.gains[usize::from(deviation.measured.is_some())];
        let to_integrate = gains.integral * deviation.measured.unwrap_or(deviation.position);
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
