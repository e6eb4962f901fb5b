//! The mass-spring shell of eq. (6), free in space: n nodes around, m along the axis, up to 16 links a node.
//!
//! ```text
//! m_ij * ddq_ij = F_ij - k * sum (L - L0) * l - mu * sum dL/dt * l        l = unit vector along the link
//! ```
//!
//! Cartesian coordinates in m, z along the axis. Stretch, shear and bend links as in [`DIRECTIONS`]; those that
//! would leave the axis ends do not exist: a node has 16 from two slices inside either end on, and with m = 4 it has
//! 13 inside and 10 at the ends. k and mu are the same for all; bend links may harden
//! ([`link_law`]). Each link is visited once and its force given to both its nodes, so momentum and
//! angular momentum are kept to rounding. A node has mass/(n*(m - 1)), one of the end slices half of it.
//!
//! Discretisation: semi-implicit (symplectic) Euler, velocities first. Stable while dt < 2/omega_max;
//! [`Shell::stable_step`] finds omega_max from the mesh.
//!
//! For vector code: one array an axis, `Ring`s (see `ring.rs`); the links themselves are in `pull.rs`.

pub(super) mod assembled;
mod conserved;
pub mod link_law;
mod pull;
pub(super) mod ring;
mod strain;

pub use link_law::Bend;
pub use strain::Strained;

use core::ops::{Range, RangeInclusive};

use crate::angle::Angle;
use crate::error::{Error, require};
use crate::flexspline::cup::{Cup, DIRECTIONS, link_length};
use crate::flexspline::spectrum;
use crate::real::Real;
use assembled::Assembled;
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
    /// Where the bend links harden from, if not from their free length.
    assembled: Option<Assembled<R, M>>,
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

    /// Positions and velocities of a slice, an axis each, entry by entry the node `around` nodes on.
    #[inline(always)]
    fn turned(&self, slice: usize, around: usize) -> ([&[R]; 3], [&[R]; 3]) {
        let (position, velocity) = (&self.position[slice], &self.velocity[slice]);
        (
            position.each_ref().map(|axis| axis.turned(around)),
            velocity.each_ref().map(|axis| axis.turned(around)),
        )
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

impl<R: Real> ShellParams<R> {
    /// # Errors
    /// As [`Cup::check`] and [`Bend::check`]; [`Error::OutOfRange`] `link_stiffness` unless finite and positive,
    /// `link_damping` unless finite and not negative.
    pub fn check(&self) -> Result<(), Error> {
        self.cup.check()?;
        self.bend.check()?;
        require(self.link_stiffness.is_positive(), "link_stiffness")?;
        require(self.link_damping.is_finite() && self.link_damping >= R::ZERO, "link_damping")
    }

    /// Mass of an inner node of an n x m shell; the end slices have half of it (kg).
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
        require(dt.is_positive(), "dt")?;
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
            assembled: None,
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
}
