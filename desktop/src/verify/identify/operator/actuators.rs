//! Actuators that are no Preisach operator on a grid, and the loops that they are recorded over.
//!
//! Inputs are within +-1, outputs of the order of 1. None of them is of the class that is identified:
//!
//! | actuator | why not |
//! | --- | --- |
//! | `density` | 97 levels over another range, two humps, and a curve without hysteresis beside them |
//! | `prandtl_ishlinskii` | plays, bent and saturated: singular densities, minor loops that are not congruent |
//! | `bouc_wen` | force over displacement, saturated: minor loops neither closed nor congruent |
//! | `butterfly` | the square of an output with hysteresis, such as the strain of a ferroelectric |
//!
//! K. Kuhnen, "Modeling, identification and compensation of complex hysteretic nonlinearities: a modified Prandtl-Ishlinskii
//! approach", European Journal of Control 9 (2003); Y. Wen, "Method for random vibration of hysteretic systems", Journal of the
//! Engineering Mechanics Division 102 (1976).

use std::iter::once;

/// An actuator.
#[derive(Clone, Copy, Debug)]
pub(super) struct Actuator {
    pub name: &'static str,
    /// Its output from the state that it starts with.
    pub output: fn(&[f64]) -> Vec<f64>,
}

/// Those that dissipate.
pub(super) const DISSIPATIVE: [Actuator; 3] = [
    Actuator { name: "density", output: density },
    Actuator { name: "prandtl_ishlinskii", output: prandtl_ishlinskii },
    Actuator { name: "bouc_wen", output: bouc_wen },
];
/// One that does not.
pub(super) const BUTTERFLY: Actuator = Actuator { name: "butterfly", output: butterfly };

/// Samples from one end of the range to the other.
const STEPS: f64 = 100.0;
/// Reversal curves between the ends of the range.
const CURVES: usize = 15;
/// Turns of the nested loops that a ring-down gives.
const NESTED: usize = 16;

/// Input of the major loop, from no input on.
pub(super) fn major() -> Vec<f64> {
    path(&[0.0, 1.0, -1.0, 1.0, -1.0])
}

/// Inputs of the first-order reversal curves, each from the lower end and back.
pub(super) fn curves() -> impl Iterator<Item = Vec<f64>> {
    (1..=CURVES).map(|k| path(&[-1.0, 1.0 - 2.0 * k as f64 / (CURVES + 1) as f64, -1.0]))
}

/// Input of nested loops: a ring-down about a shifting middle, then minor loops within each other.
pub(super) fn nested() -> Vec<f64> {
    let turn = |k: usize| {
        let (left, phase) = (1.0 - (k + 1) as f64 / (NESTED + 2) as f64, k as f64);
        if k.is_multiple_of(2) { left + 0.05 * phase.sin() } else { -left + 0.05 * (3.0 * phase).cos() }
    };
    let minor = [1.0, -1.0, 0.3, -0.4, 0.1, -0.2, 0.05, 1.0, -1.0];
    path(&once(-1.0).chain((0..NESTED).map(turn)).chain(minor).collect::<Vec<_>>())
}

/// From corner to corner.
fn path(corners: &[f64]) -> Vec<f64> {
    let leg = |pair: &[f64]| {
        let (from, to) = (pair[0], pair[1]);
        let count = ((to - from).abs() * STEPS / 2.0).ceil() as usize;
        (1..=count).map(move |k| from + (to - from) * k as f64 / count as f64)
    };
    once(corners[0]).chain(corners.windows(2).flat_map(leg)).collect()
}

/// Relays of their own, each for itself.
fn density(input: &[f64]) -> Vec<f64> {
    const LEVELS: usize = 97;
    let place = |k: usize| -1.13 + 2.2 * (k as f64 + 0.5) / LEVELS as f64;
    let hump = |x: f64, middle: f64, width: f64| ((x - middle) / width).powi(2);
    let weight = |alpha: f64, beta: f64| {
        let first = (-hump(alpha, 0.35, 0.3) - hump(beta, -0.1, 0.25)).exp();
        first + 0.5 * (-hump(alpha, 0.1, 0.5) - hump(beta, -0.5, 0.2)).exp()
    };
    let cells = (0..LEVELS).flat_map(|i| (0..=i).map(move |j| (place(i), place(j))));
    // Threshold up, threshold down, weight, state.
    let mut relays: Vec<_> = cells
        .map(|(alpha, beta)| (alpha, beta, weight(alpha, beta), if alpha + beta < 0.0 { 1.0 } else { -1.0 }))
        .collect();
    let total: f64 = relays.iter().map(|(_, _, weight, _)| weight).sum();
    let step = |u: &f64| {
        let mut sum = 0.0;
        for (alpha, beta, weight, state) in &mut relays {
            if *u >= *alpha {
                *state = 1.0;
            } else if *u <= *beta {
                *state = -1.0;
            }
            sum += *weight * *state;
        }
        sum / total + 0.15 * (2.0 * u).atan()
    };
    input.iter().map(step).collect()
}

/// Plays, whose sum is bent and saturates.
fn prandtl_ishlinskii(input: &[f64]) -> Vec<f64> {
    const HALF_WIDTHS: [f64; 7] = [0.0, 0.03, 0.07, 0.13, 0.21, 0.34, 0.5];
    const WEIGHTS: [f64; 7] = [0.3, 0.25, 0.2, 0.18, 0.15, 0.12, 0.1];
    const SATURATION: f64 = 0.55;
    let mut plays = [0.0_f64; 7];
    let step = |u: &f64| {
        for (play, half_width) in plays.iter_mut().zip(HALF_WIDTHS) {
            *play = play.clamp(u - half_width, u + half_width);
        }
        let sum: f64 = plays.iter().zip(WEIGHTS).map(|(play, weight)| play * weight).sum();
        let beyond = (sum.abs() - SATURATION).max(0.0);
        let saturated = sum.signum() * (sum.abs().min(SATURATION) + 0.25 * (beyond / 0.25).tanh());
        saturated + 0.06 * sum * sum
    };
    input.iter().map(step).collect()
}

/// A force over a displacement: a spring and a hysteretic part z, in small explicit steps.
fn bouc_wen(input: &[f64]) -> Vec<f64> {
    const LONGEST: f64 = 1e-3;
    let (mut z, mut before) = (0.0_f64, 0.0);
    let step = |u: &f64| {
        let count = ((u - before).abs() / LONGEST).ceil().max(1.0);
        let du = (u - before) / count;
        for _ in 0..count as usize {
            z += 6.0 * du * (1.0 - z.abs().powf(1.4) * (0.35 + 0.75 * (du * z).signum()));
        }
        before = *u;
        (1.2 * (0.45 * u + 0.35 * z)).tanh() + 0.05 * u * u
    };
    input.iter().map(step).collect()
}

/// The square of [`density`], off its middle.
fn butterfly(input: &[f64]) -> Vec<f64> {
    let polarisation = density(input);
    input.iter().zip(polarisation).map(|(u, p)| (p + 0.1).powi(2) + 0.1 * u).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Integral of y du over the last loop of the major input.
    fn area(actuator: Actuator) -> f64 {
        let input = major();
        let output = (actuator.output)(&input);
        let rows: Vec<_> = input.iter().zip(&output).skip(input.len() - 201).collect();
        rows.windows(2).map(|pair| 0.5 * (pair[0].1 + pair[1].1) * (pair[1].0 - pair[0].0)).sum()
    }

    #[test]
    fn the_first_lag_the_force_leads_and_the_butterfly_does_both() {
        let [density, plays, force] = DISSIPATIVE.map(area);
        assert!(density < -0.1 && plays < -0.05 && force > 0.1, "{density} {plays} {force}");
        let input = major();
        let output = (BUTTERFLY.output)(&input);
        let least = output.iter().copied().fold(f64::INFINITY, f64::min);
        let ends = [output[150], output[250]];
        assert!(ends.iter().all(|end| *end > least + 0.3), "{ends:?} {least}");
    }

    #[test]
    fn every_input_stays_in_its_range_and_but_for_the_major_one_starts_at_its_end() {
        for input in curves().chain([nested()]) {
            assert!(input[0] == -1.0 && input.iter().all(|u| u.abs() <= 1.0));
        }
        assert_eq!(curves().count(), CURVES);
        assert!(major()[0] == 0.0);
    }
}
