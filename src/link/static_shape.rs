//! Shape of the beam at rest under each of the link's loads, in closed form.
//!
//! ```text
//! EI*w'' = moment(x)        w(0) = w'(0) = 0        upwards where w > 0
//! acceleration a (rad/s^2)  -a*(mu*(L^3/3 - L^2*x/2 + x^3/6) + M*L*(L - x) + J)
//! tip force F (N)           F*(L - x)
//! weight g (m/s^2)          -g*(mu*(L - x)^2/2 + M*(L - x))
//! couple T (N m)            T for start <= x <= end, else 0
//! ```
//!
//! Units: m, kg, N. For `build` only.

use super::{Beam, LOADS};

/// Deflection (m), slope and curvature (1/m) at x (m) under one unit of each load.
pub(super) fn at(beam: &Beam, x: f64) -> [[f64; LOADS]; 3] {
    let Beam { length: l, density, mass, inertia, .. } = *beam;
    let flexibility = 1.0 / beam.stiffness;
    let (square, cube) = (x * x, x * x * x);
    // Moment of a force at the tip, and its integrals.
    let lever = [0.5 * l * square - cube / 6.0, l * x - 0.5 * square, l - x];
    let turned = [
        l * l * l * square / 6.0 - l * l * cube / 12.0 + cube * square / 120.0,
        l * l * l * x / 3.0 - l * l * square / 4.0 + cube * x / 24.0,
        l * l * l / 3.0 - 0.5 * l * l * x + cube / 6.0,
    ];
    let sagged = [
        0.25 * l * l * square - l * cube / 6.0 + cube * x / 24.0,
        0.5 * l * l * x - 0.5 * l * square + cube / 6.0,
        0.5 * (l - x) * (l - x),
    ];
    let payload = [0.5 * square, x, 1.0];
    let couple = couple(beam, x);
    core::array::from_fn(|order| {
        [
            -(density * turned[order] + mass * l * lever[order] + inertia * payload[order]),
            lever[order],
            -(density * sagged[order] + mass * lever[order]),
            couple[order],
        ]
        .map(|moment| flexibility * moment)
    })
}

/// The couple's moment, twice integrated, once and not.
fn couple(beam: &Beam, x: f64) -> [f64; 3] {
    let Some([start, end]) = beam.patch else { return [0.0; 3] };
    let within = (x - start).max(0.0).min(end - start);
    let beyond = (x - end).max(0.0);
    let inside = if (start..=end).contains(&x) { 1.0 } else { 0.0 };
    [0.5 * within * within + (end - start) * beyond, within, inside]
}
