//! Joint covariance of identified parameters: how well the logs tell each of them, and which they do not tell apart.
//!
//! It is that of the least squares around what was found, with the noise that this least squares counts with: what the model
//! misses is alike over some time or path, so that rows close to each other are one witness. Priors and smoothness count as
//! knowledge. Parameters at a bound are none of it.

use nalgebra::{DMatrix, DVector};

/// Covariance of named parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Covariance {
    names: Vec<String>,
    matrix: DMatrix<f64>,
}

impl Covariance {
    /// Of parameters that are sums of unknowns with this covariance: `sums` has a row for each name. Those without a variance are left out.
    pub(super) fn of_sums(names: Vec<String>, sums: &DMatrix<f64>, unknowns: &DMatrix<f64>) -> Self {
        let matrix = sums * unknowns * sums.transpose();
        let kept: Vec<_> = (0..names.len()).filter(|k| matrix[(*k, *k)] > 0.0).collect();
        Self {
            names: kept.iter().map(|k| names[*k].clone()).collect(),
            matrix: matrix.select_rows(&kept).select_columns(&kept),
        }
    }

    /// Of one parameter.
    pub(crate) fn of_one(name: &str, deviation: f64) -> Self {
        Self { names: vec![name.to_owned()], matrix: DMatrix::from_element(1, 1, deviation * deviation) }
    }

    /// The parameters.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Standard error of a parameter, in its unit; `None` when it is not among them.
    pub fn standard_error(&self, name: &str) -> Option<f64> {
        self.error_of_sum(&[(name, 1.0)])
    }

    /// Standard error of the sum of parameters times factors; `None` when one is not among them.
    pub fn error_of_sum(&self, terms: &[(&str, f64)]) -> Option<f64> {
        let mut factors = DVector::zeros(self.names.len());
        for (name, factor) in terms {
            factors[self.names.iter().position(|known| known == name)?] += factor;
        }
        Some((factors.transpose() * &self.matrix * &factors)[0].max(0.0).sqrt())
    }

    /// Correlation of two of [`Self::names`], by their places.
    pub fn correlation(&self, a: usize, b: usize) -> f64 {
        self.matrix[(a, b)] / (self.matrix[(a, a)] * self.matrix[(b, b)]).sqrt()
    }

    /// Pairs of parameters whose correlation is at least `least` in magnitude, with it.
    pub fn alike(&self, least: f64) -> impl Iterator<Item = (&str, &str, f64)> {
        let pairs = (0..self.names.len()).flat_map(|a| (0..a).map(move |b| (b, a)));
        pairs
            .map(|(a, b)| (self.names[a].as_str(), self.names[b].as_str(), self.correlation(a, b)))
            .filter(move |(.., correlation)| correlation.abs() >= least)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_and_correlations_are_those_of_sums() {
        let unknowns = DMatrix::from_row_slice(3, 3, &[4.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
        let sums = DMatrix::from_row_slice(3, 3, &[1.0, 0.0, 0.0, 0.0, -2.0, 0.0, 0.0, 0.0, 1.0]);
        let found = Covariance::of_sums(["a", "b", "known"].map(String::from).to_vec(), &sums, &unknowns);
        assert_eq!(found.names(), ["a", "b"]);
        assert_eq!((found.standard_error("a"), found.standard_error("b")), (Some(2.0), Some(2.0)));
        assert_eq!((found.standard_error("known"), found.correlation(0, 1)), (None, -0.5));
        assert_eq!(found.error_of_sum(&[("a", 1.0), ("b", 1.0)]), Some(2.0));
        assert_eq!(found.alike(0.5).collect::<Vec<_>>(), [("a", "b", -0.5)]);
        assert_eq!(found.alike(0.6).count(), 0);
        assert_eq!(Covariance::of_one("c", 3.0).standard_error("c"), Some(3.0));
    }
}
