//! Where the motor is sent from one plan of the feed-forward to the next: on by the acceleration, jerk and torque rate
//! that were planned.
//!
//! ```text
//! ahead <- ahead + dt*(omega + dt*a/2 + v),   omega <- omega + dt*a,   a <- a + dt*j,   tau <- tau + dt*dtau
//! ```
//!
//! dt is the control period, v the speed of the wind-up response to a load
//! ([`crate::compensator::estimate::disturbance`]). The reference is kept relative to the motor's encoder, theta_ref - theta: small, so that
//! an f32 holds it. What the encoder has moved is taken off it as soon as it is read. Units: rad, s, N m at the motor's
//! shaft; signs as in [`crate::gear`].

use crate::angle::Angle;
use crate::real::{RADIANS_PER_COUNT, Real};

/// Where the motor is sent, from one plan to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::compensator) struct Course<R> {
    /// theta_ref - theta (rad), dtheta_ref (rad/s), ddtheta_ref (rad/s^2) and its rate.
    pub(in crate::compensator) ahead: R,
    pub(in crate::compensator) velocity: R,
    pub(in crate::compensator) acceleration: R,
    pub(in crate::compensator) jerk: R,
    /// Share of the acceleration that the cascade knows of.
    pub(in crate::compensator) known: R,
    /// Feed-forward (N m).
    pub(in crate::compensator) torque: R,
    pub(in crate::compensator) torque_rate: R,
    pub(in crate::compensator) transmission: R,
    pub(in crate::compensator) wound: R,
    /// Torque at the output flange in the place of a motion (N m).
    pub(in crate::compensator) output_torque: Option<R>,
    /// The joint is asked to rest.
    pub(in crate::compensator) rests: bool,
    /// The command is of another kind than the last one.
    pub(in crate::compensator) switched: bool,
    /// There is a plan.
    pub(in crate::compensator) planned: bool,
    /// There is one, of a motion: the cascade's feedback acts.
    pub(in crate::compensator) closed: bool,
}

impl<R: Real> Course<R> {
    /// Speed that the motor is asked for (rad/s). Where a torque is commanded no motion is.
    #[inline(always)]
    pub(in crate::compensator) fn asked(&self) -> R {
        if self.output_torque.is_some() { R::ZERO } else { self.velocity }
    }

    /// Where a motor that is at `motor` is sent, to a count.
    #[inline(always)]
    pub(in crate::compensator) fn reference(&self, motor: Angle<R>) -> Angle<R> {
        let ahead = (self.ahead * R::lit(1.0 / RADIANS_PER_COUNT)).to_i32();
        Angle::from_counts(motor.counts.wrapping_add(i64::from(ahead)))
    }

    /// One control period dt (s) later, with the motor sent on by another `velocity` (rad/s).
    #[inline(always)]
    pub(in crate::compensator) fn advance(&mut self, velocity: R, dt: R) {
        let change = dt * self.acceleration;
        let speed = self.velocity + velocity;
        self.ahead += dt * (speed + R::lit(0.5) * change);
        self.velocity += change;
        self.acceleration += dt * self.jerk;
        self.torque += dt * self.torque_rate;
    }
}
