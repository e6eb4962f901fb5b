//! The largest natural frequency of a mesh, as a bound that is never too low.
//!
//! The round mesh is block-circulant: each harmonic p = 0..n/2 around the ring has a stiffness of its own, 3 unknowns a
//! slice (`condensation.rs`). With the masses divided in, the harmonic's A_p is symmetric and positive, so
//!
//! ```text
//! lambda_max = max over p,j of lambda_j(A_p) <= max over p of (trace A_p^q)^(1/q),   q = 2^DOUBLINGS
//! ```
//!
//! which is too high by at most the factor (3*m)^(1/q): 1 % for m = 4. Powers by squaring, the trace divided out each time.
//!
//! The assembled mesh is not round: its links are strained by up to e = w0/(2*R), which adds at most 2*16*k*e
//! to an eigenvalue that is at least 16*k/3 (a third of the trace at a node): the factor [`assembled`].

use crate::flexspline::condensation::stiffness;
use crate::flexspline::cup::Cup;
use crate::real::Real;

/// q = 2^8.
const DOUBLINGS: usize = 8;

/// A symmetric matrix over slices and components.
pub(super) type Matrix<R, const M: usize> = [[[[R; 3]; M]; 3]; M];

/// Bound of omega^2 in units of k/m, with each slice's inverse mass in units of 1/m: 0 for one that is held.
pub(super) fn largest<R: Real, const M: usize>(cup: &Cup<R>, n: usize, inverse_mass: [R; M]) -> R {
    let root = inverse_mass.map(R::sqrt);
    (0..=n / 2).map(|order| power_trace(&harmonic(cup, n, order, root))).fold(R::ZERO, R::max)
}

/// A_p of a harmonic, in units of k/m, with the square root of each slice's inverse mass.
pub(super) fn harmonic<R: Real, const M: usize>(
    cup: &Cup<R>,
    n: usize,
    order: usize,
    root: [R; M],
) -> Matrix<R, M> {
    scaled(stiffness(cup, n, order as i32), &root)
}

/// omega^2 of the rim turning as one, half a slice's mass against its links, all else held (k/m).
pub(super) fn of_rim<R: Real, const M: usize>(cup: &Cup<R>, n: usize) -> R {
    R::lit(2.0) * stiffness::<R, M>(cup, n, 0)[0][1][0][1]
}

/// Bound of the factor by which the pre-strain of the assembled mesh raises an eigenvalue.
pub(super) fn assembled<R: Real>(cup: &Cup<R>) -> R {
    R::ONE + R::lit(3.0) * cup.ellipse / cup.radius
}

/// Rows and columns times a factor for each slice.
fn scaled<R: Real, const M: usize>(mut matrix: Matrix<R, M>, factor: &[R; M]) -> Matrix<R, M> {
    for (rows, row_factor) in matrix.iter_mut().zip(factor) {
        for (blocks, factor) in rows.iter_mut().flat_map(|row| row.iter_mut().zip(factor)) {
            for entry in blocks {
                *entry *= *row_factor * *factor;
            }
        }
    }
    matrix
}

/// (trace A^q)^(1/q); 0 when nothing can move.
fn power_trace<R: Real, const M: usize>(matrix: &Matrix<R, M>) -> R {
    let (mut power, mut bound) = (*matrix, R::ONE);
    for doubling in 0..=DOUBLINGS {
        let trace = trace(&power);
        if trace <= R::ZERO {
            return R::ZERO;
        }
        bound *= (0..doubling).fold(trace, |root, _| root.sqrt());
        power = squared_over(&power, R::ONE / trace);
    }
    bound
}

fn trace<R: Real, const M: usize>(matrix: &Matrix<R, M>) -> R {
    let diagonal = (0..M).flat_map(|j| (0..3).map(move |c| (j, c)));
    diagonal.fold(R::ZERO, |sum, (j, c)| sum + matrix[j][c][j][c])
}

/// (A*factor)^2.
fn squared_over<R: Real, const M: usize>(matrix: &Matrix<R, M>, factor: R) -> Matrix<R, M> {
    let square = factor * factor;
    let mut product = [[[[R::ZERO; 3]; M]; 3]; M];
    for (row, result) in matrix.iter().flatten().zip(product.iter_mut().flatten()) {
        for (weight, other) in row.iter().flatten().zip(matrix.iter().flatten()) {
            for (sum, entry) in result.iter_mut().flatten().zip(other.iter().flatten()) {
                *sum += square * *weight * *entry;
            }
        }
    }
    product
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flexspline::calibration::tests::SIZE_25;
    use crate::flexspline::shell::{Bend, Shell, ShellParams, ShellState};

    /// Frequency of the mode that a free shell's stiffest motion converges to, by power iteration on the
    /// shell itself: displaced, released, the new velocities taken as the next displacement (omega^2 in k/m).
    fn by_iteration<const N: usize, const M: usize>() -> f64 {
        let params =
            ShellParams { cup: SIZE_25.cup, link_stiffness: 1e6, link_damping: 0.0, bend: Bend::LINEAR };
        let dt = 1e-9;
        let shell = Shell::<f64, N, M>::build(&params, dt).unwrap();
        let mut direction = [[[0.0; 3]; M]; N];
        for (k, node) in direction.iter_mut().flatten().enumerate() {
            *node = [(k as f64 * 1.7).sin(), (k as f64 * 2.3).cos(), (k as f64 * 0.9).sin()];
        }
        let mut largest = 0.0;
        for _ in 0..400 {
            let mut state = shell.round();
            set(&mut state, &direction, 1e-3);
            // One step moves the nodes along the direction, the next one's change of velocity is the force.
            shell.step(&mut state);
            let before = state;
            shell.step(&mut state);
            let mut norm = 0.0;
            for (i, column) in direction.iter_mut().enumerate() {
                for (j, node) in column.iter_mut().enumerate() {
                    let (now, then) = (state.velocity(i, j), before.velocity(i, j));
                    *node = core::array::from_fn(|axis| (then[axis] - now[axis]) / (dt * dt * 1e-3));
                    norm += node.iter().map(|a| a * a).sum::<f64>();
                }
            }
            largest = norm.sqrt();
            direction.iter_mut().flatten().flatten().for_each(|a| *a /= largest);
        }
        largest * params.node_mass(N, M) / params.link_stiffness
    }

    fn set<const N: usize, const M: usize>(
        state: &mut ShellState<f64, N, M>,
        direction: &[[[f64; 3]; M]; N],
        speed: f64,
    ) {
        for (i, column) in direction.iter().enumerate() {
            for (j, node) in column.iter().enumerate() {
                state.set_velocity(i, j, node.map(|a| a * speed));
            }
        }
    }

    fn check<const N: usize, const M: usize>() {
        let mut inverse_mass = [1.0; M];
        (inverse_mass[0], inverse_mass[M - 1]) = (2.0, 2.0);
        let bound = largest(&SIZE_25.cup, N, inverse_mass);
        let found = by_iteration::<N, M>();
        let over = bound / found;
        assert!((0.9999..1.05).contains(&over), "{N} x {M}: bound {bound}, iterated {found}");
    }

    #[test]
    fn the_bound_is_just_above_what_power_iteration_finds() {
        check::<4, 3>();
        check::<8, 2>();
        check::<8, 3>();
        check::<9, 4>();
        check::<36, 4>();
    }

    #[test]
    fn a_shell_that_is_held_everywhere_has_no_frequency() {
        assert_eq!(largest(&SIZE_25.cup, 8, [0.0; 3]), 0.0);
    }
}
