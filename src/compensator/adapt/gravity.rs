//! Gravity, or another constant load: the part of the external torque that is a function of the output's angle.
//!
//! ```text
//! g(q) = s*sin(q) + c*cos(q)                                        torque on the flexspline
//! s <- limit(s + dt*gamma_s*sin(q)*d, g_max),   c <- limit(c + dt*gamma_c*cos(q)*d, g_max)       while the setpoint moves
//! ```
//!
//! q is the setpoint, d the residual external torque of an observer whose model includes g (series-parallel, as in
//! [`super::parameters`]): the gradient law, with V = (s - s*)^2/(2*gamma_s) + (c - c*)^2/(2*gamma_c) and dV/dt = -d^2 for
//! a d that is gravity's alone. Nothing is learnt at rest, where static friction hides a load. In motion the friction's
//! error changes its sign with the speed, gravity does not: the rates are slow against a reversal.
//!
//! g is fed forward: the gear is wound up for it, the motor's torque contains it, and the factors on inertia and friction
//! no longer learn from it. Explicit Euler. Units: rad, N m.

use crate::angle::Heading;
use crate::compensator::tuned::{RARE_RATE, SLOW_RATE};
use crate::constants::constants;
use crate::real::Real;

/// The built law.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gravity<R> {
    /// dt*gamma_c, dt*gamma_s.
    gains: [R; 2],
    /// g_max (N m).
    largest: R,
}

/// c and s (N m).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GravityState<R> {
    cosine: R,
    sine: R,
}

impl<R: Real> Gravity<R> {
    /// For a gear of this rated torque (N m), with dt (s) from step to step.
    pub fn build(rated_torque: R, dt: R) -> Self {
        Self {
            gains: [SLOW_RATE, RARE_RATE].map(|rate| (R::lit(rate.get()) * dt).min(R::lit(0.5))),
            largest: rated_torque,
        }
    }

    /// Learns from a residual external torque (N m), at an angle of this heading.
    #[inline(always)]
    pub fn step(&self, state: &mut GravityState<R>, at: &Heading<R>, external_torque: R) {
        let [cosine, sine] = self.gains;
        state.cosine = (state.cosine + cosine * at.cosine * external_torque).limit(self.largest);
        state.sine = (state.sine + sine * at.sine * external_torque).limit(self.largest);
    }
}

impl<R: Real> GravityState<R> {
    /// g at an angle of this heading (N m).
    #[inline(always)]
    pub fn torque(&self, at: &Heading<R>) -> R {
        self.sine * at.sine + self.cosine * at.cosine
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 1e-3;

    fn heading(angle: f64) -> Heading<f64> {
        Heading { cosine: angle.cos(), sine: angle.sin() }
    }

    /// Largest residual of a torque of the angle, after a minute of motion within half a radian.
    fn residual_after(torque: impl Fn(f64) -> f64) -> f64 {
        let (law, mut state) = (Gravity::build(67.0, DT), GravityState::default());
        let mut largest = 0.0f64;
        for k in 0..60_000 {
            let angle = 0.5 * (3.0 * DT * f64::from(k)).sin();
            let residual = torque(angle) - state.torque(&heading(angle));
            law.step(&mut state, &heading(angle), residual);
            if k > 55_000 {
                largest = largest.max(residual.abs());
            }
        }
        largest
    }

    #[test]
    fn gravity_in_any_posture_is_learnt() {
        for posture in [0.0, 0.7, 1.5, -2.0] {
            assert!(residual_after(|angle| 40.0 * (angle + posture).sin()) < 0.4, "{posture}");
        }
    }

    #[test]
    fn the_torque_is_bounded() {
        let (law, mut state) = (Gravity::build(67.0, DT), GravityState::default());
        for torque in [1e30, f64::MAX, -1e30] {
            law.step(&mut state, &heading(0.7), torque);
            assert!(state.torque(&heading(0.3)).abs() <= 2.0 * 67.0);
        }
    }
}
