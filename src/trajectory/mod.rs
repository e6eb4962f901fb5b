//! Moves from rest to rest with bounded velocity, acceleration, jerk and snap, planned and stepped on target.
//!
//! ```text
//! dx/dt = D * b(T_v) * b(T_a) * b(T_j) * b(T_s)     b(T): 1/T over 0..T; * is convolution
//! v = D/T_v,   a = v/T_a,   j = a/T_j,   s = j/T_s                                  levels reached
//! T_j >= T_s,   T_a >= T_j + T_s,   T_v >= T_a + T_j + T_s                  so that they are reached
//! T = T_v + T_a + T_j + T_s                                                         length of the move
//!
//! s  + 0 - 0 - 0 + 0 - 0 + 0 + 0 -     15 segments, of T_s, T_j - T_s, T_s, T_a - T_j - T_s, T_s, ...
//! ```
//!
//! D is the distance. Units: rad, s, and what follows from them; D has the sign of the move, and with it every
//! level. Between corners the snap is constant and the position a polynomial of fourth order. The second half is the
//! first, mirrored in time and counted back from the target: the last setpoint is the target, to the bit.
//!
//! Planning takes the widths from the inside out, each as wide as its limits allow and the distance needs. It is
//! the shortest of these profiles, but for whole control periods (at most 15 more). One whose snap need not return to
//! zero at the highest speed would be up to 7 % shorter, where snap alone limits: (384/512)^(1/4).
//!
//! Discretisation: none; corners lie at whole control periods, where the polynomials are evaluated. A width is rounded
//! up, which only lowers the levels. No angle is a bare float: a segment's position counts from
//! an exact [`Angle`], at full speed as a whole number of 2^-32 counts a period. In f32 position is within [`SEAM`]
//! of the distance of the exact profile, and where the halves of a move meet without a stretch of full speed it steps
//! by no more.
//!
//! A new target is taken up only from rest. [`Move::stop`] comes to rest within the limits from any instant: it is the
//! same move with what had not begun yet left out, so it agrees with it up to that instant.
//!
//! P. Lambrechts, M. Boerlage, M. Steinbuch, "Trajectory planning and feedforward design for electromechanical
//! motion systems", Control Engineering Practice 13 (2005).

mod cyclic;
mod full_speed;
mod ramp;
mod rest_to_rest;
#[cfg(test)]
mod tests;
mod widths;

pub use cyclic::{Cyclic, CyclicState};
pub use rest_to_rest::{Move, MoveState};

use crate::angle::Angle;
use crate::error::{Error, require};
use crate::real::Real;
use widths::Widths;

/// Farthest of an f32 position from the exact profile, per distance.
pub const SEAM: f64 = 1e-6;

/// The limits are kept by this much, so that rounding stays inside.
const MARGIN: f64 = 1.0 / 1_048_576.0;

/// Farthest move (counts): a difference of angles is then far from its end.
const FARTHEST: u64 = 1 << 46;

/// Limits of every move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrajectoryParams<R> {
    /// Largest speed, > 0 (rad/s).
    pub velocity: R,
    /// Largest acceleration, > 0 (rad/s^2).
    pub acceleration: R,
    /// Largest jerk, > 0 (rad/s^3).
    pub jerk: R,
    /// Largest snap, > 0 (rad/s^4).
    pub snap: R,
}

/// Plans moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trajectory<R> {
    limits: TrajectoryParams<R>,
    dt: R,
}

impl<R: Real> TrajectoryParams<R> {
    /// Prepares planning for the control period dt (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `dt` outside 1e-6..=1, or the name of the first limit that is not finite and positive.
    pub fn build(&self, dt: R) -> Result<Trajectory<R>, Error> {
        require(dt >= R::lit(1e-6) && dt <= R::ONE, "dt")?;
        let kept = |limit: R, name| {
            require(limit.is_positive(), name)?;
            Ok(limit * R::lit(1.0 - MARGIN))
        };
        let limits = Self {
            velocity: kept(self.velocity, "velocity")?,
            acceleration: kept(self.acceleration, "acceleration")?,
            jerk: kept(self.jerk, "jerk")?,
            snap: kept(self.snap, "snap")?,
        };
        Ok(Trajectory { limits, dt })
    }
}

impl<R: Real> Trajectory<R> {
    /// Rest at an angle: a move that is done.
    pub fn rest(&self, at: Angle<R>) -> Move<R> {
        Move::rest(at, self.dt)
    }

    /// The move from rest at `start` to rest at `target`. Takes no more than 100 trials of a width.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `distance` when it is not finite, is beyond 2^14 revolutions, takes more than 2^24 control
    /// periods, or takes more than half a revolution to the highest speed.
    pub fn plan(&self, start: Angle<R>, target: Angle<R>) -> Result<Move<R>, Error> {
        const NAME: &str = "distance";
        // Any bits become an angle whose fraction is one.
        let (start, target) = (start.plus(R::ZERO), target.plus(R::ZERO));
        require(target.less(start).counts.unsigned_abs() < FARTHEST, NAME)?;
        let distance = target.minus(start);
        let widths = Widths::shortest(&self.limits, distance.abs(), self.dt);
        Move::over(start, target, widths.ok_or(Error::OutOfRange(NAME))?, self.dt)
    }
}
