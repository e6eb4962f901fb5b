//! Smoothness penalty: prefers a weight density without steps where the log does not determine it.
//!
//! ```text
//! |D mu|^2 = sum over neighbouring cells of (rho - rho')^2      rho = mu/(2*S/L^2), on the diagonal mu/(S/L^2)
//! ```
//!
//! The sum approaches the integral of |grad rho|^2 over the triangle, whatever L: one factor serves all grids.
//! Its zero is an even density, the gear's standard shape ([`strainwave::hysteresis::Weights::uniform`]): into
//! cells that the log does not reach, what it says of the others is continued, and a log that says nothing
//! of the shape gives the standard shape of the gap that fits it.
//!
//! With a prior, of a gear its catalogue's loss, the difference from it is to be smooth, and small:
//!
//! ```text
//! |D (mu - mu0)|^2 + sum over cells of (rho - rho0)^2 * area/l^2
//! ```
//!
//! with which the table returns to the prior over the distance l = [`REACH`] sides of the triangle, and a log that says
//! nothing gives it back.
//!
//! A. Tikhonov's regularisation of the first order.

use nalgebra::DMatrix;

use super::regressors::pairs;

/// Distance over which the table returns to its prior, in sides of the triangle.
const REACH: f64 = 0.25;

/// The same with what pulls to a prior.
pub(super) fn penalty_to_prior<const L: usize>() -> DMatrix<f64> {
    let mut penalty = penalty::<L>();
    for (index, (i, j)) in pairs::<L>().enumerate() {
        // Areas are as fractions of the total weight are: halves on the diagonal; a pair has two cells but on its axis.
        let cells = if i + j + 1 == L { 1.0 } else { 2.0 };
        penalty[(index, index)] += 0.5 * cells * unit_density::<L>((i, j)) / (REACH * REACH);
    }
    penalty
}

/// Weights of a pair (i, j) with unit density, the total being 1.
pub(super) fn unit_density<const L: usize>((i, j): (usize, usize)) -> f64 {
    let fraction = if i == j { 1.0 } else { 2.0 };
    fraction / (L * L) as f64
}

/// D'D for densities, one a pair.
pub(super) fn penalty<const L: usize>() -> DMatrix<f64> {
    let places: Vec<_> = pairs::<L>().collect();
    let index = |(i, j): (usize, usize)| {
        let pair = if i + j < L { (i, j) } else { (L - 1 - j, L - 1 - i) };
        places.iter().position(|place| *place == pair)
    };
    let mut penalty = DMatrix::zeros(places.len(), places.len());
    for i in 0..L {
        for j in 0..=i {
            for neighbour in [(i + 1, j), (i, j + 1)] {
                if neighbour.0 < L && neighbour.1 <= neighbour.0 {
                    add_difference(&mut penalty, index((i, j)), index(neighbour), 1.0);
                }
            }
        }
    }
    penalty
}

/// D'D for densities of single cells, row by row, that need not be symmetric: differences along alpha and beta count by `across`
/// squared, those along the diagonal, where alpha - beta stays, by `along` squared.
pub(super) fn penalty_of_cells(levels: usize, along: f64, across: f64) -> DMatrix<f64> {
    let index = |(i, j): (usize, usize)| (j <= i && i < levels).then(|| i * (i + 1) / 2 + j);
    let size = levels * (levels + 1) / 2;
    let mut penalty = DMatrix::zeros(size, size);
    for i in 0..levels {
        for j in 0..=i {
            for (neighbour, factor) in [((i + 1, j), across), ((i, j + 1), across), ((i + 1, j + 1), along)] {
                add_difference(&mut penalty, index((i, j)), index(neighbour), factor);
            }
        }
    }
    penalty
}

/// Adds factor^2*(x_a - x_b)^2.
pub(super) fn add_difference(penalty: &mut DMatrix<f64>, a: Option<usize>, b: Option<usize>, factor: f64) {
    if let (Some(a), Some(b)) = (a, b) {
        let square = factor * factor;
        penalty[(a, a)] += square;
        penalty[(b, b)] += square;
        penalty[(a, b)] -= square;
        penalty[(b, a)] -= square;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use strainwave::hysteresis::Weights;

    #[test]
    fn the_standard_shape_is_free_and_its_density_one() {
        const L: usize = 7;
        let standard = Weights::<f64, L>::uniform(3.0).unwrap();
        for pair in pairs::<L>() {
            assert!((standard.at(pair.0, pair.1) - 3.0 * unit_density::<L>(pair)).abs() < 1e-15);
        }
        let penalty = penalty::<L>();
        assert!(penalty.column_sum().amax() < 1e-12);
        assert!(penalty.clone().symmetric_eigenvalues().iter().filter(|value| **value < 1e-9).count() == 1);
    }

    #[test]
    fn a_density_of_cells_is_free_where_it_is_even_or_changes_the_cheap_way() {
        const L: usize = 6;
        let cells = || (0..L).flat_map(|i| (0..=i).map(move |j| (i, j)));
        let cost = |along: f64, across: f64, density: fn(f64, f64) -> f64| {
            let values = cells().map(|(i, j)| density(i as f64, j as f64));
            let density = nalgebra::DVector::from_iterator(cells().count(), values);
            density.dot(&(penalty_of_cells(L, along, across) * &density))
        };
        assert!(cost(1.0, 1.0, |_, _| 3.0).abs() < 1e-12);
        assert!(cost(1.0, 0.0, |i, j| (i - j).powi(2)).abs() < 1e-9);
        // 15 neighbours to either side, a step of 1 each.
        assert!((cost(0.0, 0.1, |i, j| i + j) - 0.01 * 30.0).abs() < 1e-9);
    }

    /// A density that rises along alpha and falls along beta has |grad|^2 = 2 over the triangle of area 1/2.
    #[test]
    fn the_penalty_of_a_slope_does_not_depend_on_the_grid() {
        fn of<const L: usize>() -> f64 {
            let slope = nalgebra::DVector::from_iterator(
                pairs::<L>().count(),
                pairs::<L>().map(|(i, j)| (i as f64 - j as f64) / L as f64),
            );
            (slope.transpose() * penalty::<L>() * &slope)[0]
        }
        assert!((of::<24>() - 1.0).abs() < 0.1 && (of::<48>() - 1.0).abs() < 0.05);
    }
}
