//! Preisach operator as a sum of relays, eq. (9): the reference realisation.
//!
//! ```text
//! y = sum mu_ij * gamma_ij          gamma_ij = 1 after u > alpha_i,  -1 after u < beta_j
//! ```
//!
//! Energy: read as the torque -y over the input u, relay ij stores -mu*gamma*(u - (alpha + beta)/2),
//! because that changes by -mu*gamma du while gamma is constant. A switch from -1 to 1 at u = alpha,
//! or back at u = beta, makes it fall by mu*(alpha - beta): that is dissipated. So on any path
//!
//! ```text
//! -integral y du = change of stored + dissipated,     dissipated never falls
//! ```
//!
//! Demagnetised start: relays with alpha + beta < 0 are up, those with alpha + beta > 0 down, and
//! the line alpha + beta = 0 cuts its cells into halves of either state: gamma = 0 there until the
//! first switch, which dissipates half. The output is then zero.
//!
//! Cost: L*(L + 1)/2 relays a step. F. Preisach, Zeitschrift fuer Physik 94 (1935);
//! I. Mayergoyz, "Mathematical models of hysteresis and their applications", 2003, chapter 1.

use super::weights::Weights;
use crate::error::{Error, require};
use crate::real::Real;

/// Built operator.
///
/// Over a closed loop of the input the energy that the relays lose is the area of the loop:
///
/// ```
/// use strainwave::hysteresis::{Relays, RelaysState, Weights};
///
/// let relays = Relays::build(1.0_f64, &Weights::<f64, 16>::uniform(2.0)?)?;
/// let mut state = RelaysState::default();
/// // The loop between -1 and 1, after the first rise from the demagnetised state.
/// let path = |steps: u32| (1..=steps).map(move |k| (f64::from(k) / f64::from(steps) * std::f64::consts::TAU).cos());
/// relays.step(&mut state, 1.0);
/// let (mut input, mut output, mut area, before) = (1.0, state.output(), 0.0, state.dissipated());
/// for next in path(20_000) {
///     area -= 0.5 * (output + relays.step(&mut state, next)) * (next - input);
///     (input, output) = (next, state.output());
/// }
/// assert!((area - (state.dissipated() - before)).abs() < 1e-3 * area);
/// # Ok::<(), strainwave::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relays<R, const L: usize> {
    weights: Weights<R, L>,
    half_range: R,
    cell: R,
}

/// State of every relay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelaysState<R, const L: usize> {
    /// gamma_ij: -1, 1, or 0 for a cell that the demagnetisation cut into halves.
    relays: [[i8; L]; L],
    output: R,
    dissipated: R,
}

impl<R: Real, const L: usize> Default for RelaysState<R, L> {
    /// Demagnetised, input 0.
    fn default() -> Self {
        let mut relays = [[0; L]; L];
        for (i, row) in relays.iter_mut().enumerate() {
            for (j, relay) in row.iter_mut().enumerate() {
                *relay = match (i + j + 1).cmp(&L) {
                    core::cmp::Ordering::Less => 1,
                    core::cmp::Ordering::Equal => 0,
                    core::cmp::Ordering::Greater => -1,
                };
            }
        }
        Self { relays, output: R::ZERO, dissipated: R::ZERO }
    }
}

impl<R: Real, const L: usize> RelaysState<R, L> {
    /// y after the last step.
    pub fn output(&self) -> R {
        self.output
    }

    /// Energy lost in switches since the start [output unit * input unit].
    pub fn dissipated(&self) -> R {
        self.dissipated
    }
}

impl<R: Real, const L: usize> Relays<R, L> {
    /// Relays over inputs of +-`half_range` U, 1e-9..=1e6.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `half_range`.
    pub fn build(half_range: R, weights: &Weights<R, L>) -> Result<Self, Error> {
        require((R::lit(1e-9)..=R::lit(1e6)).contains(&half_range), "half_range")?;
        let cell = (half_range + half_range) / R::from_i32(L as i32);
        Ok(Self { weights: *weights, half_range, cell })
    }

    /// The middle of cell `i`: alpha_i, and beta_i too.
    pub fn threshold(&self, i: usize) -> R {
        // (2i + 1 - L)/2 is exact, so that the thresholds are exactly symmetric.
        R::from_i32(2 * i as i32 + 1 - L as i32) * R::lit(0.5) * self.cell
    }

    /// Cell edge `k`, a grid input; 0..=L.
    pub fn edge(&self, k: usize) -> R {
        if k == L {
            return self.half_range;
        }
        R::from_i32(2 * k as i32 - L as i32) * R::lit(0.5) * self.cell
    }

    /// y at the input; a NaN leaves everything as it is, as no relay switches on one.
    pub fn step(&self, state: &mut RelaysState<R, L>, input: R) -> R {
        let mut sum = R::ZERO;
        for (i, row) in state.relays.iter_mut().enumerate() {
            let alpha = self.threshold(i);
            for (j, relay) in row.iter_mut().enumerate().take(i + 1) {
                let (beta, weight) = (self.threshold(j), self.weights.at(i, j));
                let before = *relay;
                if input > alpha {
                    *relay = 1;
                } else if input < beta {
                    *relay = -1;
                }
                let switched = R::from_i32(i32::from((*relay - before).abs()));
                state.dissipated += switched * R::lit(0.5) * weight * (alpha - beta);
                sum += weight * R::from_i32(i32::from(*relay));
            }
        }
        state.output = sum;
        sum
    }

    /// Energy in the relays at the input [output unit * input unit], up to a constant.
    pub fn stored(&self, state: &RelaysState<R, L>, input: R) -> R {
        let mut sum = R::ZERO;
        for (i, row) in state.relays.iter().enumerate() {
            for (j, &relay) in row.iter().enumerate().take(i + 1) {
                let middle = (self.threshold(i) + self.threshold(j)) * R::lit(0.5);
                sum -= self.weights.at(i, j) * R::from_i32(i32::from(relay)) * (input - middle);
            }
        }
        sum
    }
}
