//! Gains of the compensation functions for either direction of the output.
//!
//! ```text
//! s = s_b + w*(s_f - s_b),   w = 1/2 + limit(v/(2*v_0), 1/2),   v_0 = 5 % of the output's top speed
//! ```
//!
//! s is a gain, s_f and s_b those of forward and backward motion, v the speed of the reference (rad/s): between -v_0 and
//! v_0 they are interpolated, so that no gain steps where the motion reverses.

use crate::compensator::CompensationGains;
use crate::compensator::tuned::SLOW_SPEED;
use crate::constants::constants;
use crate::real::Real;

/// The gains for forward and for backward motion of the output.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Directions<R> {
    /// For a positive speed.
    pub forward: CompensationGains<R>,
    /// For a negative speed.
    pub backward: CompensationGains<R>,
}

impl<R: Real> From<CompensationGains<R>> for Directions<R> {
    fn from(both: CompensationGains<R>) -> Self {
        Self { forward: both, backward: both }
    }
}

/// The built crossover.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossover<R> {
    /// 1/(2*v_0) (s/rad).
    slope: R,
}

impl<R: Real> Crossover<R> {
    /// For an output of this top speed, positive (rad/s).
    pub fn build(top_speed: R) -> Self {
        Self { slope: R::lit(0.5 / SLOW_SPEED.get()) / top_speed }
    }

    /// w at a speed (rad/s): the weight of the forward direction.
    #[inline(always)]
    pub fn forward(&self, velocity: R) -> R {
        R::lit(0.5) + (velocity * self.slope).limit(R::lit(0.5))
    }
}
