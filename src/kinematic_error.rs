//! Kinematic error: angle of the unloaded gear's output less its ideal angle.
//!
//! ```text
//! e(theta) = sum_i A_i sin(k_i*theta + p_i)  +  sum_j A_j sin(k_j*(theta - r*theta) + p_j)
//! de/dtheta = sum_i k_i A_i cos(..)          +  sum_j k_j*(1 - r) A_j cos(..)
//! ```
//!
//! theta is the wave generator's angle, r the signed ratio. The first list counts orders per revolution
//! of the wave generator relative to the case, the second per revolution relative to the flexspline: with
//! r = +1/n order k of the second is order k - k/n of theta. Both rims show in measured gears.
//!
//! Sign: e adds to r*theta, torsion = r*theta + e - theta_fs. Units: e (rad) at the output,
//! de/dtheta without unit. Memoryless.
//!
//! Precision: theta and r*theta are integer phases, so an order times a phase wraps exactly and
//! e does not lose accuracy over any number of revolutions; the fractions of a count that the phases leave
//! out are below 5e-9 rad of theta.
//!
//! Cost: one sine and cosine of theta, which the wave generator's friction uses too, give a ladder of orders
//! 1, 2, 3, ... or 2, 4, 6, ...: the heading of each is that of the one below rotated on, four multiplications
//! in the place of a sine and cosine. In f32 each rotation adds a rounding, 1e-7 of an amplitude. Orders off the
//! ladder have a sine and cosine of their own, and the angle relative to the flexspline has one where there are
//! terms of it. Which is which is decided at build.
//!
//! F. Ghorbel, P. Gandhi, F. Alpeter, "On the kinematic error in harmonic drive gears", Journal of
//! Mechanical Design 123 (2001).

use crate::angle::{Angle, Heading, Ratio};
use crate::constants::constants;
use crate::error::{Error, require};
use crate::real::Real;

/// One sine; amplitude 0 leaves the place unused.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Term<R> {
    /// k, periods per revolution; 0..=1000.
    pub order: u32,
    /// A (rad) at the output; within +-0.1.
    pub amplitude: R,
    /// p (rad); within +-pi.
    pub phase: R,
}

/// Up to `K` sines of each kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KinematicErrorParams<R, const K: usize> {
    /// Orders per revolution of the wave generator relative to the case.
    pub case: [Term<R>; K],
    /// Orders per revolution of the wave generator relative to the flexspline.
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
        let case = Series::new(&self.case, R::ONE);
        let flexspline = Series::new(&self.flexspline, R::ONE - ratio.value());
        let more = case.len > case.above || !flexspline.is_empty();
        Ok(KinematicError { case, flexspline, ratio, more })
    }

    /// Bound of abs d^2e/dtheta^2 for the signed `ratio` r (1/rad): every term at its peak at once.
    pub fn curvature(&self, ratio: R) -> R {
        let of = |terms: &[Term<R>; K], angle_per_theta: R| {
            terms.iter().fold(R::ZERO, |sum, term| {
                let rate = R::from_i32(term.order.cast_signed()) * angle_per_theta;
                sum + term.amplitude.abs() * rate * rate
            })
        };
        of(&self.case, R::ONE) + of(&self.flexspline, R::ONE - ratio)
    }
}

impl<R: Real> Term<R> {
    fn check(&self) -> Result<(), Error> {
        require(self.order <= 1000, "order")?;
        require(self.amplitude.abs() <= R::lit(0.1), "amplitude")?;
        require(self.phase.abs() <= R::lit(core::f64::consts::PI), "phase")
    }
}

/// A term as the step needs it; several of one order are one.
#[constants]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Sine<R> {
    order: u32,
    /// Coefficients of the order's sine and cosine in e, A cos(p) and A sin(p), and in de/dtheta.
    error: [R; 2],
    slope: [R; 2],
}

impl<R: Real> Sine<R> {
    fn add_term(&mut self, term: &Term<R>, angle_per_theta: R) {
        let Heading { cosine, sine } = Angle::from_radians(term.phase).heading();
        let [of_sine, of_cosine] = [term.amplitude * cosine, term.amplitude * sine];
        let rate = R::from_i32(term.order.cast_signed()) * angle_per_theta;
        self.order = term.order;
        self.error[0] += of_sine;
        self.error[1] += of_cosine;
        self.slope[0] += -rate * of_cosine;
        self.slope[1] += rate * of_sine;
    }

    /// Its term at the heading of the order's angle.
    #[inline(always)]
    fn at(&self, heading: Heading<R>) -> ErrorAndSlope<R> {
        let Heading { cosine, sine } = heading;
        ErrorAndSlope {
            error: self.error[0] * sine + self.error[1] * cosine,
            slope: self.slope[0] * sine + self.slope[1] * cosine,
        }
    }
}

/// Sines of one angle. The first are a ladder, every multiple of 1 or 2 up to some order: the heading of each
/// rung is the one below it turned on. The rest are apart, each with a sine and cosine of its own.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
struct Series<R, const K: usize> {
    above: u32,
    len: u32,
    /// Orders from rung to rung are 2, not 1.
    even: bool,
    /// The lowest rung, of amplitude 0 where there is no ladder.
    first: Sine<R>,
    /// The rungs above it, then those apart.
    sines: [Sine<R>; K],
}

/// A sine and cosine cost as much as so many rungs of a ladder.
const RUNGS_FOR_A_SINE: usize = 3;

impl<R: Real, const K: usize> Series<R, K> {
    fn new(terms: &[Term<R>; K], angle_per_theta: R) -> Self {
        let present = || terms.iter().filter(|term| term.amplitude != R::ZERO);
        let even = present().all(|term| term.order % 2 == 0);
        let rung = |term: &Term<R>| (term.order >> u32::from(even)) as usize;
        let on = |rungs| present().filter(|term| (1..=rungs).contains(&rung(term))).count();
        let above = (ladder::<K>(present().count(), on) - 1) as u32;
        let mut series =
            Self { first: Sine::default(), sines: [Sine::default(); K], above, len: above, even };
        for term in present() {
            if let Some(sine) = series.place(rung(term)) {
                sine.add_term(term, angle_per_theta);
            }
        }
        series
    }

    /// Place of a term of this rung; a term off the ladder has a place of its own: there is one for every term.
    fn place(&mut self, rung: usize) -> Option<&mut Sine<R>> {
        let place = match rung.wrapping_sub(2) {
            usize::MAX => return Some(&mut self.first),
            above if above < self.above as usize => above,
            _ => self.len as usize,
        };
        self.len = self.len.max(place as u32 + 1);
        self.sines.get_mut(place)
    }

    fn is_empty(&self) -> bool {
        self.first == Sine::default() && self.len == 0
    }

    /// Sum of the ladder.
    #[inline(always)]
    fn on_ladder(&self, heading: Heading<R>) -> ErrorAndSlope<R> {
        let stride = if self.even { heading.plus(heading) } else { heading };
        let (mut at, mut sum) = (stride, self.first.at(stride));
        for sine in self.sines.iter().take(self.above as usize) {
            at = at.plus(stride);
            sum = sum.plus(sine.at(at));
        }
        sum
    }

    /// Sum of the rest.
    fn apart(&self, phase: u32) -> ErrorAndSlope<R> {
        let sines = self.sines.iter().take(self.len as usize).skip(self.above as usize);
        sines.fold(ErrorAndSlope::default(), |sum, sine| {
            sum.plus(sine.at(Heading::of_phase(sine.order.wrapping_mul(phase))))
        })
    }
}

/// Rungs of the ladder for so many `terms`, of which so many are `on` a ladder of so many rungs: the most that
/// leave places for the terms off it, end with a term, and are worth it; the first is always there.
fn ladder<const K: usize>(terms: usize, on: impl Fn(usize) -> usize) -> usize {
    let fits = |rungs: &usize| {
        let on_it = on(*rungs);
        on_it > on(rungs - 1) && rungs - 1 + terms - on_it <= K && *rungs <= RUNGS_FOR_A_SINE * on_it
    };
    (2..=K).rev().find(fits).unwrap_or(1)
}

/// The kinematic error at one angle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorAndSlope<R> {
    /// e (rad) at the output.
    pub error: R,
    /// de/dtheta.
    pub slope: R,
}

impl<R: Real> ErrorAndSlope<R> {
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self { error: self.error + other.error, slope: self.slope + other.slope }
    }
}

/// Built model; it has no state.
///
/// Even orders repeat every half turn of the wave generator; an order relative to the flexspline beats with the same
/// order relative to the case:
///
/// ```
/// use strainwave::kinematic_error::{KinematicErrorParams, Term};
/// use strainwave::{Angle, Ratio};
///
/// let ratio = Ratio::one_over(-100)?;
/// let second = Term { order: 2, amplitude: 1e-4_f64, phase: 0.0 };
/// let of_case = KinematicErrorParams { case: [second], ..Default::default() }.build(ratio)?;
/// let at = |turns: f64| Angle::from_radians_f64(turns * std::f64::consts::TAU);
/// assert!((of_case.at(at(0.1)).error - of_case.at(at(0.6)).error).abs() < 1e-12);
/// assert!((of_case.at(at(0.125)).error - 1e-4).abs() < 1e-12); // its peak, at the output (rad)
///
/// let both = KinematicErrorParams { case: [second], flexspline: [second] }.build(ratio)?;
/// let amplitude = |turn: f64| (0..100).map(|k| both.at(at(turn + f64::from(k) / 100.0)).error).fold(0.0, f64::max);
/// assert!(amplitude(0.0) > 1.9e-4 && amplitude(24.5) < 0.2e-4); // in phase, and a quarter turn of the output later
/// # Ok::<(), strainwave::Error>(())
/// ```
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KinematicError<R, const K: usize> {
    ratio: Ratio,
    /// There is more than the ladder of the case.
    more: bool,
    case: Series<R, K>,
    flexspline: Series<R, K>,
}

impl<R: Real, const K: usize> KinematicError<R, K> {
    /// e and de/dtheta at the wave generator's angle `theta`. Finite for any input: only whole counts are read.
    #[inline(always)]
    pub fn at(&self, theta: Angle<R>) -> ErrorAndSlope<R> {
        self.evaluate(theta.counts, theta.heading())
    }

    /// The same of an angle's counts, where its heading is at hand.
    // Never inlined: the timing budget counts this block by its symbol. Numbers come in registers.
    #[inline(never)]
    pub fn evaluate(&self, theta: i64, heading: Heading<R>) -> ErrorAndSlope<R> {
        let sum = self.case.on_ladder(heading);
        if self.more { self.plus_more(sum, theta) } else { sum }
    }

    /// Apart in the code too: a gear that has no more saves no registers for it.
    #[inline(never)]
    fn plus_more(&self, sum: ErrorAndSlope<R>, theta: i64) -> ErrorAndSlope<R> {
        let sum = sum.plus(self.case.apart(theta as u32));
        if self.flexspline.is_empty() {
            return sum;
        }
        let theta = Angle::<R>::from_counts(theta);
        let phase = theta.less(self.ratio.apply(theta)).phase();
        sum.plus(self.flexspline.on_ladder(Heading::of_phase(phase))).plus(self.flexspline.apart(phase))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::real::RADIANS_PER_COUNT;
    use proptest::prelude::*;

    const REVOLUTION: i64 = 1 << 32;

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

    fn evaluate<R: Real, const K: usize>(model: &KinematicError<R, K>, counts: i64) -> ErrorAndSlope<R> {
        model.at(Angle::from_counts(counts))
    }

    proptest! {
        #[test]
        fn it_is_the_sum_of_sines(counts in -REVOLUTION..REVOLUTION, n in prop::sample::select(&[-100, -50, 81, 101][..])) {
            let ratio = Ratio::one_over(n).unwrap();
            let found = evaluate(&params::<f64>().build(ratio).unwrap(), counts);
            let (theta, r) = (counts as f64 * RADIANS_PER_COUNT, 1.0 / f64::from(n));
            let mut expected = ErrorAndSlope::<f64>::default();
            let mut add = |term: &Term<f64>, angle: f64, per_theta: f64| {
                let order = f64::from(term.order);
                expected.error += term.amplitude * (order * angle + term.phase).sin();
                expected.slope += term.amplitude * order * per_theta * (order * angle + term.phase).cos();
            };
            params().case.iter().for_each(|term| add(term, theta, 1.0));
            params().flexspline.iter().for_each(|term| add(term, theta * (1.0 - r), 1.0 - r));
            prop_assert!((found.error - expected.error).abs() < 2e-12);
            prop_assert!((found.slope - expected.slope).abs() < 1e-11);
        }

        /// Whatever is on the ladder, off it, there twice, or constant.
        #[test]
        fn any_orders_are_the_sum_of_sines(
            counts in -REVOLUTION..REVOLUTION,
            orders in prop::array::uniform8(prop_oneof![0..=20u32, 0..=1000u32, (0..=8u32).prop_map(|k| 2 * k)]),
            present in 0..=8usize,
        ) {
            let amplitude = |k: usize| if k < present { 1e-5 * (k + 1) as f64 } else { 0.0 };
            let terms: [Term<f64>; 8] = core::array::from_fn(|k| term(orders[k], amplitude(k), 0.3 * k as f64));
            let single = terms.map(|t| term::<f32>(t.order, t.amplitude, t.phase));
            let ratio = Ratio::one_over(-100).unwrap();
            let theta = counts as f64 * RADIANS_PER_COUNT;
            let argument = |t: &Term<f64>| f64::from(t.order) * theta + t.phase;
            let expected: f64 = terms.iter().map(|t| t.amplitude * argument(t).sin()).sum();
            let slope: f64 = terms.iter().map(|t| t.amplitude * f64::from(t.order) * argument(t).cos()).sum();
            let case = |case| KinematicErrorParams { case, flexspline: [Term::default(); 8] };
            let found = evaluate(&case(terms).build(ratio).unwrap(), counts);
            prop_assert!((found.error - expected).abs() < 1e-12 && (found.slope - slope).abs() < 1e-9);
            let case = KinematicErrorParams { case: single, flexspline: [Term::default(); 8] };
            let single = evaluate(&case.build(ratio).unwrap(), counts);
            prop_assert!((f64::from(single.error) - expected).abs() < 4e-7 * 3.6e-4);
        }

        #[test]
        fn the_slope_is_the_derivative(counts: i64, n in prop::sample::select(&[-100, 101][..])) {
            let ratio = Ratio::one_over(n).unwrap();
            let model = params::<f64>().build(ratio).unwrap();
            let (span, at) = (1 << 20, |counts| evaluate(&model, counts));
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
            let moved = counts.wrapping_add(half * REVOLUTION / 2);
            prop_assert_eq!(evaluate(&model, counts), evaluate(&model, moved));
        }

        #[test]
        fn a_million_turns_change_nothing_in_f32(phase in 0..REVOLUTION) {
            // 101 revolutions of the wave generator are 100 relative to the flexspline.
            let ratio = Ratio::one_over(101).unwrap();
            let model = params::<f32>().build(ratio).unwrap();
            let far = evaluate(&model, phase + 1_010_000 * REVOLUTION);
            let near = evaluate(&model, phase);
            prop_assert!((far.error - near.error).abs() <= 1e-9);
        }

        #[test]
        fn f32_follows_f64(counts: i64) {
            let ratio = Ratio::one_over(101).unwrap();
            let single = evaluate(&params::<f32>().build(ratio).unwrap(), counts);
            let double = evaluate(&params::<f64>().build(ratio).unwrap(), counts);
            prop_assert!((f64::from(single.error) - double.error).abs() < 1e-10);
            prop_assert!((f64::from(single.slope) - double.slope).abs() < 2e-10);
        }

        #[test]
        fn any_bits_of_the_rest_give_a_finite_error(counts: i64, rest: u32) {
            let ratio = Ratio::one_over(-100).unwrap();
            let model = params::<f32>().build(ratio).unwrap();
            let rest = f32::from_bits(rest);
            let found = model.at(Angle { counts, rest });
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
