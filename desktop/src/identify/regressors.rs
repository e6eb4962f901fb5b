//! Regressors of the weights: the output of the operator along an input, with one weight at a time.
//!
//! ```text
//! y(t) = sum over p of mu_p * x_p(t)        x_p = the operator with mu_p = 1 and all others 0
//! ```
//!
//! Between grid inputs the Everett table is interpolated, which keeps the output linear in the weights: with
//! the x_p of the operator's own code the fitted output is that of the identified operator, to rounding.
//! The weights are symmetric, mu_ij = mu_(L-1-j)(L-1-i), so p counts pairs of mirror images.

use nalgebra::DMatrix;
use strainwave::hysteresis::Weights;

use super::Error;

/// One of each two mirror images, i + j < `L`, row by row.
pub fn pairs<const L: usize>() -> impl Iterator<Item = (usize, usize)> + Clone {
    (0..L).flat_map(|i| (0..=i.min(L - 1 - i)).map(move |j| (i, j)))
}

/// The weights from one number a pair.
///
/// # Errors
/// As [`Weights::from_fn`], or when `signed` as [`Weights::signed_from_fn`].
pub fn weights_of<const L: usize>(values: &[f64], signed: bool) -> Result<Weights<f64, L>, Error> {
    let mut table = [[0.0; L]; L];
    for ((i, j), value) in pairs::<L>().zip(values) {
        table[i][j] = *value;
        table[L - 1 - j][L - 1 - i] = *value;
    }
    let weight = |i: usize, j: usize| table[i][j];
    Ok(if signed { Weights::signed_from_fn(weight) } else { Weights::from_fn(weight) }?)
}

/// A row for each input, a column for each pair; `operator` makes the operator of some weights, at its start.
///
/// # Errors
/// As `operator`.
pub fn regressors<const L: usize, F: FnMut(f64) -> f64>(
    inputs: &[f64],
    operator: impl Fn(&Weights<f64, L>) -> Result<F, strainwave::Error>,
) -> Result<DMatrix<f64>, Error> {
    let count = pairs::<L>().count();
    let mut found = DMatrix::zeros(inputs.len(), count);
    for (column, pair) in pairs::<L>().enumerate() {
        let mirror = (L - 1 - pair.1, L - 1 - pair.0);
        let unit = Weights::from_fn(|i, j| f64::from((i, j) == pair || (i, j) == mirror))?;
        let mut operator = operator(&unit)?;
        inputs.iter().enumerate().for_each(|(row, input)| found[(row, column)] = operator(*input));
    }
    Ok(found)
}
