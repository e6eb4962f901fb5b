//! Weights mu(alpha, beta) of the Preisach relays on a triangular grid of L levels.
//!
//! mu_ij >= 0 belongs to the relay that switches up in cell i and down in cell j <= i; its unit is
//! the output's. The weights are symmetric, mu_ij = mu_(L-1-j)(L-1-i): only then has the
//! demagnetised operator zero output, and the loop no preferred direction.
//!
//! Standard shape: even weight over the triangle alpha >= beta, |alpha|, |beta| <= U. Cells on the
//! diagonal are half inside, so with the total S
//!
//! ```text
//! mu_ij = 2*S/L^2 (i > j),   S/L^2 (i = j)          L*(L-1)/2 * 2*S/L^2 + L * S/L^2 = S
//! ```

use crate::error::{Error, require};
use crate::real::Real;

/// Checked weights; `L` levels, at least 2.
///
/// Weights need not be even, but symmetric; the output at saturation is their sum:
///
/// ```
/// use strainwave::Error;
/// use strainwave::hysteresis::{Staircase, StaircaseState, Weights};
///
/// let narrow = Weights::<f64, 8>::from_fn(|i, j| if i - j < 3 { 0.1 } else { 0.0 })?;
/// let operator = Staircase::<f64, 8, 16>::build(1.0, &narrow)?;
/// let saturated = operator.step(&mut StaircaseState::default(), 1.0).output;
/// assert!((saturated - narrow.total()).abs() < 1e-12);
/// let lopsided = Weights::<f64, 8>::from_fn(|i, _| if i == 7 { 0.1 } else { 0.0 });
/// assert_eq!(lopsided.err(), Some(Error::OutOfRange("weight")));
/// # Ok::<(), strainwave::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights<R, const L: usize> {
    /// Row i, column j <= i; zero above the diagonal.
    rows: [[R; L]; L],
}

impl<R: Real, const L: usize> Weights<R, L> {
    /// Even weight over the triangle with the sum `total`, 0..=1e6.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `total` or `levels`.
    pub fn uniform(total: R) -> Result<Self, Error> {
        require((R::ZERO..=R::lit(1e6)).contains(&total), "total")?;
        let levels = R::from_i32(L as i32);
        let half_cell = total / (levels * levels);
        Self::from_fn(|i, j| if i == j { half_cell } else { half_cell + half_cell })
    }

    /// mu_ij = `weight(i, j)` for j <= i < `L`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `levels` when `L` is not in 2..=1000, `weight` when one is negative,
    /// above 1e6 or not equal to its mirror image.
    pub fn from_fn(weight: impl Fn(usize, usize) -> R) -> Result<Self, Error> {
        Self::within(R::ZERO, weight)
    }

    /// The same with weights of either sign, which some actuators need: neither monotone nor dissipative.
    ///
    /// # Errors
    /// As [`Self::from_fn`], `weight` when one is beyond +-1e6.
    pub fn signed_from_fn(weight: impl Fn(usize, usize) -> R) -> Result<Self, Error> {
        Self::within(R::lit(-1e6), weight)
    }

    fn within(least: R, weight: impl Fn(usize, usize) -> R) -> Result<Self, Error> {
        require((2..=1000).contains(&L), "levels")?;
        let mut rows = [[R::ZERO; L]; L];
        for (i, row) in rows.iter_mut().enumerate() {
            for (j, place) in row.iter_mut().enumerate().take(i + 1) {
                *place = weight(i, j);
                require((least..=R::lit(1e6)).contains(place), "weight")?;
                require(*place == weight(L - 1 - j, L - 1 - i), "weight")?;
            }
        }
        Ok(Self { rows })
    }

    /// Sum of the magnitudes: no output is larger.
    pub(crate) fn magnitude(&self) -> R {
        self.rows.as_flattened().iter().fold(R::ZERO, |sum, weight| sum + weight.abs())
    }

    /// No weight is below zero.
    pub(crate) fn is_dissipative(&self) -> bool {
        self.rows.as_flattened().iter().all(|&weight| weight >= R::ZERO)
    }

    /// mu_ij; zero outside the triangle.
    #[inline]
    pub fn at(&self, i: usize, j: usize) -> R {
        self.rows.get(i).and_then(|row| row.get(j)).copied().unwrap_or(R::ZERO)
    }

    /// Sum of all weights: the output at saturation.
    pub fn total(&self) -> R {
        self.rows.iter().flatten().fold(R::ZERO, |sum, &weight| sum + weight)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_standard_shape_sums_to_its_total() {
        assert!((Weights::<f64, 8>::uniform(9.0).unwrap().total() - 9.0).abs() < 1e-14);
        assert!((Weights::<f64, 50>::uniform(9.0).unwrap().total() - 9.0).abs() < 1e-13);
    }

    #[test]
    fn a_weight_out_of_range_is_named() {
        let named = |result: Result<Weights<f64, 4>, Error>| result.unwrap_err();
        assert_eq!(named(Weights::uniform(f64::NAN)), Error::OutOfRange("total"));
        assert_eq!(named(Weights::from_fn(|_, _| -1.0)), Error::OutOfRange("weight"));
        assert_eq!(named(Weights::from_fn(|i, _| i as f64)), Error::OutOfRange("weight"));
        assert_eq!(Weights::<f64, 4>::signed_from_fn(|_, _| -1.0).unwrap().total(), -10.0);
        assert_eq!(named(Weights::signed_from_fn(|_, _| -2e6)), Error::OutOfRange("weight"));
        assert_eq!(Weights::<f64, 1>::uniform(1.0).unwrap_err(), Error::OutOfRange("levels"));
    }
}
