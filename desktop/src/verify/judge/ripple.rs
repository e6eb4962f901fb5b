//! The part of an output error that is periodic in the wave generator's angle.
//!
//! ```text
//! error(t) = a + b*t + sum_k (c_k*cos(o_k*theta) + s_k*sin(o_k*theta)) + rest
//! ripple^2 = mean square of what the waves explain of the error, in addition to a + b*t
//! ```
//!
//! theta is the true angle of the motor (rad), o_k the orders. Explained is the mean square of the projection of the error
//! on the regressors (least squares), less that on 1 and t alone: a stretch need not contain whole revolutions, and orders that
//! it cannot tell apart from each other or from a slope count once. The ripple is never more than the error.

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use strainwave::gear::GearParams;

use crate::bench::closed_loop::Row;
use crate::verify::judge::error;

/// A combination of regressors of this part of the largest one's square is none: rounding.
const DEPENDENT: f64 = 1e-10;

/// Orders over the motor's angle that the kinematic error of a gear has: k of the case, k*(1 - r) of the flexspline.
pub fn orders(gear: &GearParams<f64>) -> Vec<f64> {
    let terms = &gear.kinematic_error;
    let flexspline = 1.0 - 1.0 / f64::from(gear.ratio);
    let of = |terms: &[strainwave::kinematic_error::Term<f64>], factor: f64| -> Vec<f64> {
        let used = terms.iter().filter(|term| term.amplitude != 0.0);
        used.map(|term| factor * f64::from(term.order)).collect()
    };
    [of(&terms.case, 1.0), of(&terms.flexspline, flexspline)].concat()
}

/// Rms of the output error's part at these orders (rad); NaN without rows.
pub fn ripple(rows: &[Row], orders: &[f64]) -> f64 {
    let Some(first) = rows.first() else { return f64::NAN };
    let wave = |row: &Row, column: usize| {
        let angle = orders[column / 2] * (row.motor - first.motor);
        if column.is_multiple_of(2) { angle.cos() } else { angle.sin() }
    };
    let regressors = DMatrix::from_fn(rows.len(), 2 + 2 * orders.len(), |row, column| match column {
        0 => 1.0,
        1 => rows[row].time - first.time,
        _ => wave(&rows[row], column - 2),
    });
    let errors = DVector::from_iterator(rows.len(), rows.iter().map(error));
    let of_waves =
        explained(&regressors, &errors) - explained(&regressors.columns(0, 2).into_owned(), &errors);
    (of_waves.max(0.0) / rows.len() as f64).sqrt()
}

/// Square of the projection of the errors on the regressors.
fn explained(regressors: &DMatrix<f64>, errors: &DVector<f64>) -> f64 {
    let normal = SymmetricEigen::new(regressors.tr_mul(regressors));
    let projected = normal.eigenvectors.tr_mul(&regressors.tr_mul(errors));
    let least = DEPENDENT * normal.eigenvalues.max();
    let directions = normal.eigenvalues.iter().zip(&projected).filter(|(eigenvalue, _)| **eigenvalue > least);
    directions.map(|(eigenvalue, part)| part * part / eigenvalue).sum()
}
