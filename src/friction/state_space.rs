//! Eq. (8) of any order with general A, B, C: Bliman and Sorine's "great number of configuration
//! possibilities".
//!
//! ```text
//! s = integral |v| dt        dx/ds = A x + B sign(v),        F = C x
//! ```
//!
//! A (1/m) or (1/rad), B likewise times the unit of x; F (N) or (N m). [`super::BlimanSorine`] is the case
//! of a diagonal A, and cheaper. Sign: F opposes the motion when subtracted, F*v > 0 in steady sliding,
//! where F = -C A^-1 B.
//!
//! Checked at build:
//!
//! - A is stable (Hurwitz): e^(A*T) vanishes, to 1e-12, over the path T = 2^27/|A|, |A| its largest row
//!   sum. A mode slower than 2e-7 of |A| is refused with the unstable ones.
//! - The model is dissipative: its transfer function from sign(v) to F is positive real
//!   ([`super::positive_real`]), so that no motion from rest gains work, in exact arithmetic.
//!
//! Discretisation: exact. Over a step of constant direction and length ds, with x' = -A^-1 B sign(v),
//!
//! ```text
//! x <- x' + e^(A*ds) (x - x')
//! ```
//!
//! ds is split into n*h, h = 2^-4/|A|, and a rest. e^(A*rest) - 1 acts by the Taylor series, 9 terms in
//! f64, 5 in f32, so that its remainder is below rounding; e^(A*n*h) by the binary digits of n, one stored
//! matrix e^(A*h*2^k) - 1 each, 31 of them. No loop depends on the step: 9*P^2 multiplications in
//! presliding, at most 31*P^2 more in a long step. The matrices are stored minus 1, and doubled as (1 +
//! E)^2 - 1 = 2E + E^2, so that slow modes keep their digits.
//!
//! Known weakness: as Dahl's model, none of its states depends on speed: no Stribeck effect in time; 31*P^2
//! numbers of memory.
//!
//! P.-A. Bliman, M. Sorine, "Easy-to-use realistic dry friction models for automatic control", European
//! Control Conference, 1995; C. Moler, C. Van Loan, "Nineteen dubious ways to compute the exponential of a
//! matrix", SIAM Review 45 (2003).

use super::positive_real::{self, Matrix};
use super::{FrictionModel, FrictionParams, GREATEST, LEAST, Slip};
use crate::error::{Error, require};
use crate::real::Real;

/// Stored powers of e^(A*h).
const DOUBLINGS: usize = 31;
/// |A|*h of the series' step h.
const SHORT: f64 = 0.0625;
/// Largest remainder of e^(A*T).
const VANISHED: f64 = 1e-12;

/// The matrices of eq. (8).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateSpaceParams<R, const P: usize> {
    /// A by rows (1/m) or (1/rad); finite, stable, with a largest row sum of 1e-9..=1e12.
    pub a: [[R; P]; P],
    /// B; within +-1e12.
    pub b: [R; P],
    /// C; within +-1e12; with A and B dissipative.
    pub c: [R; P],
}

impl<R: Real, const P: usize> FrictionParams<R> for StateSpaceParams<R, P> {
    type Model = StateSpace<R, P>;

    /// Checks and precomputes, in f64.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `a` when it is not stable, `b`, `c`; `dissipative` when the transfer function
    /// is not positive real.
    fn build(&self) -> Result<StateSpace<R, P>, Error> {
        let a = self.a.map(|row| row.map(Real::to_f64));
        let (b, c) = (self.b.map(Real::to_f64), self.c.map(Real::to_f64));
        let largest = GREATEST * GREATEST;
        let size = positive_real::norm(&a);
        require(P > 0 && a.iter().flatten().all(|entry| entry.is_finite()), "a")?;
        require((LEAST..=largest).contains(&size), "a")?;
        require(b.iter().all(|entry| entry.abs() <= largest), "b")?;
        require(c.iter().all(|entry| entry.abs() <= largest), "c")?;
        let table = Exponentials::of(&a, &b, SHORT / size);
        require(table.vanish(), "a")?;
        require(positive_real::is_positive_real(&a, &b, &c), "dissipative")?;
        Ok(StateSpace {
            a: self.a,
            c: self.c,
            sliding: table.sliding.map(R::lit),
            powers: table.powers.map(|power| power.map(|row| row.map(R::lit))),
            short: R::lit(SHORT / size),
            per_short: R::lit(size / SHORT),
        })
    }
}

/// e^(A*h*2^k) - 1, and what x comes to after a path of h*2^[`DOUBLINGS`].
struct Exponentials<const P: usize> {
    powers: [Matrix<P>; DOUBLINGS],
    last: Matrix<P>,
    sliding: [f64; P],
}

impl<const P: usize> Exponentials<P> {
    fn of(a: &Matrix<P>, b: &[f64; P], short: f64) -> Self {
        let (mut power, mut sliding) = Self::short(a, b, short);
        let powers = core::array::from_fn(|_| {
            let stored = power;
            let more = positive_real::times(&stored, &sliding);
            sliding = core::array::from_fn(|i| 2.0 * sliding[i] + more[i]);
            let square = positive_real::product(&stored, &stored);
            power = core::array::from_fn(|i| core::array::from_fn(|j| 2.0 * stored[i][j] + square[i][j]));
            stored
        });
        Self { powers, last: power, sliding }
    }

    /// e^(A*h) - 1 and the integral of e^(A*s) B over h, by Taylor series to (|A|h)^12/12! = 7e-24.
    fn short(a: &Matrix<P>, b: &[f64; P], h: f64) -> (Matrix<P>, [f64; P]) {
        let mut term: Matrix<P> = a.map(|row| row.map(|entry| entry * h));
        let (mut power, mut sliding_term) = (term, b.map(|entry| entry * h));
        let mut sliding = sliding_term;
        for order in 2..=12 {
            let factor = h / f64::from(order);
            term = positive_real::product(a, &term).map(|row| row.map(|entry| entry * factor));
            sliding_term = positive_real::times(a, &sliding_term).map(|entry| entry * factor);
            for i in 0..P {
                sliding[i] += sliding_term[i];
                (0..P).for_each(|j| power[i][j] += term[i][j]);
            }
        }
        (power, sliding)
    }

    /// The last power is -1 to [`VANISHED`]; a NaN is not.
    fn vanish(&self) -> bool {
        let mut left = self.last;
        (0..P).for_each(|i| left[i][i] += 1.0);
        left.iter().flatten().all(|entry| entry.abs() <= VANISHED)
    }
}

/// x of eq. (8); zero at rest in the middle of presliding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateSpaceState<R, const P: usize> {
    x: [R; P],
}

impl<R: Real, const P: usize> Default for StateSpaceState<R, P> {
    fn default() -> Self {
        Self { x: [R::ZERO; P] }
    }
}

/// Built model of order `P`.
///
/// Eq. (8) of order 2 by its matrices is [`super::BlimanSorine`] of order 2; matrices that would give work are refused:
///
/// ```
/// use strainwave::Error;
/// use strainwave::friction::{BlimanSorine, FrictionModel, FrictionParams, Slip, StateSpaceParams};
///
/// let (f1, f2, eps, eta) = (1.5_f64, 0.5, 2e-4, 0.3);
/// let mut params = StateSpaceParams {
///     a: [[-1.0 / (eta * eps), 0.0], [0.0, -1.0 / eps]],
///     b: [f1 / (eta * eps), -f2 / eps],
///     c: [1.0, 1.0],
/// };
/// let (general, diagonal) = (params.build()?, BlimanSorine::order_2(f1, f2, eps, eta)?);
/// let (mut one, mut other) = (Default::default(), Default::default());
/// for step in 0..1000 {
///     let slip = Slip::new(if step % 300 < 150 { 0.01 } else { -0.01 }, 1e-4);
///     let difference = general.step(&mut one, &slip).force - diagonal.step(&mut other, &slip).force;
///     assert!(difference.abs() < 1e-12);
/// }
/// params.b = [-f1 / (eta * eps), f2 / eps];
/// assert_eq!(params.build().err(), Some(Error::OutOfRange("dissipative")));
/// # Ok::<(), strainwave::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateSpace<R, const P: usize> {
    a: [[R; P]; P],
    c: [R; P],
    /// -A^-1 B, what x tends to in forward sliding.
    sliding: [R; P],
    /// e^(A*h*2^k) - 1.
    powers: [[[R; P]; P]; DOUBLINGS],
    /// h, and 1/h.
    short: R,
    per_short: R,
}

#[inline(always)]
fn times<R: Real, const P: usize>(a: &[[R; P]; P], x: &[R; P]) -> [R; P] {
    core::array::from_fn(|i| dot(&a[i], x))
}

#[inline(always)]
fn dot<R: Real, const P: usize>(x: &[R; P], y: &[R; P]) -> R {
    x.iter().zip(y).fold(R::ZERO, |sum, (&x, &y)| sum + x * y)
}

impl<R: Real, const P: usize> StateSpace<R, P> {
    /// Moves by `displacement` (m) or (rad), which is no NaN.
    #[inline]
    pub fn slide(&self, state: &mut StateSpaceState<R, P>, displacement: R) {
        let path = displacement.abs();
        let target = self.sliding.map(|x| if displacement < R::ZERO { -x } else { x });
        let whole = (path * self.per_short).to_i32();
        let rest = (path - R::from_i32(whole) * self.short).max(R::ZERO).min(self.short);
        self.slide_short(state, &target, rest);
        if whole == i32::MAX {
            state.x = target;
        } else if whole > 0 {
            self.slide_long(state, &target, whole);
        }
    }

    /// At most h.
    #[inline(always)]
    fn slide_short(&self, state: &mut StateSpaceState<R, P>, target: &[R; P], path: R) {
        // (1/16)^10/10! = 2.5e-19 in f64, (1/16)^6/6! = 8e-11 in f32.
        let terms = if R::MANTISSA_DIGITS > 24 { 9 } else { 5 };
        let mut term: [R; P] = core::array::from_fn(|i| state.x[i] - target[i]);
        for order in 1..=terms {
            let factor = path * R::lit(1.0 / f64::from(order));
            term = times(&self.a, &term).map(|entry| entry * factor);
            (0..P).for_each(|i| state.x[i] += term[i]);
        }
    }

    /// By `whole` times h.
    #[inline(always)]
    fn slide_long(&self, state: &mut StateSpaceState<R, P>, target: &[R; P], whole: i32) {
        let mut left: [R; P] = core::array::from_fn(|i| state.x[i] - target[i]);
        for (k, power) in self.powers.iter().enumerate() {
            if whole >> k & 1 == 1 {
                let change = times(power, &left);
                (0..P).for_each(|i| left[i] += change[i]);
            }
        }
        state.x = core::array::from_fn(|i| target[i] + left[i]);
    }
}

impl<R: Real, const P: usize> FrictionModel<R> for StateSpace<R, P> {
    type State = StateSpaceState<R, P>;
    const RATE_INDEPENDENT: bool = true;

    #[inline(always)]
    fn force(&self, state: &Self::State) -> R {
        dot(&self.c, &state.x)
    }

    #[inline(always)]
    fn advance(&self, state: &mut Self::State, slip: &Slip<R>) {
        self.slide(state, slip.displacement());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::BlimanSorine;
    use crate::friction::bliman_sorine::BlimanSorineState;
    use proptest::prelude::*;

    const PARAMS: StateSpaceParams<f64, 2> =
        StateSpaceParams { a: [[-1.0, 4.0], [-4.0, -2.0]], b: [1.0, 0.5], c: [1.0, 0.5] };

    proptest! {
        /// The diagonal case against its own exact step, from 1e-8 to 1e6 distances.
        #[test]
        fn a_diagonal_system_is_the_cheap_one(
            strokes in prop::collection::vec((-8.0..6.0f64, any::<bool>()), 1..30),
        ) {
            let (f1, f2, eps, eta) = (1.5, 0.5, 0.02, 0.3);
            let diagonal = BlimanSorine::order_2(f1, f2, eps, eta).unwrap();
            let a = [[-1.0 / (eta * eps), 0.0], [0.0, -1.0 / eps]];
            let params = StateSpaceParams { a, b: [f1 / (eta * eps), -f2 / eps], c: [1.0, 1.0] };
            let general = params.build().unwrap();
            let (mut cheap, mut exact) = (BlimanSorineState::default(), StateSpaceState::default());
            for (size, backwards) in strokes {
                let stroke = eps * 10f64.powf(size) * if backwards { -1.0 } else { 1.0 };
                diagonal.slide(&mut cheap, stroke);
                general.slide(&mut exact, stroke);
                prop_assert!((general.force(&exact) - cheap.force()).abs() < 1e-13);
            }
        }

        #[test]
        fn the_force_does_not_depend_on_the_cut(stroke in 1e-4..30.0f64, cuts in 2..200usize) {
            let model = PARAMS.build().unwrap();
            let (mut once, mut often) = (StateSpaceState::default(), StateSpaceState::default());
            model.slide(&mut once, stroke);
            (0..cuts).for_each(|_| model.slide(&mut often, stroke / cuts as f64));
            prop_assert!((model.force(&once) - model.force(&often)).abs() < 1e-13);
        }
    }

    #[test]
    fn endless_sliding_tends_to_the_kinetic_level() {
        let model = PARAMS.build().unwrap();
        // -C A^-1 B with det A = 18.
        let level = (2.0 * 1.0 + 4.0 * 0.5 + 0.5 * (-4.0 + 0.5)) / 18.0;
        for stroke in [100.0, 1e9, 1e300, f64::INFINITY] {
            let mut state = StateSpaceState::default();
            model.slide(&mut state, -stroke);
            assert!((model.force(&state) + level).abs() < 1e-15, "{stroke}");
        }
    }

    #[test]
    fn an_unstable_or_a_giving_system_is_refused_by_name() {
        let name = |params: StateSpaceParams<f64, 2>| params.build().unwrap_err();
        let unstable = StateSpaceParams { a: [[-1.0, 4.0], [4.0, -2.0]], ..PARAMS };
        let ringing = StateSpaceParams { a: [[0.0, 1.0], [-1.0, 0.0]], ..PARAMS };
        let rigid = StateSpaceParams { a: [[0.0; 2]; 2], ..PARAMS };
        assert_eq!([unstable, ringing, rigid].map(name), [Error::OutOfRange("a"); 3]);
        assert_eq!(name(StateSpaceParams { b: [f64::NAN, 0.0], ..PARAMS }), Error::OutOfRange("b"));
        assert_eq!(name(StateSpaceParams { c: [f64::INFINITY, 0.0], ..PARAMS }), Error::OutOfRange("c"));
        assert_eq!(name(StateSpaceParams { c: [-1.0, -0.5], ..PARAMS }), Error::OutOfRange("dissipative"));
        let delayed = StateSpaceParams { a: [[-1.0, 0.0], [1.0, -1.0]], b: [1.0, 0.0], c: [0.0, 1.0] };
        assert_eq!(name(delayed), Error::OutOfRange("dissipative"));
    }
}
