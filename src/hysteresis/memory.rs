//! Memory of a staircase: the turning points that later ones have not wiped out.
//!
//! They alternate and are nested, r_1 the outermost; r_0 = -r_1 stands for the demagnetised past. Weights are
//! symmetric, so a falling input is a rising one in a mirror: every branch rises in its own frame. A turning point
//! is a maximum in the frame of the branch that it ended, and a minimum in that of the next branch, where it is
//! stored as that one's start:
//!
//! ```text
//! the input is at v in the frame of the branch:    -r_d <= v < r_(d-1),   d points in use
//! v reaches r_(d-1)      r_(d-1) and r_d are wiped out; the remaining depth is found by bisection
//! v falls below the last step's position           that is stored, and the frame mirrored
//! v falls below -r_d     the same, and as if r_d had never been
//! ```
//!
//! Bisection takes one comparison for each bit of the capacity, whatever the history.
//!
//! Full memory: the smallest loop, the last two points, is forgotten for the new one. The outputs of the
//! others stay, so that the output is continuous. It has an error only while the input passes forgotten points outwards,
//! and never a larger one than the output's change over the smallest loop that is kept, the largest of them where the
//! memory has been full more than once: for a ring-down that loses
//! 6 % a half cycle, 24 points and the standard shape 11 % of the output at saturation; the largest error found is
//! 2.5 % (`strainwave verify hysteresis`).

use crate::branch::cheaper;
use crate::fixed::Fixed;
use crate::real::Real;

/// Turning point: a past extremum as position and output in the frame of a branch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct TurningPoint<R: Real> {
    pub(crate) position: Position<R>,
    pub(crate) output: R::Fixed,
}

pub(crate) type Position<R> = <<R as Real>::Fixed as Fixed<R>>::Position;

/// Memory of at most `MEMORY` turning points; the default is demagnetised at input 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct StaircaseState<R: Real, const MEMORY: usize> {
    /// Each as the start of the branch that followed it, in that one's frame.
    turning_points: [TurningPoint<R>; MEMORY],
    /// Position of the last step, in the frame of the branch.
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
            turning_points: [TurningPoint::default(); MEMORY],
            position: R::Fixed::MIDDLE,
            frame: Position::<R>::default(),
            depth: 0,
            output: R::Fixed::default(),
            held: 0,
        }
    }
}

/// Branch on which an input is reached.
enum Branch {
    /// On the virgin curve.
    Virgin,
    /// On the branch of the last step, which starts at the last of so many points.
    Same(usize),
    /// On one that starts at the last of so many points, those behind being wiped out.
    Resumed(usize),
    /// On one that starts at the last step's position, behind so many points.
    Turned(usize),
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

    /// Number of inputs so far that were not a number; each left everything else as it was.
    pub fn held(&self) -> u32 {
        self.held
    }

    /// Output of the last step.
    #[inline(always)]
    pub(crate) fn output(&self) -> R::Fixed {
        self.output.in_frame(self.frame)
    }

    /// Goes to a position: that in the frame of its branch, and the branch's start; the virgin curve has none.
    /// [`Self::arrive`] is to follow.
    #[inline(always)]
    pub(crate) fn go(&mut self, position: Position<R>) -> (Position<R>, Option<TurningPoint<R>>) {
        let along = position ^ self.frame;
        let (turned, one_less) = R::Fixed::below(along, self.position);
        if one_less != 0 || !R::Fixed::FORESEEN {
            self.frame = self.frame ^ turned;
        }
        let to = along ^ turned;
        let start = match self.branch(one_less, to, !to, self.position, |point| point.position) {
            Branch::Virgin => {
                self.depth = 0;
                None
            }
            Branch::Same(depth) => self.start(depth),
            Branch::Resumed(depth) => {
                self.depth = depth as u32;
                self.start(depth)
            }
            Branch::Turned(depth) => Some(self.push(depth)),
        };
        (to, start)
    }

    /// Start of the branch behind `depth` >= 2 points.
    #[inline(always)]
    fn start(&self, depth: usize) -> Option<TurningPoint<R>> {
        let start = self.turning_points.get(depth.wrapping_sub(1));
        if start.is_none() {
            cheaper();
        }
        start.copied()
    }

    /// The branch on which a `key` that rises along every branch, and is `now`, becomes `to`; `mirror` is that
    /// in the other frame, `turned` is -1 when the frame is not that of the last step, else 0.
    #[inline(always)]
    fn branch<K: PartialOrd + Copy>(
        &self,
        turned: usize,
        to: K,
        mirror: K,
        now: K,
        key: impl Fn(&TurningPoint<R>) -> K,
    ) -> Branch {
        let bound = (self.depth as usize).wrapping_sub(2).wrapping_sub(turned);
        let turned = turned != 0;
        let Some(point) = self.turning_points.get(bound) else {
            cheaper();
            return if turned && to < now { Branch::Turned(0) } else { Branch::Virgin };
        };
        let short = key(point) < mirror;
        let short = if R::Fixed::FORESEEN { short } else { seldom(short) };
        if short {
            return if turned { Branch::Turned(bound + 1) } else { Branch::Same(bound + 2) };
        }
        if key(&self.turning_points[0]) >= mirror {
            cheaper();
            return Branch::Virgin;
        }
        // Every second point up to that one may be reached too.
        let mut reached = bound;
        let mut stride = (MEMORY / 2 + 1).next_power_of_two();
        while stride > 1 {
            let outer = reached.saturating_sub(stride);
            reached =
                core::hint::select_unpredictable(key(&self.turning_points[outer]) >= mirror, outer, reached);
            stride /= 2;
        }
        Branch::Resumed(reached)
    }

    /// Start of the branch on which a `key` that rises along every branch, and is `now`, becomes `to`, in its
    /// frame; that is another than that of the last step when it has `turned`.
    #[inline(always)]
    pub(crate) fn start_of_branch<K: PartialOrd + Copy>(
        &self,
        turned: bool,
        to: K,
        mirror: K,
        now: K,
        key: impl Fn(&TurningPoint<R>) -> K,
    ) -> Option<TurningPoint<R>> {
        match self.branch(0_usize.wrapping_sub(usize::from(turned)), to, mirror, now, key) {
            Branch::Virgin => None,
            Branch::Same(depth) | Branch::Resumed(depth) => {
                Some(*self.turning_points.get(depth.wrapping_sub(1)).unwrap_or(&self.turning_points[0]))
            }
            Branch::Turned(_) => Some(TurningPoint { position: !self.position, output: !self.output }),
        }
    }

    /// Position and output of the last step, in the frame of its branch.
    #[inline(always)]
    pub(crate) fn now(&self) -> TurningPoint<R> {
        TurningPoint { position: self.position, output: self.output }
    }

    /// That frame.
    #[inline(always)]
    pub(crate) fn frame(&self) -> Position<R> {
        self.frame
    }

    /// Whether the branch falls.
    #[inline(always)]
    pub(crate) fn is_falling(&self) -> bool {
        self.frame != Position::<R>::default()
    }

    /// Sets the output at the position of [`Self::go`], in its frame.
    #[inline(always)]
    pub(crate) fn arrive(&mut self, position: Position<R>, output: R::Fixed) {
        (self.position, self.output) = (position, output);
    }

    /// Stores the last step's position as a turning point behind `depth` others.
    #[inline(always)]
    fn push(&mut self, depth: usize) -> TurningPoint<R> {
        let point = TurningPoint { position: !self.position, output: !self.output };
        if depth == 0 {
            // The demagnetised past is its mirror.
            self.turning_points[0] = point;
        }
        let place = if depth >= MEMORY { MEMORY - 2 } else { depth.max(1) };
        self.turning_points[place] = point;
        self.depth = place as u32 + 1;
        point
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

/// A condition of a cheaper path, which is not the one to fall through.
#[inline(always)]
fn seldom(condition: bool) -> bool {
    if condition {
        cheaper();
        true
    } else {
        false
    }
}
