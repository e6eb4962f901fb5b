//! Each f32 elementary function of the control step as a symbol of its own, of every library: to be counted.
//!
//! Phases of a whole revolution, and x from 1e-6 to 100 evenly in the logarithm. What is counted works: libm's and ours agree.

use core::hint::black_box;

/// Largest difference of our functions to libm's, of the square root relative to it.
pub const AGREEMENT: f32 = 1e-6;

/// Phases of a revolution.
const PHASES: u32 = 1024;
/// From one phase to the next: the golden section of a revolution, which comes everywhere.
const STEP: u32 = 2_654_435_769;

/// x, and its factor from one to the next.
const LEAST: f32 = 1e-6;
const MOST: f32 = 100.0;
const FACTOR: f32 = 1.02;

macro_rules! library {
    ($name:ident, $whose:literal) => {
        #[doc = $whose]
        pub mod $name {
            use strainwave::elementary::$name;

            /// Sine and cosine of a phase.
            #[inline(never)]
            pub fn sine_cosine(phase: u32) -> (f32, f32) {
                $name::sine_cosine(phase)
            }

            /// Square root, or 0.
            #[inline(never)]
            pub fn square_root_or_zero(x: f32) -> f32 {
                $name::square_root_or_zero(x)
            }

            /// 1 - e^-x.
            #[inline(never)]
            pub fn one_minus_exp_neg(x: f32) -> f32 {
                $name::one_minus_exp_neg(x)
            }
        }
    };
}

library!(ours, "Our own.");
library!(micromath, "micromath's.");
library!(libm, "libm's.");

/// Calls every function over its range: the largest difference of ours to libm's.
pub fn drive() -> f32 {
    let mut worst = 0.0_f32;
    for phase in (0..PHASES).map(|k| black_box(k.wrapping_mul(STEP))) {
        let (ours, theirs) = (ours::sine_cosine(phase), libm::sine_cosine(phase));
        black_box(micromath::sine_cosine(phase));
        worst = worst.max((ours.0 - theirs.0).abs()).max((ours.1 - theirs.1).abs());
    }
    let mut x = LEAST;
    while x < MOST {
        let here = black_box(x);
        let (ours, theirs) = (ours::square_root_or_zero(here), libm::square_root_or_zero(here));
        worst = worst.max((ours / theirs - 1.0).abs());
        let (ours, theirs) = (ours::one_minus_exp_neg(here), libm::one_minus_exp_neg(here));
        worst = worst.max((ours - theirs).abs());
        black_box((micromath::square_root_or_zero(here), micromath::one_minus_exp_neg(here)));
        x *= FACTOR;
    }
    worst
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ours_and_libms_agree() {
        let worst = drive();
        assert!(worst <= AGREEMENT && worst > 0.0, "{worst:e}");
    }
}
