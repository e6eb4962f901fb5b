//! Strain of the links of a shell: what a strain gauge on the cup sees, and whether the mesh still is one.
//!
//! Engineering strain L/L0 - 1 of one link, positive when it is longer than in the round, unloaded cylinder.

use super::link_law::{Bend, VALID_STRAIN};
use super::ring::{Ring, node_at};
use super::{Direction, Shell, ShellState};
use crate::error::{Error, require};
use crate::flexspline::cup::is_bend;
use crate::real::Real;

/// An end of a link, node (i around, j along), and its strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strained<R> {
    /// i and j.
    pub node: (usize, usize),
    /// L/L0 - 1.
    pub strain: R,
}

impl<R: Real> Strained<R> {
    /// Within what the link law is made for; never when it is NaN.
    pub fn is_valid(&self) -> bool {
        self.strain.abs() <= R::lit(VALID_STRAIN)
    }
}

impl<R: Real, const N: usize, const M: usize> Shell<R, N, M> {
    /// Strain of the link from `node` (i, j) that spans `direction` (around, along), either way (1).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `node` unless i < n and j < m; `direction` unless it is one of the 16 and ends
    /// within the shell.
    pub fn strain(
        &self,
        state: &ShellState<R, N, M>,
        node: (usize, usize),
        (around, along): (i32, i32),
    ) -> Result<R, Error> {
        let (i, j) = node;
        require(i < N && j < M, "node")?;
        let forward =
            if along < 0 || (along == 0 && around < 0) { (-around, -along) } else { (around, along) };
        let direction = self
            .directions
            .iter()
            .find(|direction| (direction.around, direction.along as i32) == forward)
            .ok_or(Error::OutOfRange("direction"))?;
        let far = j.checked_add_signed(along as isize).filter(|far| *far < M);
        let far = far.ok_or(Error::OutOfRange("direction"))?;
        let other = (i as i32 + around).rem_euclid(N as i32) as usize;
        let link = difference(state.position(i, j), state.position(other, far));
        Ok(strain_at(direction.squared_strain(link)))
    }

    /// The link with the largest strain either way; one that is not finite counts as the largest.
    pub fn largest_strain(&self, state: &ShellState<R, N, M>) -> Strained<R> {
        let mut largest = (R::ZERO, (0, 0));
        self.for_each_link(state, |_, entry, j, u| {
            let beyond = u.abs() > largest.0.abs() || !u.is_finite();
            if beyond && largest.0.is_finite() {
                largest = (u, (node_at(entry, N), j));
            }
        });
        Strained { node: largest.1, strain: strain_at(largest.0) }
    }

    /// Visits every link with its direction, the entry and the slice of the node from which it goes forward around,
    /// and u = 1 - L^2/L0^2.
    pub(super) fn for_each_link(
        &self,
        state: &ShellState<R, N, M>,
        mut visit: impl FnMut(&Direction<R>, usize, usize, R),
    ) {
        for direction in &self.directions {
            for (j, far) in (0..M).zip(direction.along..M) {
                // A link that goes back around is one that goes forward from its other end.
                let (from, to) = if direction.around < 0 { (far, j) } else { (j, far) };
                let near = state.position[from].each_ref().map(Ring::entries);
                let around = direction.around.unsigned_abs() as usize;
                let far = state.position[to].each_ref().map(|axis| axis.turned(around));
                for entry in 0..N {
                    let link = core::array::from_fn(|axis| far[axis][entry] - near[axis][entry]);
                    visit(direction, entry, from, direction.squared_strain(link));
                }
            }
        }
    }

    /// The hardening of a direction's links from their free length.
    pub(super) fn bend_of(&self, direction: &Direction<R>) -> Bend<R> {
        let from_length = self.assembled.is_none() && is_bend((direction.around, direction.along));
        if from_length { self.bend } else { Bend::LINEAR }
    }
}

impl<R: Real> Direction<R> {
    /// u = 1 - L^2/L0^2 of a link vector (m).
    fn squared_strain(&self, [x, y, z]: [R; 3]) -> R {
        R::ONE - (x * x + y * y + z * z) * self.inverse_square
    }
}

fn difference<R: Real>(near: [R; 3], far: [R; 3]) -> [R; 3] {
    core::array::from_fn(|axis| far[axis] - near[axis])
}

/// L/L0 - 1 from u, without the difference of nearly equal lengths.
fn strain_at<R: Real>(u: R) -> R {
    -u / (R::ONE + (R::ONE - u).sqrt())
}
