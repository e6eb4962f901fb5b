//! Kinematic error: how far the output of the unloaded gear is off its ideal angle.
//!
//! ```text
//! e(theta) = sum_i A_i sin(k_i*theta + p_i)  +  sum_j A_j sin(k_j*(theta - r*theta) + p_j)
//! de/dtheta = sum_i k_i A_i cos(..)          +  sum_j k_j*(1 - r) A_j cos(..)
//! ```
//!
//! theta is the wave generator's angle, r the signed ratio. The first list counts orders per turn
//! of the wave generator relative to the case, the second per turn relative to the flexspline: with
//! r = +1/n order k of the second is order k - k/n of theta. Both rims show in measured gears.
//!
//! Sign: e adds to r*theta, torsion = r*theta + e - theta_fs. Units: e (rad) at the output,
//! de/dtheta without unit. Memoryless.
//!
//! Precision: theta and r*theta are integer phases, so an order times a phase wraps exactly and
//! e does not lose accuracy over any number of turns; the fractions of a count that the phases leave
//! out are below 5e-9 rad of theta.
//!
//! F. Ghorbel, P. Gandhi, F. Alpeter, "On the kinematic error in harmonic drive gears", Journal of
//! Mechanical Design 123 (2001).

use crate::angle::{Angle, Ratio};
use crate::error::{Error, require};
use crate::real::Real;

/// One sine; amplitude 0 leaves the place unused.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Term<R> {
    /// k, periods per turn; 0..=1000.
    pub order: u32,
    /// A (rad) at the output; within +-0.1.
    pub amplitude: R,
    /// p (rad); within +-pi.
    pub phase: R,
}

/// Up to `K` sines of each kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KinematicErrorParams<R, const K: usize> {
    /// Orders per turn of the wave generator relative to the case.
    pub case: [Term<R>; K],
    /// Orders per turn of the wave generator relative to the flexspline.
    pub flexspline: [Term<R>; K],
}

impl<R: Real, const K: usize> Default for KinematicErrorParams<R, K> {
    fn default() -> Self {
        Self { case: [Term::default(); K], flexspline: [Term::default(); K] }
    }
}

impl<R: Real, const K: usize> KinematicErrorParams<R, K> {
    /// Checks and precomputes for the signed `ratio` r.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `order`, `amplitude` or `phase`.
    pub fn build(&self, ratio: Ratio) -> Result<KinematicError<R, K>, Error> {
        for term in self.case.iter().chain(&self.flexspline) {
            term.check()?;
        }
        Ok(KinematicError {
            case: self.case.map(|term| Sine::new(term, R::ONE)),
            flexspline: self.flexspline.map(|term| Sine::new(term, R::ONE - ratio.value())),
        })
    }
}

impl<R: Real> Term<R> {
    fn check(&self) -> Result<(), Error> {
        require(self.order <= 1000, "order")?;
        require(self.amplitude.abs() <= R::lit(0.1), "amplitude")?;
        require(self.phase.abs() <= R::lit(core::f64::consts::PI), "phase")
    }
}

/// A term as the step needs it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sine<R> {
    order: u32,
    /// p in counts of a phase.
    phase: u32,
    amplitude: R,
    /// Amplitude of the derivative over theta.
    slope: R,
}

impl<R: Real> Sine<R> {
    fn new(term: Term<R>, angle_per_theta: R) -> Self {
        let order = R::from_i32(term.order.cast_signed());
        Self {
            order: term.order,
            phase: Angle::from_radians(term.phase).phase(),
            amplitude: term.amplitude,
            slope: term.amplitude * order * angle_per_theta,
        }
    }

    #[inline(always)]
    fn add_to(&self, sum: &mut Deviation<R>, angle: u32) {
        if self.amplitude != R::ZERO {
            let (sine, cosine) = R::sin_cos_phase(self.order.wrapping_mul(angle).wrapping_add(self.phase));
            sum.error += self.amplitude * sine;
            sum.slope += self.slope * cosine;
        }
    }
}

/// The kinematic error at one angle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation<R> {
    /// e (rad) at the output.
    pub error: R,
    /// de/dtheta.
    pub slope: R,
}

/// Built model; it has no state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KinematicError<R, const K: usize> {
    case: [Sine<R>; K],
    flexspline: [Sine<R>; K],
}

impl<R: Real, const K: usize> KinematicError<R, K> {
    /// e and de/dtheta at the wave generator's angle `theta`; `reduced` is r*theta, which the gear
    /// has at hand ([`Ratio::apply`]). Finite for any input: only the integer phases are read.
    // Never inlined: the timing budget counts this block by its symbol.
    #[inline(never)]
    pub fn evaluate(&self, theta: Angle<R>, reduced: Angle<R>) -> Deviation<R> {
        let mut sum = Deviation::default();
        let to_case = theta.phase();
        for sine in &self.case {
            sine.add_to(&mut sum, to_case);
        }
        let to_flexspline = to_case.wrapping_sub(reduced.phase());
        for sine in &self.flexspline {
            sine.add_to(&mut sum, to_flexspline);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::real::RADIANS_PER_COUNT;
    use proptest::prelude::*;

    const TURN: i64 = 1 << 32;

    fn term<R: Real>(order: u32, amplitude: f64, phase: f64) -> Term<R> {
        Term { order, amplitude: R::lit(amplitude), phase: R::lit(phase) }
    }

    /// A gear with both rims.
    fn params<R: Real>() -> KinematicErrorParams<R, 3> {
        KinematicErrorParams {
            case: [term(1, 3e-5, 0.4), term(2, 1e-4, -2.0), term(4, 2e-5, 3.0)],
            flexspline: [term(2, 6e-5, 1.0), Term::default(), term(6, -1e-5, -0.5)],
        }
    }

    fn evaluate<R: Real, const K: usize>(
        model: &KinematicError<R, K>,
        ratio: Ratio,
        counts: i64,
    ) -> Deviation<R> {
        let theta = Angle::from_counts(counts);
        model.evaluate(theta, ratio.apply(theta))
    }

    proptest! {
        #[test]
        fn it_is_the_sum_of_sines(counts in -TURN..TURN, n in prop::sample::select(&[-100, -50, 81, 101][..])) {
            let ratio = Ratio::one_over(n).unwrap();
            let found = evaluate(&params::<f64>().build(ratio).unwrap(), ratio, counts);
            let (theta, r) = (counts as f64 * RADIANS_PER_COUNT, 1.0 / f64::from(n));
            let mut wanted = Deviation::<f64>::default();
            let mut add = |term: &Term<f64>, angle: f64, per_theta: f64| {
                let order = f64::from(term.order);
                wanted.error += term.amplitude * (order * angle + term.phase).sin();
                wanted.slope += term.amplitude * order * per_theta * (order * angle + term.phase).cos();
            };
            params().case.iter().for_each(|term| add(term, theta, 1.0));
            params().flexspline.iter().for_each(|term| add(term, theta * (1.0 - r), 1.0 - r));
            prop_assert!((found.error - wanted.error).abs() < 2e-12);
            prop_assert!((found.slope - wanted.slope).abs() < 1e-11);
        }

        #[test]
        fn the_slope_is_the_derivative(counts: i64, n in prop::sample::select(&[-100, 101][..])) {
            let ratio = Ratio::one_over(n).unwrap();
            let model = params::<f64>().build(ratio).unwrap();
            let (span, at) = (1 << 20, |counts| evaluate(&model, ratio, counts));
            let rise = at(counts.wrapping_add(span)).error - at(counts.wrapping_sub(span)).error;
            let slope = rise / (2.0 * span as f64 * RADIANS_PER_COUNT);
            prop_assert!((slope - at(counts).slope).abs() < 3e-9);
        }

        #[test]
        fn an_even_order_repeats_every_half_turn_exactly(counts: i64, half in 1..1_000_000i64) {
            let mut even = params::<f32>();
            even.case[0].amplitude = 0.0;
            even.flexspline = [Term::default(); 3];
            let ratio = Ratio::one_over(-100).unwrap();
            let model = even.build(ratio).unwrap();
            let moved = counts.wrapping_add(half * TURN / 2);
            prop_assert_eq!(evaluate(&model, ratio, counts), evaluate(&model, ratio, moved));
        }

        #[test]
        fn a_million_turns_change_nothing_in_f32(phase in 0..TURN) {
            // 101 turns of the wave generator are 100 relative to the flexspline.
            let ratio = Ratio::one_over(101).unwrap();
            let model = params::<f32>().build(ratio).unwrap();
            let far = evaluate(&model, ratio, phase + 1_010_000 * TURN);
            let near = evaluate(&model, ratio, phase);
            prop_assert!((far.error - near.error).abs() <= 1e-9);
        }

        #[test]
        fn f32_follows_f64(counts: i64) {
            let ratio = Ratio::one_over(101).unwrap();
            let single = evaluate(&params::<f32>().build(ratio).unwrap(), ratio, counts);
            let double = evaluate(&params::<f64>().build(ratio).unwrap(), ratio, counts);
            prop_assert!((f64::from(single.error) - double.error).abs() < 1e-10);
            prop_assert!((f64::from(single.slope) - double.slope).abs() < 2e-10);
        }

        #[test]
        fn any_bits_of_the_rest_give_a_finite_error(counts: i64, reduced: i64, rest: u32) {
            let ratio = Ratio::one_over(-100).unwrap();
            let model = params::<f32>().build(ratio).unwrap();
            let rest = f32::from_bits(rest);
            let found = model.evaluate(Angle { counts, rest }, Angle { counts: reduced, rest });
            prop_assert!(found.error.abs() < 2.3e-4 && found.slope.abs() < 1e-3);
        }
    }

    #[test]
    fn a_parameter_out_of_range_is_named() {
        let ratio = Ratio::one_over(-100).unwrap();
        let name = |term: Term<f64>| {
            let params = KinematicErrorParams { case: [Term::default()], flexspline: [term] };
            params.build(ratio).unwrap_err()
        };
        assert_eq!(name(term(1001, 1e-4, 0.0)), Error::OutOfRange("order"));
        assert_eq!(name(term(2, f64::NAN, 0.0)), Error::OutOfRange("amplitude"));
        assert_eq!(name(term(2, 1e-4, 3.2)), Error::OutOfRange("phase"));
    }
}
