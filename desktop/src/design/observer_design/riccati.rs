//! The filter's Riccati equation, by the eigenvectors of its symplectic matrix.
//!
//! ```text
//! P = A P (1 + G P)^-1 A' + Q,   G = C' R^-1 C        P: covariance before a reading
//! Z = [ F + G F^-T Q   -G F^-T ]
//!     [    -F^-T Q        F^-T ],   F = A'            Z [U; V] = [U; V] S, |S| < 1:   P = V U^-1
//! ```
//!
//! Of the 2n eigenvalues of Z n lie inside the unit circle, their inverses outside. On it lie those of what the sensors
//! cannot see and no noise moves: then there is no filter. The eigenvectors are faer's; the last digits are those of the
//! recursion itself, which contracts.
//!
//! A. Laub, "A Schur method for solving algebraic Riccati equations", IEEE Transactions on Automatic Control 24
//! (1979); D. Vaughan, "A nonrecursive algebraic solution for the discrete Riccati equation", ibid. 15 (1970).

use faer::Mat;
use nalgebra::{Complex, DMatrix};

/// Steps of the recursion after the eigenvectors.
const POLISH: usize = 50;
/// Largest residual, relative to the covariance's diagonal.
const RESIDUAL: f64 = 1e-6;
/// Least distance of an eigenvalue from the unit circle, inside it.
const MARGIN: f64 = 1e-9;

/// Covariance before a reading; `None` when there is none: not observable, or not finite.
pub(super) fn covariance(
    a: &DMatrix<f64>,
    information: &DMatrix<f64>,
    noise: &DMatrix<f64>,
) -> Option<DMatrix<f64>> {
    let mut p = from_eigenvectors(a, information, noise)?;
    for _ in 0..POLISH {
        p = step(a, information, noise, &p)?;
    }
    let finite = p.iter().all(|entry| entry.is_finite());
    (finite && residual(a, information, noise, &p)? < RESIDUAL && p.clone().cholesky().is_some()).then_some(p)
}

/// One period of the recursion.
fn step(
    a: &DMatrix<f64>,
    information: &DMatrix<f64>,
    noise: &DMatrix<f64>,
    p: &DMatrix<f64>,
) -> Option<DMatrix<f64>> {
    let one = DMatrix::identity(a.nrows(), a.nrows());
    let next = a * p * (one + information * p).try_inverse()? * a.transpose() + noise;
    Some((&next + next.transpose()) * 0.5)
}

/// Residual change of the recursion: entries span 20 decades, so each is compared on the scale of its own two states.
pub(super) fn residual(
    a: &DMatrix<f64>,
    information: &DMatrix<f64>,
    noise: &DMatrix<f64>,
    p: &DMatrix<f64>,
) -> Option<f64> {
    let change = step(a, information, noise, p)? - p;
    let scale = |row: usize, column: usize| (p[(row, row)] * p[(column, column)]).sqrt();
    let size = change.nrows();
    Some(
        (0..size * size).map(|k| (k / size, k % size)).fold(0.0, |worst: f64, (row, column)| {
            worst.max(change[(row, column)].abs() / scale(row, column))
        }),
    )
}

fn from_eigenvectors(
    a: &DMatrix<f64>,
    information: &DMatrix<f64>,
    noise: &DMatrix<f64>,
) -> Option<DMatrix<f64>> {
    let n = a.nrows();
    let f = a.transpose();
    let inverse = a.clone().try_inverse()?;
    let mut z = DMatrix::zeros(2 * n, 2 * n);
    z.view_mut((0, 0), (n, n)).copy_from(&(f + information * &inverse * noise));
    z.view_mut((0, n), (n, n)).copy_from(&-(information * &inverse));
    z.view_mut((n, 0), (n, n)).copy_from(&-(&inverse * noise));
    z.view_mut((n, n), (n, n)).copy_from(&inverse);
    if !z.iter().all(|entry| entry.is_finite()) {
        return None;
    }
    let eigen = Mat::from_fn(2 * n, 2 * n, |row, column| z[(row, column)]).eigen().ok()?;
    let (values, vectors) = (eigen.S(), eigen.U());
    let inside: Vec<usize> = (0..2 * n)
        .filter(|&k| values.column_vector()[k].re.hypot(values.column_vector()[k].im) < 1.0 - MARGIN)
        .collect();
    if inside.len() != n {
        return None;
    }
    let part = |from: usize| {
        DMatrix::from_fn(n, n, |row, column| {
            let entry = vectors[(from + row, inside[column])];
            Complex::new(entry.re, entry.im)
        })
    };
    let p = (part(n) * part(0).try_inverse()?).map(|entry| entry.re);
    Some((&p + p.transpose()) * 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x(k+1) = x + w, y = x + v with variances q and 1: p^2 = q*(p + 1).
    #[test]
    fn a_random_walk_has_its_closed_form() {
        let one = |value: f64| DMatrix::from_element(1, 1, value);
        for q in [1e-6, 1.0, 1e3] {
            let p = covariance(&one(1.0), &one(1.0), &one(q)).unwrap()[(0, 0)];
            let exact = 0.5 * q + (0.25 * q * q + q).sqrt();
            assert!((p / exact - 1.0).abs() < 1e-12, "{p} {exact}");
        }
    }

    #[test]
    fn what_no_sensor_sees_has_no_covariance() {
        let a = DMatrix::identity(2, 2);
        let sees_one = DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 0.0, 0.0]);
        assert_eq!(covariance(&a, &sees_one, &DMatrix::identity(2, 2)), None);
        assert_eq!(covariance(&(a * f64::NAN), &sees_one, &DMatrix::identity(2, 2)), None);
    }
}
