//! Ripple: the level of a strain-wave gear's friction over the wave generator's angle, in each direction.
//!
//! ```text
//! level(theta) = mean + sum over k = 1..K of a_k*cos(k*theta) + b_k*sin(k*theta)
//! ```
//!
//! with a mean and K orders a revolution for forward, and others for backward motion. Order 2 is the ellipse,
//! order 1 what is off centre. Levels and coefficients (N) or (N m); the gear's block multiplies another level
//! by level/mean. Sum over k of sqrt(a_k^2 + b_k^2) is at most 0.99 of the mean, so that the level is positive,
//! from wherever the angle is counted.
//!
//! Memoryless: there is nothing to discretise. The angle comes as its sine and cosine; higher orders follow
//! by Horner's rule, which loses a unit of rounding an order.
//!
//! Known weakness: a map of one unit under one load: the orders of a gear differ from the next one's, and
//! move with wear and temperature.

use super::require_divisor;
use crate::angle::Heading;
use crate::constants::constants;
use crate::error::{Error, require};
use crate::real::Real;

/// Orders of the gear's ripple, 1..=2 a revolution of the wave generator.
pub const RIPPLE_ORDERS: usize = 2;
/// Greatest sum of the amplitudes over the mean, and what rounding may add to it.
const GREATEST_SHARE: f64 = 0.99 + 1e-6;

/// Mean and orders of one direction.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Harmonics<R, const K: usize> {
    /// Mean level (N) or (N m); 1e-9..=1e6.
    pub mean: R,
    /// a_k (N) or (N m).
    pub cosines: [R; K],
    /// b_k (N) or (N m).
    pub sines: [R; K],
}

impl<R: Real, const K: usize> Harmonics<R, K> {
    /// No ripple, of a mean of 1.
    pub const NONE: Self = Self { mean: R::ONE, cosines: [R::ZERO; K], sines: [R::ZERO; K] };

    fn check(&self, name: &'static str) -> Result<(), Error> {
        require_divisor(self.mean, name)?;
        require(self.amplitude() <= R::lit(GREATEST_SHARE) * self.mean, name)
    }

    /// Sum of the orders' amplitudes, in the unit of the mean.
    fn amplitude(&self) -> R {
        let orders = self.cosines.iter().zip(&self.sines);
        orders.fold(R::ZERO, |sum, (&a, &b)| sum + (a * a + b * b).sqrt())
    }

    /// Bound of the level over its mean.
    pub(super) fn largest(&self) -> R {
        R::ONE + self.amplitude() / self.mean
    }

    /// Over the mean.
    fn normalised(&self) -> Self {
        let inverse = R::ONE / self.mean;
        let relative = |part: R| part * inverse;
        Self { mean: self.mean, cosines: self.cosines.map(relative), sines: self.sines.map(relative) }
    }

    /// The level is the mean everywhere.
    pub(super) fn is_none(&self) -> bool {
        self.cosines.iter().chain(&self.sines).all(|&amplitude| amplitude == R::ZERO)
    }

    /// Level over its mean, of harmonics over the mean, each order's heading that of the one below rotated on.
    #[inline(always)]
    pub(super) fn relative_level(&self, heading: Heading<R>) -> R {
        let (mut at, mut level) = (heading, R::ONE);
        for (order, (&a, &b)) in self.cosines.iter().zip(&self.sines).enumerate() {
            if order > 0 {
                at = at.plus(heading);
            }
            level += a * at.cosine + b * at.sine;
        }
        level
    }
}

/// Both directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RippleParams<R, const K: usize> {
    /// While the wave generator turns forwards.
    pub forward: Harmonics<R, K>,
    /// While it turns backwards; the level is positive here too.
    pub backward: Harmonics<R, K>,
}

impl<R: Real, const K: usize> RippleParams<R, K> {
    /// Checks.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `forward` or `backward`.
    pub fn build(&self) -> Result<Ripple<R, K>, Error> {
        self.forward.check("forward")?;
        self.backward.check("backward")?;
        let [forward, backward] = [&self.forward, &self.backward].map(Harmonics::normalised);
        Ok(Ripple { forward, backward })
    }

    /// No ripple.
    pub const NONE: Self = Self { forward: Harmonics::NONE, backward: Harmonics::NONE };
}

/// Built model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ripple<R, const K: usize> {
    pub(super) forward: Harmonics<R, K>,
    pub(super) backward: Harmonics<R, K>,
}

impl<R: Real, const K: usize> Ripple<R, K> {
    /// Level (N) or (N m) at an angle of the wave generator.
    #[inline]
    pub fn level(&self, wave_generator: Heading<R>, backwards: bool) -> R {
        let harmonics = if backwards { &self.backward } else { &self.forward };
        harmonics.mean * harmonics.relative_level(wave_generator)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const PARAMS: RippleParams<f64, 3> = RippleParams {
        forward: Harmonics { mean: 8.0, cosines: [1.5, -0.7, 0.1], sines: [0.3, 0.9, 0.0] },
        backward: Harmonics { mean: 1.0, cosines: [0.99, 0.0, 0.0], sines: [0.0; 3] },
    };

    proptest! {
        #[test]
        fn the_level_is_the_sum_of_its_orders(phase: u32) {
            let model = PARAMS.build().unwrap();
            let angle = f64::from(phase) / 4_294_967_296.0 * std::f64::consts::TAU;
            let orders = (0..3).map(|k| {
                let (sine, cosine) = ((k + 1) as f64 * angle).sin_cos();
                PARAMS.forward.cosines[k] * cosine + PARAMS.forward.sines[k] * sine
            });
            let level = 8.0 + orders.sum::<f64>();
            let heading = Heading::of_phase(phase);
            prop_assert!((model.level(heading, false) - level).abs() < 1e-13);
            prop_assert!((0.009..1.991).contains(&model.level(heading, true)));
        }
    }

    #[test]
    fn a_ripple_above_its_mean_is_refused_by_name() {
        let mut params = PARAMS;
        params.backward.sines[2] = 1e-5;
        assert_eq!(params.build().unwrap_err(), Error::OutOfRange("backward"));
        params.forward.mean = f64::NAN;
        assert_eq!(params.build().unwrap_err(), Error::OutOfRange("forward"));
    }
}
