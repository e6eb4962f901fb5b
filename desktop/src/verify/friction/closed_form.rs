//! Bliman-Sorine of order 2 against its closed forms in one-way motion from rest.
//!
//! ```text
//! F(s) = f1*(1 - e^(-s/(eta*eps))) - f2*(1 - e^(-s/eps))
//! level f1 - f2;  slope f1/(eta*eps) - f2/eps at s = 0
//! peak at s = eps*eta/(1 - eta)*ln(f1/(eta*f2))
//! ```

use strainwave::friction::BlimanSorine;
use strainwave::friction::bliman_sorine::BlimanSorineState;

use crate::io::figure::Figure;
use crate::verify::bounds;
use crate::verify::largest;

const F1: f64 = 1.5;
const F2: f64 = 0.5;
const EPS: f64 = 0.02;
const ETA: f64 = 0.3;
/// Steps as fractions of eps.
const STEPS: [f64; 8] = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0];
/// Steps of each size.
const COUNT: u32 = 1000;

pub(super) fn measure() -> Vec<Figure> {
    let shape = largest([
        relative_error(level(), F1 - F2),
        slope_error(),
        relative_error(peak_place(), closed_place()),
        peak_error(),
    ]);
    vec![
        bounds::figure("friction.closed_form", worst_over_the_path()),
        bounds::figure("friction.closed_form.shape", shape),
    ]
}

/// Relative error.
fn relative_error(measured: f64, exact: f64) -> f64 {
    (measured / exact - 1.0).abs()
}

fn closed(s: f64) -> f64 {
    F2 * (-s / EPS).exp_m1() - F1 * (-s / (ETA * EPS)).exp_m1()
}

fn closed_place() -> f64 {
    EPS * ETA / (1.0 - ETA) * (F1 / (ETA * F2)).ln()
}

fn order_2() -> BlimanSorine<f64, 2> {
    BlimanSorine::order_2(F1, F2, EPS, ETA).expect("the levels are in range")
}

fn after<const P: usize>(model: &BlimanSorine<f64, P>, s: f64) -> f64 {
    let mut state = BlimanSorineState::default();
    model.slide(&mut state, s);
    state.force()
}

fn worst_over_the_path() -> f64 {
    let model = order_2();
    largest(STEPS.map(|fraction| {
        let mut state = BlimanSorineState::default();
        largest((1..=COUNT).map(|k| {
            model.slide(&mut state, fraction * EPS);
            relative_error(state.force(), closed(f64::from(k) * fraction * EPS))
        }))
    }))
}

fn level() -> f64 {
    after(&order_2(), 100.0 * EPS)
}

/// Over a way so short that the curve is straight to rounding.
fn slope_error() -> f64 {
    let s = 1e-14 * EPS;
    relative_error(after(&order_2(), s) / s, F1 / (ETA * EPS) - F2 / EPS)
}

/// Path at which the two forces, each an order 1 of its own, change equally fast: by bisection.
fn peak_place() -> f64 {
    let order_1 = |level, distance| BlimanSorine::order_1(level, distance).expect("the level is in range");
    let (rising, falling) = (order_1(F1, ETA * EPS), order_1(F2, EPS));
    let slope = |s| (F1 - after(&rising, s)) / (ETA * EPS) - (F2 - after(&falling, s)) / EPS;
    let (mut low, mut high) = (0.0, 10.0 * EPS);
    for _ in 0..60 {
        let middle = f64::midpoint(low, high);
        if slope(middle) > 0.0 { low = middle } else { high = middle }
    }
    low
}

fn peak_error() -> f64 {
    relative_error(after(&order_2(), peak_place()), closed(closed_place()))
}
