//! Everett table: the output changes of a Preisach operator between two extrema.
//!
//! ```text
//! G(a, b) = y after the input went monotonically from b to a, minus y before it     (a fresh branch)
//!         = 2 * sum of mu over beta > b, alpha < a        for a >= b
//! G(b, a) = -G(a, b)
//! ```
//!
//! Everett's function is half of it. A fresh branch is one that starts at an extremum of the input
//! and has wiped out nothing. The table holds G at the cell edges; within a cell it is bilinear, and
//! in a cell on the diagonal proportional to a - b. That interpolant is itself the G of a Preisach
//! operator: with the weight of a cell spread evenly over it, and that of a diagonal cell along its
//! diagonal. So every law of the operator also holds between grid inputs, and the output is
//! continuous in the input.
//!
//! Inputs are in cells from the middle of the range: q = u/h, |q| <= L/2.
//!
//! D. Everett, Transactions of the Faraday Society 51 (1955).

use super::weights::Weights;
use crate::real::Real;

/// Table for `L` levels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Everett<R, const L: usize> {
    /// G(k + 1, l) at row k, column l <= k, edges counted from -U; zero above the diagonal.
    rows: [[R; L]; L],
}

/// Where an input is in the grid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Place<R> {
    /// Cell, 0..L.
    pub(crate) cell: usize,
    /// Fraction of the cell, 0..=1.
    pub(crate) fraction: R,
}

/// An output change and its derivative.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Change<R> {
    pub(crate) value: R,
    /// Over the end of the branch, per cell.
    pub(crate) slope: R,
}

impl<R: Real, const L: usize> Everett<R, L> {
    /// Sums the weights.
    pub fn build(weights: &Weights<R, L>) -> Self {
        let mut table = Self { rows: [[R::ZERO; L]; L] };
        for k in 0..L {
            // G(k+1, l) = G(k, l) + 2 * sum of mu_kj over j >= l: column by column from the diagonal.
            let mut row_sum = R::ZERO;
            for l in (0..=k).rev() {
                row_sum += weights.at(k, l);
                let value = table.corner(k, l) + row_sum + row_sum;
                if let Some(place) = table.rows.get_mut(k).and_then(|row| row.get_mut(l)) {
                    *place = value;
                }
            }
        }
        table
    }

    /// G at edges `k` and `l`, counted from -U; zero for k <= l.
    #[inline(always)]
    pub fn corner(&self, k: usize, l: usize) -> R {
        self.rows.get(k.wrapping_sub(1)).and_then(|row| row.get(l)).copied().unwrap_or(R::ZERO)
    }

    /// The cell of `q`, |q| <= L/2.
    #[inline(always)]
    pub(crate) fn place(q: R) -> Place<R> {
        let from_end = q + R::lit(L as f64 * 0.5);
        // Never negative: q >= -L/2, and the sum is exact there.
        let cell = (from_end.to_i32().cast_unsigned() as usize).min(L - 1);
        Place { cell, fraction: from_end - R::from_i32(cell as i32) }
    }

    /// G(to, from).
    #[inline(always)]
    pub(crate) fn change(&self, to: Place<R>, from: Place<R>) -> Change<R> {
        if to.cell > from.cell {
            // Rising: the upper coordinate moves.
            self.blend(to, from, |upper, lower| self.corner(upper, lower))
        } else if to.cell < from.cell {
            self.blend(to, from, |lower, upper| -self.corner(upper, lower))
        } else {
            let slope = self.corner(to.cell + 1, to.cell);
            Change { value: slope * (to.fraction - from.fraction), slope }
        }
    }

    /// Bilinear: along `from` first, so that the derivative over `to` falls out.
    #[inline(always)]
    fn blend(&self, to: Place<R>, from: Place<R>, corner: impl Fn(usize, usize) -> R) -> Change<R> {
        let along_from = |edge: usize| {
            let (near, far) = (corner(edge, from.cell), corner(edge, from.cell + 1));
            near + from.fraction * (far - near)
        };
        let (start, end) = (along_from(to.cell), along_from(to.cell + 1));
        let slope = end - start;
        Change { value: start + to.fraction * slope, slope }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const L: usize = 8;

    fn table() -> Everett<f64, L> {
        Everett::build(&Weights::uniform(3.0).unwrap())
    }

    fn change(to: f64, from: f64) -> f64 {
        table().change(Everett::<f64, L>::place(to), Everett::<f64, L>::place(from)).value
    }

    #[test]
    fn the_standard_shape_is_quadratic_at_the_grid() {
        for k in 0..=L {
            for l in 0..=k {
                let wanted = 2.0 * 3.0 * ((k - l) as f64 / L as f64).powi(2);
                assert!((table().corner(k, l) - wanted).abs() < 1e-14);
            }
        }
    }

    proptest! {
        #[test]
        fn it_is_antisymmetric_and_mirrored(a in -4.0..=4.0f64, b in -4.0..=4.0f64) {
            prop_assert!((change(a, b) + change(b, a)).abs() < 1e-13);
            prop_assert!((change(a, b) - change(-b, -a)).abs() < 1e-13);
        }

        #[test]
        fn it_is_continuous_and_rises_with_its_end(a in -4.0..=3.9f64, b in -4.0..=4.0f64) {
            // The steepest slope of the standard shape is that from end to end, 4*S/L a cell.
            let rise = change(a + 1e-6, b) - change(a, b);
            prop_assert!((-1e-14..=1e-6 * 4.0 * 3.0 / L as f64 + 1e-13).contains(&rise));
        }

        #[test]
        fn the_slope_is_the_derivative(a in -4.0..=4.0f64, b in -4.0..=4.0f64) {
            let (to, from) = (Everett::<f64, L>::place(a), Everett::<f64, L>::place(b));
            let slope = table().change(to, from).slope;
            let h = 1e-7 * if to.fraction < 0.5 { 1.0 } else { -1.0 };
            prop_assert!(((change(a + h, b) - change(a, b)) / h - slope).abs() < 1e-6);
        }
    }
}
