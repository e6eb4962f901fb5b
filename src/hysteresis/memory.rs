//! What a staircase remembers: the turning points that later ones have not wiped out.
//!
//! They alternate and are nested, r_1 the outermost; r_0 = -r_1 stands for the demagnetised past. Weights are
//! symmetric, so a falling input is a rising one in a mirror: every branch rises in its own frame, and every
//! turning point is a maximum in the frame of the branch that it ended. There it is stored, and seen from the next
//! branch it is a minimum:
//!
//! ```text
//! the input is at v in the frame of the branch:    -r_d <= v < r_(d-1),   d points in use
//! v reaches r_(d-1)      r_(d-1) and r_d are wiped out; what is left is found by halving
//! v falls below where the last step left off       that is stored, and the frame mirrored
//! v falls below -r_d     the same, and as if r_d had never been
//! ```
//!
//! Halving takes one comparison for each bit of the capacity, whatever the history.
//!
//! Full memory: the smallest loop, the last two points, is forgotten for the new one. The outputs of the
//! others stay, so nothing jumps then.

use super::fixed::Fixed;
use crate::real::Real;

/// A position and its output in the frame of a branch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Turn<R: Real> {
    pub(crate) position: Position<R>,
    pub(crate) output: R::Fixed,
}

pub(crate) type Position<R> = <<R as Real>::Fixed as Fixed<R>>::Position;

/// Memory of at most `MEMORY` turning points; the default is demagnetised at input 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct StaircaseState<R: Real, const MEMORY: usize> {
    /// Each as the start of the branch that followed it, in that one's frame.
    turns: [Turn<R>; MEMORY],
    /// Where the last step left off, in the frame of the branch.
    position: Position<R>,
    /// 0 on a rising branch, !0 on a falling one.
    frame: Position<R>,
    /// Turning points in use; 0 on the virgin curve.
    depth: u32,
    /// Output of the last step, in the frame of the branch.
    output: R::Fixed,
    /// Inputs so far that were not a number.
    held: u32,
}

impl<R: Real, const MEMORY: usize> Default for StaircaseState<R, MEMORY> {
    fn default() -> Self {
        Self {
            turns: [Turn::default(); MEMORY],
            position: R::Fixed::MIDDLE,
            frame: Position::<R>::default(),
            depth: 0,
            output: R::Fixed::default(),
            held: 0,
        }
    }
}

impl<R: Real, const MEMORY: usize> StaircaseState<R, MEMORY> {
    /// Turning points stored, up to `MEMORY`.
    pub fn depth(&self) -> usize {
        self.depth as usize
    }

    /// The last input was at an end of the range, or beyond it and counted as that.
    pub fn is_saturated(&self) -> bool {
        self.position == !Position::<R>::default()
    }

    /// How many inputs so far were not a number; each left everything else as it was.
    pub fn held(&self) -> u32 {
        self.held
    }

    /// Output of the last step.
    #[inline(always)]
    pub(crate) fn output(&self) -> R::Fixed {
        self.output.in_frame(self.frame)
    }

    /// Goes to a position: that in the frame of its branch, and where the branch starts; the virgin curve has no
    /// start. [`Self::arrive`] is to follow.
    #[inline(always)]
    pub(crate) fn go(&mut self, position: Position<R>) -> (Position<R>, Option<Turn<R>>) {
        let along = position ^ self.frame;
        let (turned, one_less) = R::Fixed::below(along, self.position);
        self.frame = self.frame ^ turned;
        let to = along ^ turned;
        let mirror = !to;
        let bound = (self.depth as usize).wrapping_sub(2).wrapping_sub(one_less);
        let turned = turned == !Position::<R>::default();
        let Some(turn) = self.turns.get(bound) else {
            cheaper();
            return (to, if turned && to < self.position { Some(self.leave_virgin_curve()) } else { None });
        };
        if turn.position >= mirror {
            return (to, self.wipe_out(bound, mirror));
        }
        cheaper();
        if turned {
            return (to, Some(self.push(bound + 1)));
        }
        (to, self.turns.get(bound + 1).copied())
    }

    /// Drops every second point up to `reached`, as far out as a branch to `mirror` in the other frame reaches it.
    #[inline(always)]
    fn wipe_out(&mut self, mut reached: usize, mirror: Position<R>) -> Option<Turn<R>> {
        if self.turns[0].position >= mirror {
            cheaper();
            self.depth = 0;
            return None;
        }
        let mut stride = (MEMORY / 2 + 1).next_power_of_two();
        while stride > 1 {
            let outer = reached.saturating_sub(stride);
            reached = core::hint::select_unpredictable(self.turns[outer].position >= mirror, outer, reached);
            stride /= 2;
        }
        self.depth = reached as u32;
        let start = self.turns.get(reached.wrapping_sub(1));
        if start.is_none() {
            cheaper();
        }
        start.copied()
    }

    /// The output where [`Self::go`] went, in its frame.
    #[inline(always)]
    pub(crate) fn arrive(&mut self, position: Position<R>, output: R::Fixed) {
        (self.position, self.output) = (position, output);
    }

    /// Stores where the last step left off as a turning point behind `depth` others.
    #[inline(always)]
    fn push(&mut self, depth: usize) -> Turn<R> {
        let turn = Turn { position: !self.position, output: !self.output };
        let place = if depth >= MEMORY { MEMORY - 2 } else { depth };
        self.turns[place] = turn;
        self.depth = place as u32 + 1;
        turn
    }

    /// Stores it as the first; the demagnetised past is its mirror.
    #[cold]
    #[inline(never)]
    fn leave_virgin_curve(&mut self) -> Turn<R> {
        self.push(0);
        self.push(1)
    }

    /// Falls to the end of the range, where everything is wiped out.
    pub(crate) fn fall_to_end(&mut self) -> Position<R> {
        let end = !Position::<R>::default();
        (self.frame, self.depth) = (end, 0);
        end
    }

    /// Leaves everything as it is for an input that is not a number.
    pub(crate) fn hold(&mut self) {
        self.held = self.held.saturating_add(1);
    }
}

/// Marks a path that costs less than the one beside it, which then is the one to fall through.
#[cold]
#[inline]
pub(super) fn cheaper() {}
