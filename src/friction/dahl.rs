//! Dahl's model: friction as a spring that yields.
//!
//! ```text
//! dF/dx = sigma * (1 - F/Fc * sign(v))^i
//! ```
//!
//! Sign: F has the sign of v in steady sliding and is subtracted in the equation of motion. Units: sigma
//! (N/m) or (N m/rad), Fc (N) or (N m).
//!
//! Discretisation: exact. With u = 1 - F/Fc*sign(v), 0..=2, the equation is du/ds = -(sigma/Fc)*u^i in the
//! path length s, and over a step of constant direction and length ds, with q = sigma*ds/Fc,
//!
//! | i | shape | u becomes |
//! | --- | --- | --- |
//! | 0 | straight rise, sudden yield (elastic, perfectly plastic) | max(u - q, 0) |
//! | 1 | exponential: [`super::BlimanSorine`] of order 1 with eps = Fc/sigma | u*e^-q |
//! | 2 | long tail | u/(1 + q*u) |
//!
//! Other exponents take a power, too costly for the control step, and measured loops do not separate them. The force is independent of the rate and of how a stroke is cut into steps. It loses work over
//! any closed motion: F^2/(2*sigma) is stored at most.
//!
//! Known weakness: no Stribeck effect, static friction is no higher than sliding friction, so no
//! stick-slip; under a load that oscillates below Fc the body creeps (drift), because presliding is never
//! purely elastic (but for i = 0).
//!
//! P. Dahl, "A solid friction model", Aerospace Corporation TOR-0158(3107-18)-1, 1968; H. Olsson et al.,
//! European Journal of Control 4 (1998).

use super::data::{COULOMB, FrictionData, PRESLIDING};
use super::registered::{ClosedMotionTest, ForceOverPath, Registered, Standstill};
use super::{FrictionModel, FrictionParams, GREATEST, LEAST, Slip, require_divisor};
use crate::error::{Error, require};
use crate::real::Real;

/// Level, stiffness and shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DahlParams<R> {
    /// Fc (N) or (N m); 1e-9..=1e6.
    pub coulomb: R,
    /// sigma, the slope of F at F = 0 (N/m) or (N m/rad); 1e-9..=1e12.
    pub stiffness: R,
    /// i; 0, 1 or 2.
    pub exponent: R,
}

impl<R: Real> FrictionParams<R> for DahlParams<R> {
    type Model = Dahl<R>;

    /// # Errors
    /// [`Error::OutOfRange`] with the name of the field.
    fn build(&self) -> Result<Dahl<R>, Error> {
        require_divisor(self.coulomb, "coulomb")?;
        let stiffest = R::lit(GREATEST * GREATEST);
        require((R::lit(LEAST)..=stiffest).contains(&self.stiffness), "stiffness")?;
        let shape = match self.exponent {
            i if i == R::ZERO => Shape::Sudden,
            i if i == R::ONE => Shape::Exponential,
            i if i == R::lit(2.0) => Shape::LongTail,
            _ => return Err(Error::OutOfRange("exponent")),
        };
        Ok(Dahl { coulomb: self.coulomb, rate: self.stiffness / self.coulomb, shape })
    }
}

impl<R: Real> Registered<R> for DahlParams<R> {
    const NEEDS: &'static [&'static [&'static str]] = &[COULOMB, PRESLIDING];
    const MAY_HAVE: &'static [&'static str] = &["dahl_exponent"];
    const STANDSTILL: Standstill = Standstill::Presliding;
    const STICK_SLIP: bool = false;

    /// sigma = Fc/eps.
    fn of_data(data: &FrictionData<R>) -> Self {
        let coulomb = data.forward.coulomb;
        Self { coulomb, stiffness: coulomb / data.presliding, exponent: data.dahl_exponent }
    }

    /// Each exponent; that of 0 yields all at once.
    fn closed_motions(level: f64, distance: f64, test: &mut impl ClosedMotionTest<R>) {
        for (exponent, force) in
            [(0.0, ForceOverPath::Straight), (1.0, ForceOverPath::Smooth), (2.0, ForceOverPath::Smooth)]
        {
            let [coulomb, stiffness, exponent] = [level, level / distance, exponent].map(R::lit);
            test.run(Self { coulomb, stiffness, exponent }.build(), force);
        }
    }
}

/// The exponent.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    Sudden,
    Exponential,
    LongTail,
}

/// F/Fc, within +-1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DahlState<R> {
    relative: R,
}

/// Built model.
///
/// The force depends on the path, not on the time that it takes; over the way Fc/sigma it comes to 1 - 1/e of the
/// level:
///
/// ```
/// use strainwave::friction::{DahlParams, FrictionModel, FrictionParams, Slip};
///
/// let friction = DahlParams { coulomb: 1.0, stiffness: 1e3, exponent: 1.0 }.build()?;
/// let after_1_mm_at = |velocity: f64| {
///     let mut state = Default::default();
///     let steps = (1e-3 / (velocity * 1e-4)).round() as u32;
///     (0..steps).fold(0.0, |_, _| friction.step(&mut state, &Slip::new(velocity, 1e-4)).force)
/// };
/// assert!((after_1_mm_at(0.1) - (1.0 - (-1.0_f64).exp())).abs() < 1e-12);
/// assert!((after_1_mm_at(1.0) - after_1_mm_at(0.1)).abs() < 1e-12);
/// # Ok::<(), strainwave::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dahl<R> {
    coulomb: R,
    /// sigma/Fc.
    rate: R,
    shape: Shape,
}

impl<R: Real> FrictionModel<R> for Dahl<R> {
    type State = DahlState<R>;
    const RATE_INDEPENDENT: bool = true;

    #[inline(always)]
    fn force(&self, state: &Self::State) -> R {
        self.coulomb * state.relative
    }

    #[inline(always)]
    fn advance(&self, state: &mut Self::State, slip: &Slip<R>) {
        let step = slip.displacement() * self.rate;
        let (direction, path) = (step.sign(), step.abs());
        // Written as F moving towards Fc, not as u: near F = 0 the small force keeps all its digits.
        let remainder = direction - state.relative;
        state.relative += match self.shape {
            Shape::Sudden => step.limit(remainder.abs()),
            Shape::Exponential => remainder * path.one_minus_exp_neg(),
            Shape::LongTail => {
                let scaled = path * remainder.abs();
                remainder * (scaled / (R::ONE + scaled))
            }
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::tests::Extremes;
    use proptest::prelude::*;
    use std::vec::Vec;

    impl<R: Real> Extremes<R> for DahlParams<R> {
        fn extremes() -> Vec<Self> {
            let params = |exponent| Self {
                coulomb: R::lit(1e-9),
                stiffness: R::lit(1e12),
                exponent: R::lit(exponent),
            };
            [0.0, 1.0, 2.0].map(params).to_vec()
        }
    }

    const LEVEL: f64 = 2.0;
    const STIFFNESS: f64 = 100.0;

    fn dahl(exponent: f64) -> Dahl<f64> {
        DahlParams { coulomb: LEVEL, stiffness: STIFFNESS, exponent }.build().unwrap()
    }

    fn force_after(model: &Dahl<f64>, strokes: &[f64]) -> f64 {
        let mut state = DahlState::default();
        strokes.iter().for_each(|&stroke| model.advance(&mut state, &Slip::new(stroke, 1.0)));
        model.force(&state)
    }

    /// dF/dx by fourth-order Runge-Kutta.
    fn integrated(exponent: i32, strokes: &[f64]) -> f64 {
        const CUTS: usize = 4000;
        strokes.iter().fold(0.0, |force, stroke| {
            let d = stroke / CUTS as f64;
            let slope = |force: f64| STIFFNESS * (1.0 - force / LEVEL * d.signum()).powi(exponent);
            (0..CUTS).fold(force, |force, _| {
                let k1 = slope(force);
                let k2 = slope(force + 0.5 * d * k1);
                let k3 = slope(force + 0.5 * d * k2);
                let k4 = slope(force + d * k3);
                force + d / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)
            })
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]
        #[test]
        fn the_smooth_shapes_solve_the_equation(strokes in prop::collection::vec(-0.1..0.1f64, 1..8)) {
            for exponent in [1, 2] {
                let force = force_after(&dahl(f64::from(exponent)), &strokes);
                prop_assert!((force - integrated(exponent, &strokes)).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn the_sudden_shape_is_a_spring_that_slips() {
        let model = dahl(0.0);
        assert_eq!(force_after(&model, &[0.015]), 1.5);
        assert_eq!(force_after(&model, &[3.0]), LEVEL);
        assert!((force_after(&model, &[3.0, -0.01]) - 1.0).abs() < 1e-15);
        assert_eq!(force_after(&model, &[3.0, -0.05]), -LEVEL);
    }

    #[test]
    fn a_parameter_out_of_range_is_named() {
        let params = DahlParams { coulomb: LEVEL, stiffness: STIFFNESS, exponent: 1.0 };
        let name = |params: DahlParams<f64>| params.build().unwrap_err();
        assert_eq!(name(DahlParams { coulomb: -1.0, ..params }), Error::OutOfRange("coulomb"));
        assert_eq!(name(DahlParams { stiffness: f64::NAN, ..params }), Error::OutOfRange("stiffness"));
        assert_eq!(name(DahlParams { exponent: 1.5, ..params }), Error::OutOfRange("exponent"));
    }
}
