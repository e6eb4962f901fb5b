//! Frequency response of a controller whose step changes from slot to slot: the fundamental of its answer to a sine.
//!
//! ```text
//! v(n) = V z^n,  z = e^(jw dt):   X_0 (z^8 I - Phi) = sum_k A_7..A_(k+1) B_k z^k V,   Phi = A_7 .. A_1 A_0
//! U = 1/8 sum_k z^-k (C_k X_k + D_k z^k V)
//! ```
//!
//! Exact for a periodic system; what it answers at w plus multiples of 2*pi/(8 dt) is left out, which a plant that
//! falls by 40 dB a decade takes away: the closed loop's poles, which leave nothing out, say whether that may be.
//! A frequency costs one solution of as many complex equations as there are states.
//!
//! S. Bittanti, P. Colaneri, "Periodic systems: filtering and control" (2009), chapter 2.

use nalgebra::{Complex, DMatrix};

use super::controller::{Controller, INPUTS, SLOTS, STATES};
use strainwave::compensator::schedule::CONTROL_PERIOD;

type C64 = Complex<f64>;

/// Torque and d for each input.
pub type Answer = [[C64; INPUTS]; 2];

/// A controller's frequency response, prepared.
pub struct Response {
    phi: DMatrix<C64>,
    /// Of z^k V on X_0.
    enters: Vec<DMatrix<C64>>,
    /// Of X_0 on the output of slot k.
    leaves: Vec<DMatrix<C64>>,
    /// Of z^j V on the output of slot k, j <= k.
    passes: Vec<Vec<DMatrix<f64>>>,
}

impl Response {
    /// Of a controller whose disturbance path is open (reads `v[4]`) or not.
    pub fn new(controller: &Controller, open: bool) -> Self {
        let matrices = controller.matrices(open);
        let a = |k: usize| matrices[k].view((0, 0), (STATES, STATES)).into_owned();
        let b = |k: usize| matrices[k].view((0, STATES), (STATES, INPUTS)).into_owned();
        let c = |k: usize| matrices[k].view((STATES, 0), (2, STATES)).into_owned();
        let d = |k: usize| matrices[k].view((STATES, STATES), (2, INPUTS)).into_owned();
        // Of the state at the beginning of slot k: of X_0, and of each z^j V before it.
        let mut from_start = DMatrix::identity(STATES, STATES);
        let mut from_inputs: Vec<DMatrix<f64>> = Vec::new();
        let (mut leaves, mut passes) = (Vec::new(), Vec::new());
        for k in 0..SLOTS {
            leaves.push(c(k) * &from_start);
            let mut direct: Vec<_> = from_inputs.iter().map(|from| c(k) * from).collect();
            direct.push(d(k));
            passes.push(direct);
            from_start = a(k) * from_start;
            from_inputs = from_inputs.iter().map(|from| a(k) * from).chain([b(k)]).collect();
        }
        let complex = |m: &DMatrix<f64>| m.map(|x| C64::new(x, 0.0));
        Self {
            phi: complex(&from_start),
            enters: from_inputs.iter().map(complex).collect(),
            leaves: leaves.iter().map(complex).collect(),
            passes,
        }
    }

    /// At w (rad/s).
    pub fn at(&self, omega: f64) -> Answer {
        let rotation = |k: i32| C64::from_polar(1.0, f64::from(k) * omega * CONTROL_PERIOD);
        let z: [C64; SLOTS] = std::array::from_fn(|k| rotation(k as i32));
        let round = rotation(SLOTS as i32);
        let mut left = -self.phi.clone();
        (0..STATES).for_each(|k| left[(k, k)] += round);
        let entered = self.enters.iter().zip(z);
        let right = entered.fold(DMatrix::zeros(STATES, INPUTS), |sum, (enters, z)| sum + enters * z);
        // A pole on the circle at just this frequency: no margin.
        let x = left
            .lu()
            .solve(&right)
            .unwrap_or_else(|| DMatrix::from_element(STATES, INPUTS, C64::new(f64::MAX, 0.0)));
        let mut answer = Answer::default();
        for k in 0..SLOTS {
            let back = z[k].conj() / SLOTS as f64;
            for (out, row) in answer.iter_mut().enumerate() {
                for (input, entry) in row.iter_mut().enumerate() {
                    let leaves: C64 = (0..STATES).map(|s| self.leaves[k][(out, s)] * x[(s, input)]).sum();
                    let passes: C64 = (0..=k).map(|j| z[j] * self.passes[k][j][(out, input)]).sum();
                    *entry += back * (leaves + passes);
                }
            }
        }
        answer
    }
}
