//! Force along a link, and its potential: stretch and shear linear, bend with hardening.
//!
//! ```text
//! u = 1 - L^2/L0^2                           -u/2 is Green's strain e
//! g = L0/L - 1 = (1 - u)^(-1/2) - 1 = u/2 + 3*u^2/8 + 5*u^3/16 + 35*u^4/128 + 63*u^5/256 + ...
//! tension/L = -k*g*(1 + hardening*min(e^2, saturation^2))     in a bend link; hardening = 0 in the others
//! ```
//!
//! so that k*(L - L0) along the link is `-k*g` times the vector from node to node: no square root, no
//! division, and no difference of two nearly equal lengths. Strains are small, hence the series; it is
//! cut after u^5 in f64 and after u^4 in f32. The truncation error relative to g is 0.45*u^5 and 0.49*u^4:
//!
//! | strain | 0.1 % | 0.5 % | 1 % | 10 % |
//! | --- | --- | --- | --- | --- |
//! | f64 | 2e-14 | 5e-11 | 1.5e-9 | 2e-4 |
//! | f32 | 8e-12 | 5e-9 | 8e-8 | 1e-3 |
//!
//! From the assembled shape a bend link hardens by a cubic that goes on straight, with no jump of the slope: beside -k*g,
//!
//! ```text
//! tension/L = k*hardening*(y^3 + 3*saturation^2*(x - y)),   x = e - e_assembled,   y = x within +-saturation
//! ```
//!
//! Odd in the strain to first order, monotone and hardening; beyond `saturation` a bend link is a linear
//! spring again, stiffer by 1 + hardening*saturation^2. The law is the derivative of its potential, exactly,
//! so a mesh of such links keeps its energy. Beyond [`VALID_STRAIN`] it is no longer eq. (6).

use crate::error::{Error, require};
use crate::real::Real;

/// Largest strain of a link, either way, up to which the series is eq. (6) within 0.1 %.
pub const VALID_STRAIN: f64 = 0.1;

/// Coefficients of g over u: (2n)!/(4^n*(n!)^2) for n = 1...
const SERIES: [f64; 5] = [0.5, 0.375, 0.3125, 0.2734375, 0.24609375];

/// Hardening of the bend links.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bend<R> {
    /// Relative gain of the stiffness per strain squared, 0 for none.
    pub hardening: R,
    /// Strain from which on it gains no more.
    pub saturation: R,
}

impl<R: Real> Bend<R> {
    /// Bend links like the others.
    pub const LINEAR: Self = Self { hardening: R::ZERO, saturation: R::ZERO };

    /// # Errors
    /// [`Error::OutOfRange`] `bend_hardening` unless finite and not negative, `bend_saturation` unless 0 to
    /// [`VALID_STRAIN`].
    pub fn check(&self) -> Result<(), Error> {
        require(self.hardening >= R::ZERO && self.hardening.is_finite(), "bend_hardening")?;
        let valid = self.saturation >= R::ZERO && self.saturation <= R::lit(VALID_STRAIN);
        require(valid, "bend_saturation")
    }

    /// The bend link's stiffness over that of a linear one, at u.
    #[inline(always)]
    pub(super) fn factor(&self, u: R) -> R {
        let strain = (R::lit(0.5) * u).limit(self.saturation);
        R::ONE + self.hardening * strain * strain
    }

    /// What hardening adds to a bend link of constant 1 N/m: tension over length (N/m) at a strain from the assembled shape.
    #[inline(always)]
    pub(in crate::flexspline) fn assembled_tension(&self, strain: R) -> R {
        let inside = strain.limit(self.saturation);
        let beyond = R::lit(3.0) * self.saturation * self.saturation * (strain - inside);
        self.hardening * (inside * inside * inside + beyond)
    }

    /// Slope of [`Self::assembled_tension`].
    pub(in crate::flexspline) fn assembled_slope(&self, strain: R) -> R {
        let inside = strain.limit(self.saturation);
        R::lit(3.0) * self.hardening * inside * inside
    }

    /// Integral of [`Self::assembled_tension`]: energy of a link of constant 1 N/m and rest length 1 m (J).
    pub(in crate::flexspline) fn assembled_potential(&self, strain: R) -> R {
        let inside = strain.limit(self.saturation);
        let (square, beyond) = (inside * inside, strain - inside);
        let cubic = R::lit(0.25) * square * square + square * inside * beyond;
        self.hardening * (cubic + R::lit(1.5) * self.saturation * self.saturation * beyond * beyond)
    }

    /// Slope of a bend link's tension over its strain, over that of a linear one, to first order in the strain.
    pub(in crate::flexspline) fn slope(&self, strain: R) -> R {
        let inside = strain.abs() < self.saturation;
        let (bound, factor) = if inside { (strain, R::lit(3.0)) } else { (self.saturation, R::ONE) };
        R::ONE + factor * self.hardening * bound * bound
    }

    /// Energy of a link of constant 1 N/m and rest length 1 m, at u (J).
    pub(super) fn potential(&self, u: R) -> R {
        let inside = u.limit(R::lit(2.0) * self.saturation);
        let quarter = R::lit(0.25) * self.hardening;
        let soft = integral(u, 0) + quarter * integral(inside, 2);
        let beyond = quarter * inside * inside * (integral(u, 0) - integral(inside, 0));
        R::lit(0.5) * (soft + beyond)
    }
}

/// Number of terms of the series, by the scalar's precision.
const fn terms<R: Real>() -> usize {
    if R::MANTISSA_DIGITS > 24 { SERIES.len() } else { SERIES.len() - 1 }
}

/// g = L0/L - 1 at u.
#[inline(always)]
pub(super) fn shortening<R: Real>(u: R) -> R {
    let c = SERIES.map(R::lit);
    let square = u * u;
    let mut high = c[2] + c[3] * u;
    if terms::<R>() > 4 {
        high += c[4] * square;
    }
    // Pairs, so that no multiplication waits for all the others.
    u * (c[0] + c[1] * u + high * square)
}

/// Integral of g(x)*x^power from 0 to u.
fn integral<R: Real>(u: R, power: i32) -> R {
    let mut sum = R::ZERO;
    for (n, c) in SERIES.into_iter().enumerate().take(terms::<R>()).rev() {
        let order = n as i32 + 2 + power;
        sum = (sum + R::lit(c) / R::from_i32(order)) * u;
    }
    (0..=power).fold(sum, |product, _| product * u)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const HARD: Bend<f64> = Bend { hardening: 4e4, saturation: 5e-3 };

    fn square_of(strain: f64) -> f64 {
        1.0 - (1.0 + strain) * (1.0 + strain)
    }

    /// Tension of a bend link of constant 1 N/m and rest length 1 m (N).
    fn tension(bend: &Bend<f64>, strain: f64) -> f64 {
        let u = square_of(strain);
        -shortening(u) * bend.factor(u) * (1.0 + strain)
    }

    #[test]
    fn the_series_is_as_exact_as_its_table_says() {
        for (strain, double, single) in
            [(1e-3, 2e-14, 8e-12), (5e-3, 5e-11, 5e-9), (1e-2, 1.5e-9, 8e-8), (0.1, 2e-4, 1e-3)]
        {
            let u = square_of(strain);
            // Exact by another formula: -strain/(1 + strain).
            let exact = -strain / (1.0 + strain);
            let error = |g: f64, bound: f64| {
                let found = (g / exact - 1.0).abs();
                assert!(found <= bound + 2e-13, "{found} at {strain}");
            };
            error(shortening(u), double);
            error(f64::from(shortening(u as f32)), single + 4e-7);
        }
    }

    #[test]
    fn a_linear_link_pulls_by_its_elongation() {
        for strain in [-5e-3, -1e-4, 1e-4, 5e-3] {
            assert!((tension(&Bend::LINEAR, strain) - strain).abs() < 1e-12);
        }
    }

    #[test]
    fn a_bend_link_hardens_and_then_saturates() {
        let stiffness = |strain: f64| tension(&HARD, strain) / strain;
        assert!((stiffness(1e-5) - 1.0).abs() < 1e-4);
        assert!((stiffness(5e-3) - 2.0).abs() < 1e-2 && (stiffness(9e-3) - 2.0).abs() < 2e-2);
    }

    proptest! {
        #[test]
        fn tension_rises_with_strain_and_is_odd(strain in 1e-6..9e-3f64) {
            prop_assert!(tension(&HARD, strain + 1e-5) > tension(&HARD, strain));
            let sum = tension(&HARD, strain) + tension(&HARD, -strain);
            // Green's strain, that the hardening goes by, is odd only to first order.
            prop_assert!(sum.abs() < 0.02 * tension(&HARD, strain));
        }

        #[test]
        fn tension_is_the_slope_of_the_potential(strain in -9e-3..9e-3f64) {
            // At the saturation the slope has a kink: half its change times the step.
            let step = 1e-7;
            let energy = |strain| HARD.potential(square_of(strain));
            let slope = (energy(strain + step) - energy(strain - step)) / (2.0 * step);
            prop_assert!((slope - tension(&HARD, strain)).abs() < 2e-7, "{} against {}", slope, tension(&HARD, strain));
        }
    }

    #[test]
    fn bad_parameters_are_refused_by_name() {
        let refused = |hardening, saturation| Bend { hardening, saturation }.check().unwrap_err();
        assert_eq!(refused(-1.0, 0.0), Error::OutOfRange("bend_hardening"));
        assert_eq!(refused(f64::NAN, 0.0), Error::OutOfRange("bend_hardening"));
        assert_eq!(refused(1.0, 0.2), Error::OutOfRange("bend_saturation"));
    }
}
