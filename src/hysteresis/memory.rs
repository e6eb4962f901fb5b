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
pub(crate) struct Turn<P, F> {
    pub(crate) position: P,
    pub(crate) output: F,
}

type Position<R> = <<R as Real>::Fixed as Fixed<R>>::Position;

/// Memory of at most `MEMORY` turning points; the default is demagnetised at input 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaircaseState<R: Real, const MEMORY: usize> {
    turns: [Turn<Position<R>, R::Fixed>; MEMORY],
    /// Where the last step left off, in the frame of the branch.
    now: Turn<Position<R>, R::Fixed>,
    /// 0 on a rising branch, !0 on a falling one.
    frame: Position<R>,
    /// Turning points in use; 0 on the virgin curve.
    depth: u32,
    status: Status,
}

/// What became of the last input.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Status {
    /// It was within the range.
    #[default]
    Within,
    /// It was beyond +-U and counted as +-U.
    Saturated,
    /// It was not finite: everything is as before.
    Held,
}

impl<R: Real, const MEMORY: usize> Default for StaircaseState<R, MEMORY> {
    fn default() -> Self {
        let now = Turn { position: R::Fixed::MIDDLE, output: R::Fixed::default() };
        Self { turns: [Turn::default(); MEMORY], now, frame: Position::<R>::default(), depth: 0, status: Status::Within }
    }
}

impl<R: Real, const MEMORY: usize> StaircaseState<R, MEMORY> {
    /// Turning points stored, up to `MEMORY`.
    pub fn depth(&self) -> usize {
        self.depth as usize
    }

    /// What became of the last input.
    pub fn status(&self) -> Status {
        self.status
    }

    #[inline(always)]
    pub(crate) fn report(&mut self, status: Status) {
        self.status = status;
    }

    /// Output of the last step.
    #[inline(always)]
    pub(crate) fn output(&self) -> R::Fixed {
        self.now.output.in_frame(self.frame)
    }

    /// Where the branch starts, in the frame of the one before; the virgin curve has no start.
    #[inline(always)]
    pub(crate) fn start(&self) -> Option<Turn<Position<R>, R::Fixed>> {
        self.turns[1..].get((self.depth as usize).wrapping_sub(2)).copied()
    }

    /// Goes to a position, and gives it in the frame of its branch; [`Self::arrive`] is to follow.
    #[inline(always)]
    pub(crate) fn go(&mut self, position: Position<R>) -> Position<R> {
        let mut to = position ^ self.frame;
        let turned = to < self.now.position;
        let mut reached = (self.depth as usize).wrapping_sub(2);
        if turned {
            to = !to;
            self.frame = !self.frame;
            reached = reached.wrapping_add(1);
        }
        match self.turns.get(reached) {
            Some(turn) if turn.position <= to => self.wipe_out(reached, to),
            None if to >= self.now.position => (),
            _ if turned => self.push(),
            _ => (),
        }
        to
    }

    /// Drops every second point up to `reached`, a point that a branch to `to` reaches, as far out as it does.
    #[inline(always)]
    fn wipe_out(&mut self, mut reached: usize, to: Position<R>) {
        let mut stride = (MEMORY / 2 + 1).next_power_of_two();
        while stride > 1 {
            let outer = reached.saturating_sub(stride);
            if self.turns[outer].position <= to {
                reached = outer;
            }
            stride /= 2;
        }
        self.depth = reached as u32;
    }

    /// On the virgin curve.
    #[inline(always)]
    pub(crate) fn forget(&mut self) {
        self.depth = 0;
    }

    /// The output where [`Self::go`] went, in its frame.
    #[inline(always)]
    pub(crate) fn arrive(&mut self, position: Position<R>, output: R::Fixed) {
        self.now = Turn { position, output };
    }

    /// Stores where the last step left off as a turning point.
    #[inline(always)]
    fn push(&mut self) {
        if self.depth == 0 {
            // The demagnetised past is its mirror, a maximum in the other frame.
            self.turns[0] = self.now;
            self.depth = 1;
        }
        let place = (self.depth as usize).min(MEMORY);
        let place = if place == MEMORY { MEMORY - 2 } else { place };
        self.turns[place] = self.now;
        self.depth = place as u32 + 1;
    }

    /// Goes to an end of the range, where everything is wiped out.
    pub(crate) fn saturate(&mut self, upper: bool) -> Position<R> {
        let zero = Position::<R>::default();
        self.frame = if upper { zero } else { !zero };
        self.depth = 0;
        !zero
    }
}
