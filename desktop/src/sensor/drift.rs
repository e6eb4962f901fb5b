//! Drift of a sensor's zero: a Gauss-Markov process of first order.
//!
//! ```text
//! b1 = b0*e^(-dt/T) + sigma*sqrt(1 - e^(-2*dt/T))*z,   z normal, b = 0 where it is switched on and set to zero
//! variance after t: sigma^2*(1 - e^(-2*t/T))
//! ```
//!
//! Exact for any step. Long before T it is a random walk of sigma*sqrt(2*t/T), long after it stays within sigma, and two
//! values T apart have a correlation of 1/e. Units: sigma as the reading, s.

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use strainwave::Error;

use super::{is_size, require};

/// How far and how fast the zero drifts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DriftParams {
    /// sigma, in the unit of the reading; not negative, 0 for none.
    pub deviation: f64,
    /// T (s); positive where there is a drift.
    pub time: f64,
}

/// Built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Drift {
    kept: f64,
    /// Deviation of what comes in a step; 0 draws no random number.
    step: f64,
}

impl DriftParams {
    pub(super) fn build(&self, dt: f64) -> Result<Drift, Error> {
        require(is_size(self.deviation), "drift")?;
        if self.deviation == 0.0 {
            return Ok(Drift { kept: 1.0, step: 0.0 });
        }
        require(self.time.is_finite() && self.time > 0.0, "drift_time")?;
        let ratio = dt / self.time;
        Ok(Drift { kept: (-ratio).exp(), step: self.deviation * (-(-2.0 * ratio).exp_m1()).sqrt() })
    }
}

impl Drift {
    /// The zero after dt, from `zero`.
    pub fn step(&self, zero: &mut f64, random: &mut ChaCha8Rng) -> f64 {
        if self.step > 0.0 {
            let drawn: f64 = StandardNormal.sample(random);
            *zero = self.kept * *zero + self.step * drawn;
        }
        *zero
    }
}
