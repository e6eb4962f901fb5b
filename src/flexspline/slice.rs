//! One slice of the mesh: a ring of nodes in structure-of-arrays form, so that its sums become vector code.
//!
//! Cartesian components, one entry a node. A link that spans `around` nodes joins entry i of one slice with
//! entry i + around of another; on the ring these are two pairs of ranges, [`segments`].

use core::ops::Range;

use crate::real::Real;

/// A value per node of a slice, for each Cartesian axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slice<R, const N: usize> {
    pub(super) x: [R; N],
    pub(super) y: [R; N],
    pub(super) z: [R; N],
}

impl<R: Real, const N: usize> Slice<R, N> {
    pub(super) const ZERO: Self = Self { x: [R::ZERO; N], y: [R::ZERO; N], z: [R::ZERO; N] };

    pub(super) fn add(&mut self, other: &Self, factor: R) {
        for i in 0..N {
            self.x[i] += factor * other.x[i];
            self.y[i] += factor * other.y[i];
            self.z[i] += factor * other.z[i];
        }
    }

    /// Takes entry i of `pull` from node i + around.
    pub(super) fn take_turned(&mut self, pull: &Self, around: i32) {
        for (mine, theirs) in [(&mut self.x, &pull.x), (&mut self.y, &pull.y), (&mut self.z, &pull.z)] {
            for [near, far] in segments(N, around) {
                for (mine, theirs) in mine[far].iter_mut().zip(&theirs[near]) {
                    *mine -= *theirs;
                }
            }
        }
    }
}

/// The ring of n nodes and the same ring turned by `around`, as two pairs of equally long ranges.
#[inline(always)]
pub(super) fn segments(n: usize, around: i32) -> [[Range<usize>; 2]; 2] {
    let shift = around.rem_euclid(n as i32) as usize;
    [[0..n - shift, shift..n], [n - shift..n, 0..shift]]
}

/// Neighbouring nodes of one slice.
#[derive(Clone, Copy)]
pub(super) struct Nodes<'a, R> {
    pub(super) position: [&'a [R]; 3],
    pub(super) velocity: [&'a [R]; 3],
}

impl<'a, R: Real> Nodes<'a, R> {
    #[inline(always)]
    pub(super) fn of<const N: usize>(
        position: &'a Slice<R, N>,
        velocity: &'a Slice<R, N>,
        range: &Range<usize>,
    ) -> Self {
        let part = |slice: &'a Slice<R, N>| {
            [&slice.x[range.clone()], &slice.y[range.clone()], &slice.z[range.clone()]]
        };
        Self { position: part(position), velocity: part(velocity) }
    }

    #[inline(always)]
    pub(super) fn first(self, count: usize) -> Self {
        let cut = |[x, y, z]: [&'a [R]; 3]| [&x[..count], &y[..count], &z[..count]];
        Self { position: cut(self.position), velocity: cut(self.velocity) }
    }
}

/// From one node to another, a component an axis.
#[inline(always)]
pub(super) fn between<R: Real>(near: [&[R]; 3], far: [&[R]; 3], i: usize) -> [R; 3] {
    [far[0][i] - near[0][i], far[1][i] - near[1][i], far[2][i] - near[2][i]]
}

/// Unit vectors (cosine, sine) turned by the angle whose sine and cosine are given.
#[inline(always)]
pub(super) fn turned_by<R: Real, const N: usize>(
    vectors: &[(R, R); N],
    (sine, cosine): (R, R),
) -> [(R, R); N] {
    vectors.map(|(c, s)| (c * cosine - s * sine, s * cosine + c * sine))
}

/// Sum of force times displacement per unit of the angle that moves the slice: a torque (N m).
pub(super) fn virtual_work<R: Real, const N: usize>(force: &Slice<R, N>, derivative: &Slice<R, N>) -> R {
    let work: [R; N] = core::array::from_fn(|i| force.x[i] * derivative.x[i] + force.y[i] * derivative.y[i]);
    sum(&work)
}

/// Sum in four interleaved parts, so that one addition need not wait for the last.
pub(super) fn sum<R: Real, const N: usize>(terms: &[R; N]) -> R {
    let mut parts = [R::ZERO; 4];
    for (k, term) in terms.iter().enumerate() {
        parts[k % 4] += *term;
    }
    (parts[0] + parts[1]) + (parts[2] + parts[3])
}
