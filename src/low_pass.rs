//! Low-pass filter of one pole.
//!
//! ```text
//! y += g*(x - y),   g = 1 - e^(-omega*dt)        corner omega (rad/s), one step every dt (s)
//! ```

use crate::constants::constants;
use crate::real::Real;

/// Low-pass filter of one pole; its state is its output.
#[constants]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LowPass<R> {
    gain: R,
}

impl<R: Real> LowPass<R> {
    /// Filter of this corner (rad/s), stepped every `dt` (s).
    pub fn build(corner: R, dt: R) -> Self {
        Self::of_gain((dt * corner).one_minus_exp_neg())
    }

    /// Filter of a gain g, 0..=1.
    pub fn of_gain(gain: R) -> Self {
        Self { gain }
    }

    /// g.
    pub fn gain(self) -> R {
        self.gain
    }

    /// Moves the output towards the input; returns by how much.
    #[inline(always)]
    pub fn step(self, output: &mut R, input: R) -> R {
        let change = self.gain * (input - *output);
        *output += change;
        change
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// After a time of 1/omega a step is followed to 1 - 1/e, whatever the steps.
    #[test]
    fn the_corner_is_that_of_the_step_response() {
        for steps in [1, 10, 1000] {
            let filter = LowPass::build(50.0, 0.02 / f64::from(steps));
            let mut output = 0.0;
            (0..steps).for_each(|_| {
                filter.step(&mut output, 2.0);
            });
            assert!((output / 2.0 - (1.0 - (-1.0f64).exp())).abs() < 1e-12, "{steps}: {output}");
        }
    }
}
