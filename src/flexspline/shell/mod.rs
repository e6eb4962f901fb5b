//! The mass-spring shell of eq. (6), free in space: n nodes around, m along the axis, 16 links a node.
//!
//! ```text
//! m_ij * ddq_ij = F_ij - k * sum (L - L0) * l - mu * sum dL/dt * l        l = unit vector along the link
//! ```
//!
//! Cartesian coordinates in m, z along the axis. Stretch, shear and bend links as in [`DIRECTIONS`]; those that
//! would leave the axis ends do not exist. k and mu are the same for all; bend links may harden
//! ([`link_law`]). Each link is visited once and its force given to both its nodes, so momentum and
//! angular momentum are kept to rounding. A node carries mass/(n*(m - 1)), one of the end slices half of it.
//!
//! Discretisation: semi-implicit (symplectic) Euler, velocities first. Stable while dt < 2/omega_max;
//! [`Shell::stable_step`] finds omega_max from the mesh.
//!
//! For vector code: one array an axis, `Ring`s (see `ring.rs`), and the forces of near and far ends
//! in arrays of their own, so that no sum waits for one that was just written elsewhere.

mod conserved;
pub mod link_law;
pub(super) mod ring;
mod strain;

pub use link_law::Bend;
pub use strain::Strained;

use core::ops::{Range, RangeInclusive};

use crate::angle::Angle;
use crate::error::{Error, require};
use crate::flexspline::calibration::{Cup, DIRECTIONS, link_length};
use crate::flexspline::spectrum;
use crate::real::Real;
use link_law::shortening;
use ring::{Ring, node_at};

/// A value a node of a slice, an axis each.
pub(super) type Slice<R, const N: usize> = [Ring<R, N>; 3];

/// Everything that a shell is built from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShellParams<R> {
    /// Cylinder: radius, length and mass.
    pub cup: Cup<R>,
    /// k of every link (N/m).
    pub link_stiffness: R,
    /// mu of every link (N s/m).
    pub link_damping: R,
    /// Hardening of the bend links.
    pub bend: Bend<R>,
}

/// One of the 8 link directions.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Direction<R> {
    around: i32,
    along: usize,
    rest_length: R,
    /// 1/L0^2 and mu/L0^2.
    inverse_square: R,
    damping: R,
}

/// The n x m shell, stepped by a fixed dt.
#[derive(Clone, Debug, PartialEq)]
pub struct Shell<R, const N: usize, const M: usize> {
    directions: [Direction<R>; 8],
    stiffness: R,
    bend: Bend<R>,
    radius: R,
    spacing: R,
    node_mass: R,
    dt: R,
    dt_over_mass: R,
    /// Cosine and sine of every node's angle.
    angles: UnitVectors<R, N>,
}

/// Positions (m) and velocities (m/s) of the nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShellState<R, const N: usize, const M: usize> {
    pub(super) position: [Slice<R, N>; M],
    pub(super) velocity: [Slice<R, N>; M],
}

impl<R: Real, const N: usize, const M: usize> ShellState<R, N, M> {
    /// Position of node i of slice j (m).
    pub fn position(&self, i: usize, j: usize) -> [R; 3] {
        self.position[j].each_ref().map(|axis| axis.node(i))
    }

    /// Velocity of node i of slice j (m/s).
    pub fn velocity(&self, i: usize, j: usize) -> [R; 3] {
        self.velocity[j].each_ref().map(|axis| axis.node(i))
    }

    /// Takes all velocities away.
    pub(super) fn stop(&mut self) {
        self.velocity = [[Ring::ZERO; 3]; M];
    }

    /// Sets the velocity of node i of slice j (m/s).
    pub fn set_velocity(&mut self, i: usize, j: usize, velocity: [R; 3]) {
        for (axis, value) in self.velocity[j].iter_mut().zip(velocity) {
            axis.set_node(i, value);
        }
    }
}

/// Mass of a node of slice j of m in inner nodes, and its inverse.
fn mass_share<R: Real>(j: usize, m: usize) -> (R, R) {
    if j == 0 || j == m - 1 { (R::lit(0.5), R::lit(2.0)) } else { (R::ONE, R::ONE) }
}

/// Cosines and sines, by entry of the ring.
pub(super) type UnitVectors<R, const N: usize> = [[R; N]; 2];

/// Cosine and sine of `order` times every node's angle.
pub(super) fn unit_vectors<R: Real, const N: usize>(order: i32) -> UnitVectors<R, N> {
    let angle = |entry| Angle::from_turn_fraction(order * node_at(entry, N) as i32, N as i32);
    [
        core::array::from_fn(|entry| angle(entry).sin_cos().1),
        core::array::from_fn(|entry| angle(entry).sin_cos().0),
    ]
}

/// Closes the rings of all three axes.
#[inline(always)]
pub(super) fn close<R: Real, const N: usize>(slice: &mut Slice<R, N>) {
    for axis in slice {
        axis.close();
    }
}

/// Sum in four interleaved parts, so that one addition need not wait for the last.
#[inline(always)]
pub(super) fn sum<R: Real, const N: usize>(terms: &[R; N]) -> R {
    let mut parts = [R::ZERO; 4];
    for (k, term) in terms.iter().enumerate() {
        parts[k % 4] += *term;
    }
    (parts[0] + parts[1]) + (parts[2] + parts[3])
}

/// What the links of a shell do in one step, gathered row by row.
struct Sums<'a, R, const N: usize, const M: usize> {
    /// Forces on near nodes, and on far ones that stand straight ahead.
    near: &'a mut [Slice<R, N>; M],
    /// Forces against far nodes one and two nodes on.
    far: &'a mut [[Slice<R, N>; M]; 2],
    loss: &'a mut Ring<R, N>,
}

impl<R: Real> ShellParams<R> {
    /// # Errors
    /// As [`Cup::check`] and [`Bend::check`]; [`Error::OutOfRange`] `link_stiffness` unless finite and positive,
    /// `link_damping` unless finite and not negative.
    pub fn check(&self) -> Result<(), Error> {
        self.cup.check()?;
        self.bend.check()?;
        require(self.link_stiffness.is_finite() && self.link_stiffness > R::ZERO, "link_stiffness")?;
        require(self.link_damping.is_finite() && self.link_damping >= R::ZERO, "link_damping")
    }

    /// Mass of an inner node of an n x m shell; the end slices carry half of it (kg).
    pub fn node_mass(&self, n: usize, m: usize) -> R {
        self.cup.mass() / R::from_i32((n * (m - 1)) as i32)
    }

    /// Largest stable step of links that swing at omega^2 = `square`*k/m at most (s): damping of ratio z there
    /// shortens the step of the semi-implicit scheme to 2*(sqrt(1 + z^2) - z)/omega.
    pub(super) fn step_below(&self, square: R, n: usize, m: usize) -> R {
        let saturation = self.bend.saturation;
        let hardest = R::ONE + R::lit(3.0) * self.bend.hardening * saturation * saturation;
        let square = square * hardest * spectrum::assembled(&self.cup);
        let omega = (square * self.link_stiffness / self.node_mass(n, m)).sqrt();
        let ratio = R::lit(0.5) * omega * self.link_damping / self.link_stiffness;
        R::lit(2.0) * ((R::ONE + ratio * ratio).sqrt() - ratio) / omega
    }

    /// Distance of the slices (m).
    fn spacing(&self, m: usize) -> R {
        self.cup.length / R::from_i32(m as i32 - 1)
    }
}

/// Nodes around that a mesh may have: from 4 on every link joins two different nodes.
pub const NODES_AROUND: RangeInclusive<usize> = 4..=1000;
/// Slices along the axis that a mesh may have: a rim and a flange at least.
pub const NODES_ALONG: RangeInclusive<usize> = 2..=1000;

/// # Errors
/// [`Error::OutOfRange`] `n` or `m` outside [`NODES_AROUND`], [`NODES_ALONG`].
pub(super) fn check_nodes(n: usize, m: usize) -> Result<(), Error> {
    require(NODES_AROUND.contains(&n), "n")?;
    require(NODES_ALONG.contains(&m), "m")
}

impl<R: Real, const N: usize, const M: usize> Shell<R, N, M> {
    /// Largest stable time step of the free shell (s).
    pub fn stable_step(params: &ShellParams<R>) -> R {
        let inverse_mass: [R; M] = core::array::from_fn(|j| mass_share::<R>(j, M).1);
        params.step_below(spectrum::largest(&params.cup, N, inverse_mass), N, M)
    }

    /// The shell with a time step dt (s), which is not compared with any stability bound.
    ///
    /// # Errors
    /// As [`ShellParams::check`]; [`Error::OutOfRange`] `n` or `m` outside [`NODES_AROUND`], [`NODES_ALONG`];
    /// `dt` unless finite and positive.
    pub fn build(params: &ShellParams<R>, dt: R) -> Result<Self, Error> {
        check_nodes(N, M)?;
        params.check()?;
        require(dt.is_finite() && dt > R::ZERO, "dt")?;
        let spacing = params.spacing(M);
        let node_mass = params.node_mass(N, M);
        let direction = |(around, along)| {
            let rest_length = link_length(&params.cup, N, spacing, (around, along));
            let inverse_square = R::ONE / (rest_length * rest_length);
            let damping = params.link_damping * inverse_square;
            Direction { around, along, rest_length, inverse_square, damping }
        };
        Ok(Self {
            directions: DIRECTIONS.map(direction),
            stiffness: params.link_stiffness,
            bend: params.bend,
            radius: params.cup.radius,
            spacing,
            node_mass,
            dt,
            dt_over_mass: dt / node_mass,
            angles: unit_vectors(1),
        })
    }

    /// The same shell, stepped by dt.
    pub(super) fn with_step(&self, dt: R) -> Self {
        Self { dt, dt_over_mass: dt / self.node_mass, ..self.clone() }
    }

    /// Cosine and sine of every node's angle.
    #[inline(always)]
    pub(super) fn angles(&self) -> &UnitVectors<R, N> {
        &self.angles
    }

    /// Number of links.
    pub fn links() -> usize {
        DIRECTIONS.iter().map(|(_, along)| N * M.saturating_sub(*along)).sum()
    }

    /// The unstressed cylinder at rest.
    pub fn round(&self) -> ShellState<R, N, M> {
        let height = |j| self.spacing * R::from_i32(j as i32);
        let zero = [Ring::ZERO; 3];
        let mut state = ShellState { position: [zero; M], velocity: [zero; M] };
        for (j, slice) in state.position.iter_mut().enumerate() {
            let [x, y, z] = slice.each_mut().map(Ring::entries_mut);
            let [cosine, sine] = &self.angles;
            for i in 0..N {
                (x[i], y[i], z[i]) = (self.radius * cosine[i], self.radius * sine[i], height(j));
            }
            close(slice);
        }
        state
    }

    /// Moves every node freely by one step; answers with the power lost in the links (W).
    #[inline(always)]
    pub fn step(&self, state: &mut ShellState<R, N, M>) -> R {
        let mut force = [[Ring::ZERO; 3]; M];
        let loss = self.pull(state, &mut force);
        self.advance(state, &force, 0..M);
        loss
    }

    /// Moves the nodes of some slices by one step.
    #[inline(always)]
    pub(super) fn advance(
        &self,
        state: &mut ShellState<R, N, M>,
        force: &[Slice<R, N>; M],
        slices: Range<usize>,
    ) {
        let ShellState { position, velocity } = state;
        let moved = position.iter_mut().zip(velocity).zip(force).enumerate();
        for (j, ((position, velocity), force)) in moved.take(slices.end).skip(slices.start) {
            let gain = self.dt_over_mass * mass_share::<R>(j, M).1;
            for ((position, velocity), force) in position.iter_mut().zip(velocity).zip(force) {
                let (p, v, force) = (position.entries_mut(), velocity.entries_mut(), force.entries());
                for i in 0..N {
                    v[i] += gain * force[i];
                    p[i] += self.dt * v[i];
                }
                position.close();
                velocity.close();
            }
        }
    }

    /// Adds the links' forces to `force` (N); answers with the power lost in them (W).
    #[inline(always)]
    pub(super) fn pull(&self, state: &ShellState<R, N, M>, force: &mut [Slice<R, N>; M]) -> R {
        if self.bend.hardening > R::ZERO {
            self.pull_with::<true>(state, force)
        } else {
            self.pull_with::<false>(state, force)
        }
    }

    #[inline(always)]
    fn pull_with<const HARDENING: bool>(
        &self,
        state: &ShellState<R, N, M>,
        force: &mut [Slice<R, N>; M],
    ) -> R {
        let mut far = [[[Ring::ZERO; 3]; M]; 2];
        let mut loss = Ring::ZERO;
        let mut sums = Sums { near: force, far: &mut far, loss: &mut loss };
        let [ring, axial, shear, shear_back, bend, bend_axial, bend_shear, bend_shear_back] =
            &self.directions;
        // A link that goes back around is one that goes forward from its other end.
        for j in 0..M {
            self.row::<1, false>(ring, state, [j, j], &mut sums);
            self.row::<2, HARDENING>(bend, state, [j, j], &mut sums);
            if j + 1 < M {
                self.straight_row::<false>(axial, state, [j, j + 1], &mut sums);
                self.row::<1, false>(shear, state, [j, j + 1], &mut sums);
                self.row::<1, false>(shear_back, state, [j + 1, j], &mut sums);
            }
            if j + 2 < M {
                self.straight_row::<HARDENING>(bend_axial, state, [j, j + 2], &mut sums);
                self.row::<2, HARDENING>(bend_shear, state, [j, j + 2], &mut sums);
                self.row::<2, HARDENING>(bend_shear_back, state, [j + 2, j], &mut sums);
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
        sum(loss.entries())
    }

    /// Pull of the links from every node of slice `near` to the node 1 or 2 `AROUND` on in slice `far`.
    #[inline(always)]
    fn row<const AROUND: usize, const HARDENING: bool>(
        &self,
        direction: &Direction<R>,
        state: &ShellState<R, N, M>,
        [near, far]: [usize; 2],
        sums: &mut Sums<'_, R, N, M>,
    ) {
        let [px, py, pz] = state.position[near].each_ref().map(|axis| axis.turned(0));
        let [vx, vy, vz] = state.velocity[near].each_ref().map(|axis| axis.turned(0));
        let [qx, qy, qz] = state.position[far].each_ref().map(|axis| axis.turned(AROUND));
        let [wx, wy, wz] = state.velocity[far].each_ref().map(|axis| axis.turned(AROUND));
        let [near_x, near_y, near_z] = sums.near[near].each_mut().map(|axis| axis.turned_mut(0));
        let [far_x, far_y, far_z] = sums.far[AROUND - 1][far].each_mut().map(|axis| axis.turned_mut(AROUND));
        let loss = sums.loss.turned_mut(0);
        for i in 0..px.len() {
            let link = [qx[i] - px[i], qy[i] - py[i], qz[i] - pz[i]];
            let rate = [wx[i] - vx[i], wy[i] - vy[i], wz[i] - vz[i]];
            let ([x, y, z], lost) = self.link::<HARDENING>(direction, link, rate);
            near_x[i] += x;
            near_y[i] += y;
            near_z[i] += z;
            far_x[i] += x;
            far_y[i] += y;
            far_z[i] += z;
            loss[i] += lost;
        }
    }

    /// The same of links that run straight along the axis.
    #[inline(always)]
    fn straight_row<const HARDENING: bool>(
        &self,
        direction: &Direction<R>,
        state: &ShellState<R, N, M>,
        [near, far]: [usize; 2],
        sums: &mut Sums<'_, R, N, M>,
    ) {
        let [px, py, pz] = state.position[near].each_ref().map(|axis| axis.turned(0));
        let [vx, vy, vz] = state.velocity[near].each_ref().map(|axis| axis.turned(0));
        let [qx, qy, qz] = state.position[far].each_ref().map(|axis| axis.turned(0));
        let [wx, wy, wz] = state.velocity[far].each_ref().map(|axis| axis.turned(0));
        let loss = sums.loss.turned_mut(0);
        let (before, after) = sums.near.split_at_mut(far);
        let [near_x, near_y, near_z] = before[near].each_mut().map(|axis| axis.turned_mut(0));
        let [far_x, far_y, far_z] = after[0].each_mut().map(|axis| axis.turned_mut(0));
        for i in 0..px.len() {
            let link = [qx[i] - px[i], qy[i] - py[i], qz[i] - pz[i]];
            let rate = [wx[i] - vx[i], wy[i] - vy[i], wz[i] - vz[i]];
            let ([x, y, z], lost) = self.link::<HARDENING>(direction, link, rate);
            near_x[i] += x;
            near_y[i] += y;
            near_z[i] += z;
            far_x[i] -= x;
            far_y[i] -= y;
            far_z[i] -= z;
            loss[i] += lost;
        }
    }

    /// Pull on the near end (N) of a link vector (m) that changes at a rate (m/s), and the power lost in it (W).
    #[inline(always)]
    fn link<const HARDENING: bool>(
        &self,
        direction: &Direction<R>,
        [dx, dy, dz]: [R; 3],
        [ex, ey, ez]: [R; 3],
    ) -> ([R; 3], R) {
        let u = R::ONE - (dx * dx + dy * dy + dz * dz) * direction.inverse_square;
        let g = shortening(u);
        let elastic = if HARDENING { g * self.bend.factor(u) } else { g };
        // mu*dL/dt*l = mu/L^2*(d . e)*d, and 1/L^2 = (1 + g)^2/L0^2.
        let along = dx * ex + dy * ey + dz * ez;
        let damping = (R::ONE + g) * (R::ONE + g) * (direction.damping * along);
        let pull = damping - self.stiffness * elastic;
        ([pull * dx, pull * dy, pull * dz], damping * along)
    }
}
