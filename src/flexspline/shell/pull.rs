//! Forces of all links on all nodes: the inner loop of the mesh.
//!
//! Row by row: the links of one direction from all nodes of one slice, in one loop that every compiler converts to
//! vector code. The forces on far ends have arrays of their own, one for each rotation of the ring, so that no sum waits for
//! one that was just written at another place, and are turned back once, at the end.

use super::assembled::{Assembled, Wave};
use super::link_law::shortening;
use super::ring::Ring;
use super::{Direction, Shell, ShellState, Slice, sum};
use crate::real::Real;

/// Hardening of a row's links: none, from the free length, from the assembled shape.
const LINEAR: u8 = 0;
const FROM_LENGTH: u8 = 1;
const FROM_ASSEMBLED: u8 = 2;

/// Forces of the links of a shell in one step, gathered row by row.
struct Sums<'a, R, const N: usize, const M: usize> {
    /// Forces on near nodes, and on far ones in the same column.
    near: &'a mut [Slice<R, N>; M],
    /// Forces against far nodes one and two nodes on.
    far: &'a mut [[Slice<R, N>; M]; 2],
    loss: &'a mut Ring<R, N>,
    /// Torque of the hardening on the rim, against the wave generator (N m).
    ellipse: &'a mut Ring<R, N>,
}

/// The links of a row: their direction, and with hardening from the assembled shape their strain there and the cosine and
/// sine of 2b of their first nodes.
struct Row<'a, R> {
    direction: &'a Direction<R>,
    wave: &'a Wave<R>,
    twice: [&'a [R]; 2],
}

impl<R: Real, const N: usize, const M: usize> Shell<R, N, M> {
    /// Adds the links' forces to `force` (N); answers with the power lost in them (W).
    #[inline(always)]
    pub(in crate::flexspline) fn pull(&self, state: &ShellState<R, N, M>, force: &mut [Slice<R, N>; M]) -> R {
        if self.bend.hardening > R::ZERO && self.assembled.is_none() {
            self.pull_with::<FROM_LENGTH>(state, &[Ring::ZERO; 2], force).0
        } else {
            self.pull_with::<LINEAR>(state, &[Ring::ZERO; 2], force).0
        }
    }

    /// The same with bend links that harden from the assembled shape, by the cosine and sine of twice each node's angle from the
    /// major axis; the second value is the torque that this puts on the rim and takes from the wave generator (N m).
    #[inline(always)]
    pub(in crate::flexspline) fn pull_assembled(
        &self,
        state: &ShellState<R, N, M>,
        twice: &[Ring<R, N>; 2],
        force: &mut [Slice<R, N>; M],
    ) -> (R, R) {
        self.pull_with::<FROM_ASSEMBLED>(state, twice, force)
    }

    #[inline(always)]
    fn pull_with<const LAW: u8>(
        &self,
        state: &ShellState<R, N, M>,
        twice: &[Ring<R, N>; 2],
        force: &mut [Slice<R, N>; M],
    ) -> (R, R) {
        let mut far = [[[Ring::ZERO; 3]; M]; 2];
        let (mut loss, mut ellipse) = (Ring::ZERO, Ring::ZERO);
        let mut sums = Sums { near: force, far: &mut far, loss: &mut loss, ellipse: &mut ellipse };
        let [ring, axial, shear, shear_back, bend, bend_axial, bend_shear, bend_shear_back] =
            &self.directions;
        let (round, none) = (Assembled::ROUND, Wave::ZERO);
        let assembled = self.assembled.as_ref().unwrap_or(&round);
        let twice = twice.each_ref().map(|ring| ring.turned(0));
        let straight = |direction| Row { direction, wave: &none, twice };
        let bent = |direction, index, slice| Row { direction, wave: assembled.wave(index, slice), twice };
        // A link that goes back around is one that goes forward from its other end.
        for j in 0..M {
            self.row::<1, LINEAR>(&straight(ring), state, [j, j], &mut sums);
            self.row::<2, LAW>(&bent(bend, 0, j), state, [j, j], &mut sums);
            if j + 1 < M {
                self.straight_row::<LINEAR>(&straight(axial), state, [j, j + 1], &mut sums);
                self.row::<1, LINEAR>(&straight(shear), state, [j, j + 1], &mut sums);
                self.row::<1, LINEAR>(&straight(shear_back), state, [j + 1, j], &mut sums);
            }
            if j + 2 < M {
                self.straight_row::<LAW>(&bent(bend_axial, 1, j), state, [j, j + 2], &mut sums);
                self.row::<2, LAW>(&bent(bend_shear, 2, j), state, [j, j + 2], &mut sums);
                self.row::<2, LAW>(&bent(bend_shear_back, 3, j + 2), state, [j + 2, j], &mut sums);
            }
        }
        for (around, far) in far.iter_mut().enumerate() {
            for (near, far) in force.as_flattened_mut().iter_mut().zip(far.as_flattened_mut()) {
                far.fold(around + 1);
                for (near, far) in near.entries_mut().iter_mut().zip(far.entries()) {
                    *near -= *far;
                }
            }
        }
        (sum(loss.entries()), if LAW == FROM_ASSEMBLED { sum(ellipse.entries()) } else { R::ZERO })
    }

    /// Pull of the links from every node of slice `near` to the node 1 or 2 `AROUND` on in slice `far`.
    #[inline(always)]
    fn row<const AROUND: usize, const LAW: u8>(
        &self,
        row: &Row<'_, R>,
        state: &ShellState<R, N, M>,
        [near, far]: [usize; 2],
        sums: &mut Sums<'_, R, N, M>,
    ) {
        let (here, there) = (state.turned(near, 0), state.turned(far, AROUND));
        let mut near = sums.near[near].each_mut().map(|axis| axis.turned_mut(0));
        let mut far = sums.far[AROUND - 1][far].each_mut().map(|axis| axis.turned_mut(AROUND));
        let (loss, ellipse) = (sums.loss.turned_mut(0), sums.ellipse.turned_mut(0));
        for (i, (loss, ellipse)) in loss.iter_mut().zip(ellipse).enumerate() {
            let (link, rate) = (between(here.0, there.0, i), between(here.1, there.1, i));
            let (pull, lost) = self.link::<LAW>(row, i, link, rate, ellipse);
            add(&mut near, i, pull);
            add(&mut far, i, pull);
            *loss += lost;
        }
    }

    /// The same of links that run straight along the axis.
    #[inline(always)]
    fn straight_row<const LAW: u8>(
        &self,
        row: &Row<'_, R>,
        state: &ShellState<R, N, M>,
        [near, far]: [usize; 2],
        sums: &mut Sums<'_, R, N, M>,
    ) {
        let (here, there) = (state.turned(near, 0), state.turned(far, 0));
        let (loss, ellipse) = (sums.loss.turned_mut(0), sums.ellipse.turned_mut(0));
        let (before, after) = sums.near.split_at_mut(far);
        let mut near = before[near].each_mut().map(|axis| axis.turned_mut(0));
        let mut far = after[0].each_mut().map(|axis| axis.turned_mut(0));
        for (i, (loss, ellipse)) in loss.iter_mut().zip(ellipse).enumerate() {
            let (link, rate) = (between(here.0, there.0, i), between(here.1, there.1, i));
            let (pull, lost) = self.link::<LAW>(row, i, link, rate, ellipse);
            add(&mut near, i, pull);
            add(&mut far, i, pull.map(R::neg));
            *loss += lost;
        }
    }

    /// Pull on the near end (N) of a link vector (m) that changes at a rate (m/s), and the power lost in it (W).
    #[inline(always)]
    fn link<const LAW: u8>(
        &self,
        row: &Row<'_, R>,
        entry: usize,
        [dx, dy, dz]: [R; 3],
        [ex, ey, ez]: [R; 3],
        ellipse: &mut R,
    ) -> ([R; 3], R) {
        let direction = row.direction;
        let u = R::ONE - (dx * dx + dy * dy + dz * dz) * direction.inverse_square;
        let g = shortening(u);
        let elastic = match LAW {
            FROM_LENGTH => g * self.bend.factor(u),
            FROM_ASSEMBLED => {
                let (rest, slope) = row.wave.at(row.twice[0][entry], row.twice[1][entry]);
                let added = self.bend.assembled_tension(R::lit(-0.5) * u - rest);
                let square = direction.rest_length * direction.rest_length;
                *ellipse += self.stiffness * square * added * slope;
                g - added
            }
            _ => g,
        };
        // mu*dL/dt*l = mu/L^2*(d . e)*d, and 1/L^2 = (1 + g)^2/L0^2.
        let along = dx * ex + dy * ey + dz * ez;
        let damping = (R::ONE + g) * (R::ONE + g) * (direction.damping * along);
        let pull = damping - self.stiffness * elastic;
        ([pull * dx, pull * dy, pull * dz], damping * along)
    }
}

/// From one node to another.
#[inline(always)]
fn between<R: Real>(near: [&[R]; 3], far: [&[R]; 3], i: usize) -> [R; 3] {
    [far[0][i] - near[0][i], far[1][i] - near[1][i], far[2][i] - near[2][i]]
}

/// Adds a force to a node's.
#[inline(always)]
fn add<R: Real>(sums: &mut [&mut [R]; 3], i: usize, [x, y, z]: [R; 3]) {
    sums[0][i] += x;
    sums[1][i] += y;
    sums[2][i] += z;
}
