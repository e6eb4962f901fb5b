//! The part of an output error that is periodic in the wave generator's angle.
//!
//! ```text
//! error(t) = a + b*t + sum_k (c_k*cos(o_k*theta) + s_k*sin(o_k*theta)) + rest,    ripple = sqrt(sum_k (c_k^2 + s_k^2)/2)
//! ```
//!
//! theta is the true angle of the motor (rad), o_k the orders; the coefficients are those of least squares, so that
//! a stretch need not contain whole revolutions.

use nalgebra::{DMatrix, DVector};
use strainwave::gear::GearParams;

use crate::bench::closed_loop::Row;
use crate::verify::judge::error;

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

/// Rms of the output error's part at these orders (rad); NaN where rows are too few to tell.
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
    let normal = regressors.tr_mul(&regressors).cholesky();
    let found = normal.map(|normal| normal.solve(&regressors.tr_mul(&errors)));
    found.map_or(f64::NAN, |found| (0.5 * found.rows_range(2..).norm_squared()).sqrt())
}
