//! Strain of the bend links in the assembled shape, from which they harden.
//!
//! The wave generator strains a link by a function of the angle b of its first node from the major axis alone, whatever the
//! node: the mesh is the same all around. It repeats every half turn,
//!
//! ```text
//! e_assembled(b) = c0 + c2*cos(2b) + s2*sin(2b) + c4*cos(4b) + s4*sin(4b)
//! ```
//!
//! Green's strain, of the settled mesh without hardening: the fourth harmonic and the mean are of second order in w0/R, the
//! next ones are below 1e-6. b counts from the rim's angle. As the hardening's energy moves with b, so does a torque
//! between rim and wave generator: the sum of tension times de_assembled/db.

use super::ring::Ring;
use super::{Direction, Shell, ShellState, UnitVectors};
use crate::flexspline::cup::is_bend;
use crate::real::Real;

/// Directions of bend links: the last ones of [`crate::flexspline::cup::DIRECTIONS`].
const BENDS: usize = 4;

/// c0, c2, s2, c4, s4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wave<R>([R; 5]);

/// Strains of the assembled shape, for each direction of bend links and each slice of their first nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::flexspline) struct Assembled<R, const M: usize>([[Wave<R>; M]; BENDS]);

impl<R: Real> Wave<R> {
    pub(super) const ZERO: Self = Self([R::ZERO; 5]);

    /// Strain and its slope over b, at the cosine and sine of 2b.
    #[inline(always)]
    pub(super) fn at(&self, cosine: R, sine: R) -> (R, R) {
        let [mean, c2, s2, c4, s4] = self.0;
        let (two, four) = (R::lit(2.0), R::lit(4.0));
        let (cosine_4, sine_4) = (cosine * cosine - sine * sine, two * sine * cosine);
        (
            mean + c2 * cosine + s2 * sine + c4 * cosine_4 + s4 * sine_4,
            two * (s2 * cosine - c2 * sine) + four * (s4 * cosine_4 - c4 * sine_4),
        )
    }

    /// Adds one of `count` strains at equally spaced b.
    fn add(&mut self, strain: R, count: R, cosine: R, sine: R) {
        let share = strain / count;
        let twice = R::lit(2.0) * share;
        let waves = [cosine, sine, cosine * cosine - sine * sine, R::lit(2.0) * sine * cosine];
        self.0[0] += share;
        for (amplitude, wave) in self.0[1..].iter_mut().zip(waves) {
            *amplitude += twice * wave;
        }
    }
}

impl<R: Real, const M: usize> Assembled<R, M> {
    pub(in crate::flexspline) const ROUND: Self = Self([[Wave::ZERO; M]; BENDS]);

    /// The strain of the links of a bend direction whose first nodes are in a slice.
    #[inline(always)]
    pub(super) fn wave(&self, bend: usize, slice: usize) -> &Wave<R> {
        &self.0[bend][slice]
    }
}

impl<R: Real, const N: usize, const M: usize> Shell<R, N, M> {
    /// Adds one of `shapes` settled meshes, the wave generator's angles of which divide that of a link equally.
    pub(in crate::flexspline) fn add_assembled(
        &self,
        assembled: &mut Assembled<R, M>,
        shapes: i32,
        state: &ShellState<R, N, M>,
        [cosine, sine]: &UnitVectors<R, N>,
    ) {
        let count = R::from_i32(shapes * N as i32);
        self.for_each_link(state, |direction, entry, slice, u| {
            if let Some(bend) = self.bend_index(direction) {
                let wave = &mut assembled.0[bend][slice];
                wave.add(R::lit(-0.5) * u, count, cosine[entry], sine[entry]);
            }
        });
    }

    /// The shell whose bend links harden from these strains.
    pub(in crate::flexspline) fn hardening_from(self, assembled: Assembled<R, M>) -> Self {
        Self { assembled: Some(assembled), ..self }
    }

    /// Energy of the hardening from the assembled shape (J).
    pub(in crate::flexspline) fn hardening_energy(
        &self,
        state: &ShellState<R, N, M>,
        [cosine, sine]: &[Ring<R, N>; 2],
    ) -> R {
        let Some(assembled) = &self.assembled else { return R::ZERO };
        let mut energy = R::ZERO;
        self.for_each_link(state, |direction, entry, slice, u| {
            if let Some(bend) = self.bend_index(direction) {
                let (c, s) = (cosine.entries()[entry], sine.entries()[entry]);
                let strain = R::lit(-0.5) * u - assembled.wave(bend, slice).at(c, s).0;
                let square = direction.rest_length * direction.rest_length;
                energy += self.stiffness * square * self.bend.assembled_potential(strain);
            }
        });
        energy
    }

    /// Which of the bend directions this is.
    fn bend_index(&self, direction: &Direction<R>) -> Option<usize> {
        let bends = self.directions.iter().filter(|other| is_bend((other.around, other.along)));
        bends.enumerate().find(|(_, other)| *other == direction).map(|(k, _)| k)
    }
}
