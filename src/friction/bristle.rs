//! The bristle model of Haessig and Friedland: B bonds between two rough surfaces.
//!
//! ```text
//! F = sum sigma0 * (x - b_k),  k = 1..B          a bond snaps at |x - b_k| = delta_s, and forms again
//! ```
//!
//! x is the position of one surface on the other, b_k that at which bond k formed. Haessig and Friedland let it
//! form again at a random position. Here it forms, without tension, at the present position of its bristle, and at
//! rest the B tensions are spread evenly over (-delta_s/2, delta_s/2): every bond snaps each delta_s of
//! one-way sliding, and evenly spread bonds stay evenly spread, so that the model is deterministic.
//! The force in one-way sliding is
//!
//! ```text
//! B*sigma0*delta_s/2,  within +-sigma0*delta_s/2 around it
//! ```
//!
//! and from rest the slope is B*sigma0.
//!
//! Sign: F has the sign of v in steady sliding and is subtracted in the equation of motion. Units: sigma0
//! (N/m) or (N m/rad) a bond, delta_s (m) or (rad).
//!
//! Discretisation: exact for any step: bonds that snap several times within a step are folded by whole
//! delta_s. It loses work over any closed motion, because a bond only loses tension when it snaps.
//!
//! Known weakness: B states for one force, 20 to 25 by its authors, too many for a control step; a force
//! that jumps by sigma0*delta_s at each snap, so that simulation is slow and f32 and f64 differ by a jump
//! after long motion; no Stribeck effect, no viscous part, bonds without damping.
//!
//! D. A. Haessig, B. Friedland, "On the modeling and simulation of friction", Journal of Dynamic Systems,
//! Measurement, and Control 113 (1991); H. Olsson et al., European Journal of Control 4 (1998).

use super::data::{COULOMB, FrictionData, PRESLIDING};
use super::registered::{ClosedMotionTest, ForceOverPath, Registered, Standstill};
use super::{FrictionModel, FrictionParams, GREATEST, Slip, require_divisor};
use crate::error::{Error, require};
use crate::real::Real;

/// Bonds of the registered model.
pub const BRISTLES: usize = 20;

/// Stiffness and reach of one bond of `B`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BristleParams<R, const B: usize> {
    /// sigma0 of one bond (N/m) or (N m/rad); 0..=1e12.
    pub stiffness: R,
    /// delta_s (m) or (rad); 1e-9..=1e6.
    pub reach: R,
}

impl<R: Real, const B: usize> BristleParams<R, B> {
    /// Bonds that slide at the level `coulomb` (N) or (N m), over a `reach` delta_s (m) or (rad).
    pub fn of_level(coulomb: R, reach: R) -> Self {
        Self { stiffness: R::lit(2.0 / B as f64) * coulomb / reach, reach }
    }
}

impl<R: Real, const B: usize> FrictionParams<R> for BristleParams<R, B> {
    type Model = Bristle<R, B>;

    /// # Errors
    /// [`Error::OutOfRange`] with the name of the field, or `bristles` when `B` is not in 1..=1000.
    fn build(&self) -> Result<Bristle<R, B>, Error> {
        require((1..=1000).contains(&B), "bristles")?;
        require((R::ZERO..=R::lit(GREATEST * GREATEST)).contains(&self.stiffness), "stiffness")?;
        require_divisor(self.reach, "reach")?;
        Ok(Bristle { greatest: self.stiffness * self.reach, rate: R::ONE / self.reach })
    }
}

impl<R: Real> Registered<R> for BristleParams<R, BRISTLES> {
    const NEEDS: &'static [&'static [&'static str]] = &[COULOMB, PRESLIDING];
    const STANDSTILL: Standstill = Standstill::Presliding;
    const STICK_SLIP: bool = false;

    /// [`BRISTLES`] bonds of delta_s = 2*eps, which slide at Fc.
    fn of_data(data: &FrictionData<R>) -> Self {
        let FrictionData { forward, presliding, .. } = *data;
        Self::of_level(forward.coulomb, presliding + presliding)
    }

    /// Four bonds: those of [`BRISTLES`] snap at places that are no binary fractions of the distance.
    fn closed_motions(level: f64, distance: f64, test: &mut impl ClosedMotionTest<R>) {
        let bonds = BristleParams::<R, 4>::of_level(R::lit(level), R::lit(distance));
        test.run(bonds.build(), ForceOverPath::Straight);
    }
}

/// Tensions, relative to that at which a bond snaps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BristleState<R, const B: usize> {
    tensions: [R; B],
}

impl<R: Real, const B: usize> Default for BristleState<R, B> {
    fn default() -> Self {
        Self { tensions: core::array::from_fn(|k| R::lit((k as f64 + 0.5) / B as f64 - 0.5)) }
    }
}

/// Built model.
///
/// Twenty bonds slide at the level that they were made for, and turn all work into heat:
///
/// ```
/// use strainwave::friction::{BristleParams, FrictionModel, FrictionParams, Slip};
///
/// let (level, reach) = (1.0_f64, 1e-3);
/// let friction = BristleParams::<f64, 20>::of_level(level, reach).build()?;
/// let (mut state, mut work, mut way) = (Default::default(), 0.0, 0.0);
/// for step in 0..10_000 {
///     let slip = Slip::new(0.01, 1e-4);
///     let force = friction.step(&mut state, &slip).force;
///     if step >= 2_000 {
///         (work, way) = (work + force * slip.displacement(), way + slip.displacement());
///     }
/// }
/// assert!((work / way - level).abs() < 0.01 * level);
/// # Ok::<(), strainwave::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bristle<R, const B: usize> {
    /// sigma0*delta_s.
    greatest: R,
    /// 1/delta_s.
    rate: R,
}

/// Fractional part of `x >= 0`.
#[inline(always)]
fn fraction<R: Real>(x: R) -> R {
    // Past 2^24 an f32 has no fraction; before that the integer holds it.
    let x = if x < R::lit(16_777_216.0) { x } else { R::ZERO };
    x - R::from_i32(x.to_i32())
}

impl<R: Real, const B: usize> FrictionModel<R> for Bristle<R, B> {
    type State = BristleState<R, B>;

    fn force(&self, state: &Self::State) -> R {
        self.greatest * state.tensions.iter().fold(R::ZERO, |sum, &tension| sum + tension)
    }

    fn advance(&self, state: &mut Self::State, slip: &Slip<R>) {
        let step = slip.displacement() * self.rate;
        let (direction, path) = (step.sign(), step.abs());
        let part = fraction(path);
        for tension in &mut state.tensions {
            let along = *tension * direction;
            if along + path < R::ONE {
                *tension += step;
            } else {
                // Whole lengths change nothing; left out, their rounding cannot synchronise the bonds.
                *tension = direction * fraction(along + R::ONE + part);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::tests::Extremes;
    use proptest::prelude::*;
    use std::vec;
    use std::vec::Vec;

    impl<R: Real> Extremes<R> for BristleParams<R, BRISTLES> {
        fn extremes() -> Vec<Self> {
            vec![Self::of_level(R::lit(0.035), R::lit(1e-9))]
        }
    }

    const BONDS: usize = 16;
    const LEVEL: f64 = 2.0;

    fn bristle() -> Bristle<f64, BONDS> {
        BristleParams::of_level(LEVEL, 0.25).build().unwrap()
    }

    fn walk(strokes: &[f64]) -> BristleState<f64, BONDS> {
        let mut state = BristleState::default();
        strokes.iter().for_each(|&stroke| bristle().advance(&mut state, &Slip::new(stroke, 1.0)));
        state
    }

    #[test]
    fn rest_rise_and_sliding_are_as_stated() {
        let jump = LEVEL * 2.0 / BONDS as f64;
        assert!(bristle().force(&walk(&[])).abs() < 1e-15);
        assert!((bristle().force(&walk(&[0.001])) - LEVEL * 2.0 / 0.25 * 0.001).abs() < 1e-13);
        let forces = (0..5000).map(|k| bristle().force(&walk(&[0.13 + 1e-4 * f64::from(k)])));
        let forces: std::vec::Vec<f64> = forces.collect();
        let mean = forces.iter().sum::<f64>() / 5000.0;
        assert!((mean / LEVEL - 1.0).abs() < 1e-3, "{mean}");
        assert!(forces.iter().all(|force| (force - LEVEL).abs() <= 0.5 * jump + 1e-12));
    }

    proptest! {
        /// Dyadic strokes, so that the sums are exact: however they are cut, the bonds end in the same place.
        #[test]
        fn any_cut_of_a_stroke_gives_the_same_bonds(strokes in prop::collection::vec(-999..999i32, 1..20)) {
            let whole: std::vec::Vec<f64> = strokes.iter().map(|&k| f64::from(k) / 256.0).collect();
            let cut = whole.iter().flat_map(|stroke| std::iter::repeat_n(stroke / 64.0, 64));
            let (once, often) = (walk(&whole), walk(&cut.collect::<std::vec::Vec<_>>()));
            prop_assert_eq!(once, often);
        }
    }

    #[test]
    fn a_parameter_out_of_range_is_named() {
        let name = |stiffness, reach| BristleParams::<f64, 2> { stiffness, reach }.build().unwrap_err();
        assert_eq!(name(-1.0, 1.0), Error::OutOfRange("stiffness"));
        assert_eq!(name(1.0, 0.0), Error::OutOfRange("reach"));
        let none = BristleParams::<f64, 0> { stiffness: 1.0, reach: 1.0 };
        assert_eq!(none.build().unwrap_err(), Error::OutOfRange("bristles"));
    }
}
