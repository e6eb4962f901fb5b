//! Poles of the closed loop, exact for the multi-rate schedule: eigenvalues of what a round does to plant and controller.
//!
//! ```text
//! x(m+1) = M x(m),   s = ln(mu)/(4 dt)       frequency |s|, damping ratio -Re s/|s|;  stable: |mu| < 1
//! ```
//!
//! M is read off plant and controller in the loop by unit vectors. Units: rad/s.

use nalgebra::{Complex, DMatrix};

use super::controller::{Controller, INPUTS, SLOTS};
use super::plant::Plant;
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// An eigenvalue this much outside the circle counts as on it, a growth over 400 s: where the motor stands the observer cannot
/// tell the constant part of presliding from a held torque, a double pole at 1 that rounding splits.
const ROUNDING: f64 = 1e-6;

/// Eigenvalues of what `round` does to states of these sizes.
pub fn of(units: &[f64], round: impl Fn(&mut [f64])) -> Option<Vec<Complex<f64>>> {
    let size = units.len();
    let columns: Vec<Vec<f64>> = (0..size)
        .map(|column| {
            let mut x = vec![0.0; size];
            x[column] = units[column];
            round(&mut x);
            x.iter().zip(units).map(|(x, unit)| x / unit).collect()
        })
        .collect();
    // nalgebra's QR does not converge beside the many poles at zero.
    let round = faer::Mat::from_fn(size, size, |row, column| columns[column][row]);
    let found = round.eigenvalues().ok()?;
    Some(found.iter().map(|mu| Complex::new(mu.re, mu.im)).collect())
}

/// Eigenvalues of a round.
pub fn eigenvalues(controller: &Controller, plant: &Plant) -> Option<Vec<Complex<f64>>> {
    let discrete = plant.discrete();
    let round = |x: &mut [f64]| (0..SLOTS).for_each(|slot| step(controller, plant, &discrete, slot, x));
    of(&units(controller, plant.states()), round)
}

/// One control period of both.
fn step(controller: &Controller, plant: &Plant, discrete: &DMatrix<f64>, slot: usize, x: &mut [f64]) {
    let (joint, own) = x.split_at_mut(plant.states());
    let [motor, output, torque, gauge] = plant.read(joint);
    let read: [f64; INPUTS] = [motor, output, torque, gauge, 0.0];
    let [command, _] = controller.step(slot, own, &read, false);
    plant.step(discrete, joint, command);
}

fn units(controller: &Controller, own: usize) -> Vec<f64> {
    let units = controller.units();
    // Motor's angle and speed, output's, torque: those of the controller's own states.
    let [angle, speed, output_speed, torque] = [units[0], units[9], units[15], units[1]];
    let mut all = vec![angle, speed, 1.0, output_speed, 1.0, output_speed, torque];
    all.resize(own, torque);
    all.extend(units);
    all
}

/// Every pole is within the circle.
pub fn is_stable(eigenvalues: &[Complex<f64>]) -> bool {
    eigenvalues.iter().all(|mu| mu.norm() < 1.0 + ROUNDING)
}

/// Growth rate of the fastest growing mode (1/s); below 0 where all decay.
pub fn growth(eigenvalues: &[Complex<f64>]) -> f64 {
    let largest = eigenvalues.iter().map(|mu| mu.norm()).fold(0.0, f64::max);
    largest.ln() / (SLOTS as f64 * CONTROL_PERIOD)
}

/// Frequencies (rad/s) and damping ratios of the poles below `most` (rad/s), each pair once; without those at 1, which
/// integrators have that nothing reads.
pub fn modes(eigenvalues: &[Complex<f64>], most: f64) -> Vec<(f64, f64)> {
    let round = SLOTS as f64 * CONTROL_PERIOD;
    let poles = eigenvalues.iter().filter(|mu| mu.norm() > 0.0 && mu.im >= 0.0).map(|mu| mu.ln() / round);
    let mut modes: Vec<_> = poles
        .map(|s| (s.norm(), -s.re / s.norm()))
        .filter(|(w, _)| (ROUNDING / round..most).contains(w))
        .collect();
    modes.sort_by(|a, b| a.0.total_cmp(&b.0));
    modes
}
