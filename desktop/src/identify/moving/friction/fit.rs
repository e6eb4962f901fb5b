//! Bounded least squares of the block's unknowns on the motor's torque, robust against single rows.
//!
//! ```text
//! min  sum over rows of w_i*(tau - tau_motor)^2/(s^2*T) + sum of z_k^2         z within its range
//! w_i = min(1, HUBER*s/|tau - tau_motor|)
//! ```
//!
//! s is the residual's standard deviation by its median; T how many rows are alike, from the residual's correlation up to
//! [`LAGS`] rows, so that what no unknown explains is not taken for many witnesses. Both and w are those of the solution
//! before, from a deviation that friction is known to before the log. The solver is Levenberg-Marquardt with Coleman and Li's
//! scaling at the bounds ([`basin::BoundedLevenbergMarquardt`]).
//!
//! P. Huber, "Robust estimation of a location parameter", Annals of Mathematical Statistics 35 (1964); M. Branch, T. Coleman,
//! Y. Li, SIAM Journal on Scientific Computing 21 (1999).

use basin::{
    BoundedLevenbergMarquardt, BoxBounds, ConstraintDescription, ConstraintSet, Constraints, CostFunction,
    DenseMatrix, Executor, Jacobian, PointState, Residual,
};
use nalgebra::DMatrix;

use super::rollout::Rollout;
use super::unknowns::Unknown;
use crate::identify::Error;

/// Residuals beyond so many standard deviations weigh less.
const HUBER: f64 = 1.345;
/// Residuals beyond so many standard deviations correlate as those do.
const OUTLIER: f64 = 3.0;
/// Rows over which residuals may be alike: 0.2 s.
const LAGS: usize = 50;
/// Robust solutions, each with the weights of the one before.
const ROUNDS: usize = 2;
/// Most iterations of the solver.
const ITERATIONS: u64 = 40;
/// Step of the differences.
const DIFFERENCE: f64 = 1e-4;
/// Largest gradient of a solution, scaled as the bounds are.
const GRADIENT: f64 = 1e-3;
/// First damping over the largest square of a column: those of offset and presliding are many powers of ten apart.
const DAMPING: f64 = 1e-9;
/// Least change of the cost from which on the solver goes on.
const COST: f64 = 1e-7;
/// Median of a normal distribution's absolute value over its standard deviation.
const MEDIAN: f64 = 0.6745;

/// Noise of the rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Noise {
    /// s (N m)
    pub deviation: f64,
    /// T
    pub alike: f64,
}

impl Noise {
    /// Of what is left of the rows (N m).
    fn of(left: &[f64]) -> Self {
        let mut sizes: Vec<_> = left.iter().map(|left| left.abs()).collect();
        sizes.sort_unstable_by(f64::total_cmp);
        let deviation = (sizes[sizes.len() / 2] / MEDIAN).max(f64::MIN_POSITIVE);
        let limit = OUTLIER * deviation;
        let usual: Vec<_> = left.iter().map(|left| left.clamp(-limit, limit)).collect();
        let correlation = |lag: usize| usual.iter().zip(&usual[lag..]).map(|(a, b)| a * b).sum::<f64>();
        let lags = LAGS.min(left.len() / 4);
        let own = correlation(0);
        let weighted = |lag: usize| (1.0 - lag as f64 / (lags + 1) as f64) * correlation(lag) / own;
        let alike = 1.0 + 2.0 * (1..=lags).map(weighted).sum::<f64>();
        Self { deviation, alike: if alike.is_finite() { alike.max(1.0) } else { 1.0 } }
    }

    /// Of a row that counts as independent (N m).
    pub fn of_row(&self) -> f64 {
        self.deviation * self.alike.sqrt()
    }

    /// Huber's loss of a residual (N m).
    pub fn loss(&self, left: f64) -> f64 {
        let size = left.abs() / self.deviation;
        if size <= HUBER { 0.5 * size * size } else { HUBER * (size - 0.5 * HUBER) }
    }

    /// sqrt(w)/(s*sqrt(T)) of every row (1/(N m)).
    fn weights(&self, left: &[f64]) -> Vec<f64> {
        let robust = |left: &f64| (HUBER * self.deviation / left.abs()).min(1.0).sqrt();
        left.iter().map(|left| robust(left) / self.of_row()).collect()
    }
}

/// Solution of a fit.
#[derive(Clone, Debug)]
pub(super) struct Solution {
    /// Of the unknowns.
    pub z: Vec<f64>,
    /// Measured less modelled torque of every row (N m).
    pub left: Vec<f64>,
    /// Of the rows.
    pub noise: Noise,
    /// Of every row (1/(N m)).
    weights: Vec<f64>,
    /// Half of the sum of squares.
    pub cost: f64,
}

/// A fit of some unknowns of a joint.
#[derive(Clone, Copy)]
pub(super) struct Fit<'a> {
    /// The joint and its motion.
    pub rollout: Rollout<'a>,
    /// Measured torque of every row (N m).
    pub torque: &'a [f64],
    /// What is found.
    pub unknowns: &'a [Unknown],
}

impl<'a> Fit<'a> {
    /// The solution from a start, with rows of the same noise (N m), none of them weighing less.
    pub fn plain(&self, start: &[f64], noise: f64) -> Result<Solution, Error> {
        self.solved(start, vec![1.0 / noise; self.torque.len()])
    }

    /// The robust solution from one before.
    pub fn robust(&self, before: Solution) -> Result<Solution, Error> {
        let mut solution = before;
        for _ in 0..ROUNDS {
            let weights = solution.noise.weights(&solution.left);
            solution = self.solved(&solution.z, weights)?;
        }
        Ok(solution)
    }

    /// What is left (N m) of each row of `parts` by the solution without its part. One step of Gauss and Newton's from the solution of
    /// all rows is not enough: where a part alone tells two unknowns apart, it goes far beyond what is linear.
    pub fn left_out(&self, solution: &Solution, parts: &[usize]) -> Result<Vec<f64>, Error> {
        let mut left_out = solution.left.clone();
        for part in 0..=parts.iter().copied().max().unwrap_or_default() {
            let others = solution.weights.iter().zip(parts);
            let others = others.map(|(weight, of)| if *of == part { 0.0 } else { *weight }).collect();
            let found = self.solved(&solution.z, others)?;
            let rows = (0..left_out.len()).filter(|row| parts[*row] == part);
            rows.for_each(|row| left_out[row] = found.left[row]);
        }
        Ok(left_out)
    }

    /// The same unknowns with others that start at 0, or at `first` the last of them.
    pub fn widened(&self, solution: &Solution, first: f64) -> Vec<f64> {
        let mut z = solution.z.clone();
        z.resize(self.unknowns.len(), first);
        z
    }

    /// What follows from the weights of a solution for other unknowns, from a start.
    pub fn again(&self, start: &[f64], before: &Solution) -> Result<Solution, Error> {
        self.solved(start, before.weights.clone())
    }

    /// Covariance of the unknowns about a point, the prior's with it. Slow unknowns take from the residual what is alike in
    /// it, each a row's worth at every lag: T is larger by that.
    pub fn covariance(&self, z: &[f64], solution: &Solution) -> Result<DMatrix<f64>, Error> {
        let problem = self.problem(&solution.weights);
        let (count, rows) = (z.len(), self.torque.len() + z.len());
        let slopes = problem.slopes(z)?;
        let Noise { alike, .. } = solution.noise;
        let taken = ((LAGS + 1) * count) as f64 / self.torque.len() as f64;
        let share = (alike / (alike + taken)).sqrt();
        let jacobian = DMatrix::from_fn(rows, count, |row, column| {
            slopes[column][row] * if row < self.torque.len() { share } else { 1.0 }
        });
        (jacobian.transpose() * &jacobian)
            .try_inverse()
            .ok_or_else(|| Error::Solver("the information about friction is singular".into()))
    }

    fn problem<'b>(&'b self, weights: &'b [f64]) -> Problem<'b> {
        let range = |end: usize| self.unknowns.iter().map(|unknown| unknown.range()[end]).collect();
        Problem { fit: *self, weights, lower: range(0), upper: range(1) }
    }

    fn solved(&self, start: &[f64], weights: Vec<f64>) -> Result<Solution, Error> {
        let start: Vec<_> = start.iter().zip(self.unknowns).map(|(z, unknown)| unknown.inside(*z)).collect();
        let solver = BoundedLevenbergMarquardt::new()
            .with_tau(DAMPING)
            .with_absolute_scaled_gradient_tolerance(GRADIENT)
            .with_relative_cost_change_tolerance(COST);
        let found = Executor::new(self.problem(&weights), solver, PointState::new(start))
            .max_iter(ITERATIONS)
            .run()
            .map_err(|error| Error::Solver(error.to_string()))?;
        let (z, cost) = (found.param().to_vec(), found.cost());
        if !cost.is_finite() {
            return Err(Error::Solver("the motor's torque cannot be modelled".into()));
        }
        let modelled = self.rollout.torques(self.unknowns, &z)?;
        let left: Vec<_> =
            self.torque.iter().zip(modelled).map(|(measured, modelled)| measured - modelled).collect();
        Ok(Solution { noise: Noise::of(&left), z, left, weights, cost })
    }
}

struct Problem<'a> {
    fit: Fit<'a>,
    weights: &'a [f64],
    lower: Vec<f64>,
    upper: Vec<f64>,
}

impl Problem<'_> {
    fn rows(&self, z: &[f64]) -> Result<Vec<f64>, strainwave::Error> {
        let modelled = self.fit.rollout.torques(self.fit.unknowns, z)?;
        let rows = modelled.iter().zip(self.fit.torque).zip(self.weights);
        Ok(rows
            .map(|((modelled, measured), weight)| weight * (modelled - measured))
            .chain(z.iter().copied())
            .collect())
    }

    /// Change of the rows with each unknown.
    fn slopes(&self, z: &[f64]) -> Result<Vec<Vec<f64>>, strainwave::Error> {
        let here = self.rows(z)?;
        let slope = |k: usize| {
            let mut there = z.to_vec();
            there[k] += if z[k] + DIFFERENCE <= self.upper[k] { DIFFERENCE } else { -DIFFERENCE };
            let step = there[k] - z[k];
            let rows = self.rows(&there)?;
            Ok(rows.iter().zip(&here).map(|(there, here)| (there - here) / step).collect())
        };
        (0..z.len()).map(slope).collect()
    }
}

impl Constraints for Problem<'_> {
    type Set = ConstraintSet<BoxBounds<Vec<f64>>>;

    fn constraints(&self) -> <Self::Set as ConstraintDescription>::Borrowed<'_> {
        ConstraintSet::new().with_bounds(BoxBounds::new(Some(&self.lower), Some(&self.upper)))
    }
}

impl CostFunction for Problem<'_> {
    type Param = Vec<f64>;
    type Output = f64;
    type Error = strainwave::Error;

    fn cost(&self, z: &Vec<f64>) -> Result<f64, strainwave::Error> {
        Ok(0.5 * self.rows(z)?.iter().map(|row| row * row).sum::<f64>())
    }
}

impl Residual for Problem<'_> {
    type Param = Vec<f64>;
    type Output = Vec<f64>;
    type Error = strainwave::Error;

    fn residual(&self, z: &Vec<f64>) -> Result<Vec<f64>, strainwave::Error> {
        self.rows(z)
    }
}

impl Jacobian for Problem<'_> {
    type Jacobian = DenseMatrix;

    fn jacobian(&self, z: &Vec<f64>) -> Result<DenseMatrix, strainwave::Error> {
        let slopes = self.slopes(z)?;
        Ok(DenseMatrix::from_fn(slopes[0].len(), z.len(), |row, column| slopes[column][row]))
    }
}

#[cfg(test)]
mod tests {
    use super::super::strokes::Strokes;
    use super::super::unknowns::Parameter;
    use super::*;

    /// From next to an end of its range.
    #[test]
    fn a_search_leaves_the_end_of_a_range_that_another_model_ended_at() {
        let strokes = Strokes::new();
        let unknowns = [Parameter::Coulomb, Parameter::Viscous, Parameter::Stribeck].map(Unknown::Of);
        let fit = strokes.fit(&unknowns);
        let [inside, end] =
            [0.0, 1e-12 - 1.0].map(|viscous| fit.plain(&[0.0, viscous, 0.0], Strokes::NOISE).unwrap());
        let apart = inside.z.iter().zip(&end.z).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 0.05, "{:?} {:?}", inside.z, end.z);
    }

    #[test]
    fn what_is_held_out_is_predicted_the_same_from_wherever_the_solution_starts() {
        let strokes = Strokes::new();
        let unknowns = [Parameter::Coulomb, Parameter::Static, Parameter::Stribeck, Parameter::Presliding]
            .map(Unknown::Of);
        let fit = strokes.fit(&unknowns);
        let solution = fit.plain(&[0.0; 4], Strokes::NOISE).unwrap();
        let parts: Vec<_> = (0..fit.torque.len()).map(|row| row / 50 % 5).collect();
        let elsewhere = Solution { z: vec![0.1, 0.1, 0.2, -0.1], ..solution.clone() };
        let [one, other] = [solution, elsewhere].map(|start| fit.left_out(&start, &parts).unwrap());
        let apart = one.iter().zip(&other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 0.02 * Strokes::NOISE, "{apart:e}");
    }
}
