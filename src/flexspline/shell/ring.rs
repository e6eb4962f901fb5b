//! Values of a ring's n nodes, stored so that the neighbours of all nodes are one contiguous range.
//!
//! The ring is cut into `lanes` equal arcs, stored interleaved: entry s holds node
//! `(s % lanes)*(n/lanes) + s/lanes`. The neighbour k nodes on then stands k*lanes entries on, for every entry
//! alike. Behind the last entry stand the first ones of each next arc once more ([`Ring::close`]), so that
//! neither a loop over links nor vector code in it ever meets the end of the ring. Loops run over whole
//! cache lines, [`padded`]: what they find behind the last entry are true links once more, and what they add there
//! is left out.

use crate::real::Real;

/// Reach of a link around, in nodes.
const REACH: usize = 2;

/// Bytes of a cache line, and of the widest vector.
const LINE: usize = 64;

/// One value a node, and behind them those that the last nodes' links reach.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub(in crate::flexspline) struct Ring<R, const N: usize>([[R; N]; 2]);

/// Arcs of a ring of n nodes: at most 4, each of the same length and no shorter than a link's reach.
const fn lanes(n: usize) -> usize {
    let mut lanes = 4;
    while lanes > 1 && (!n.is_multiple_of(lanes) || n / lanes < REACH) {
        lanes -= 1;
    }
    lanes
}

/// Entries of a loop over a ring of n: whole lines, where they add less than half of it.
const fn padded<R>(n: usize) -> usize {
    let whole = n.next_multiple_of(LINE / size_of::<R>());
    if whole - n <= n / 2 && whole + REACH * lanes(n) <= 2 * n { whole } else { n }
}

/// The node that entry s of a ring of n nodes holds.
pub(in crate::flexspline) const fn node_at(entry: usize, n: usize) -> usize {
    entry % lanes(n) * (n / lanes(n)) + entry / lanes(n)
}

/// The entry that holds node i of a ring of n nodes.
pub(in crate::flexspline) const fn entry_of(node: usize, n: usize) -> usize {
    let arc = n / lanes(n);
    node % arc * lanes(n) + node / arc
}

impl<R: Real, const N: usize> Ring<R, N> {
    pub(in crate::flexspline) const ZERO: Self = Self([[R::ZERO; N]; 2]);
    /// Known to the compiler even where it inlines nothing between crates, as vector code needs.
    const LANES: usize = lanes(N);
    const LOOP: usize = padded::<R>(N);

    /// Values by entry, in the order that [`node_at`] states.
    #[inline(always)]
    pub(in crate::flexspline) fn entries(&self) -> &[R; N] {
        &self.0[0]
    }

    /// Values by entry; to be closed after a change.
    #[inline(always)]
    pub(in crate::flexspline) fn entries_mut(&mut self) -> &mut [R; N] {
        &mut self.0[0]
    }

    /// The value at node i.
    pub(in crate::flexspline) fn node(&self, i: usize) -> R {
        self.0[0][entry_of(i, N)]
    }

    /// Sets the value at node i and closes the ring.
    pub(in crate::flexspline) fn set_node(&mut self, i: usize, value: R) {
        self.0[0][entry_of(i, N)] = value;
        self.close();
    }

    /// Entry by entry over whole lines, the value `around` nodes on: 0, 1 or 2.
    #[inline(always)]
    pub(in crate::flexspline) fn turned(&self, around: usize) -> &[R] {
        &self.0.as_flattened()[around * Self::LANES..][..Self::LOOP]
    }

    /// As [`Ring::turned`], to add to; to be folded by the same `around` after that.
    #[inline(always)]
    pub(in crate::flexspline) fn turned_mut(&mut self, around: usize) -> &mut [R] {
        &mut self.0.as_flattened_mut()[around * Self::LANES..][..Self::LOOP]
    }

    /// Repeats the first nodes of each next arc behind the last entry.
    #[inline(always)]
    pub(in crate::flexspline) fn close(&mut self) {
        let [ring, behind] = &mut self.0;
        for (to, from) in Self::overlap(Self::LOOP - N + REACH * Self::LANES) {
            behind[to] = ring[from];
        }
    }

    /// Adds what the ring's own nodes, turned by `around`, have added behind the last entry to where it belongs.
    #[inline(always)]
    pub(in crate::flexspline) fn fold(&mut self, around: usize) {
        let [ring, behind] = &mut self.0;
        for (from, to) in Self::overlap(around * Self::LANES) {
            ring[to] += behind[from];
        }
    }

    /// The first `count` entries behind the last one, each with the entry of the same node.
    #[inline(always)]
    fn overlap(count: usize) -> impl Iterator<Item = (usize, usize)> {
        let lanes = Self::LANES;
        (0..count).map(move |k| (k, k / lanes * lanes + (k + 1) % lanes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbered<const N: usize>() -> Ring<f64, N> {
        let mut ring = Ring::ZERO;
        for i in 0..N {
            ring.set_node(i, i as f64);
        }
        ring
    }

    fn check<const N: usize>() {
        let ring = numbered::<N>();
        for around in 0..=REACH {
            assert!(ring.turned(around).len() >= N);
            for (here, there) in ring.turned(0).iter().zip(ring.turned(around)) {
                assert_eq!(*there as usize, (*here as usize + around) % N, "{around} nodes on of {N}");
            }
            let mut gathered = Ring::<f64, N>::ZERO;
            for (sum, value) in gathered.turned_mut(around).iter_mut().zip(ring.turned(0)) {
                *sum += *value;
            }
            gathered.fold(around);
            for i in 0..N {
                assert_eq!(gathered.node((i + around) % N), i as f64, "{around} nodes on of {N}");
            }
        }
        assert!((0..N).all(|i| node_at(entry_of(i, N), N) == i));
    }

    #[test]
    fn a_neighbour_is_the_same_number_of_entries_on_for_every_node() {
        check::<4>();
        check::<5>();
        check::<6>();
        check::<7>();
        check::<8>();
        check::<9>();
        check::<36>();
    }
}
