//! From rest to the highest speed: seven segments of constant snap.

use crate::real::Real;
use crate::trajectory::widths::{Widths, time};

/// Sign of the snap in each segment.
const SIGNS: [i32; 7] = [1, 0, -1, 0, -1, 0, 1];

/// Path and its derivatives (rad, s).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct ProfilePoint<R> {
    pub path: R,
    pub velocity: R,
    pub acceleration: R,
    pub jerk: R,
    pub snap: R,
}

impl<R: Real> ProfilePoint<R> {
    /// After a time t (s) of constant snap.
    #[inline(always)]
    fn after(&self, t: R) -> Self {
        let (half, third) = (R::lit(1.0 / 2.0) * t, R::lit(1.0 / 3.0) * t);
        let quarter = R::lit(0.5) * half;
        let Self { path, velocity, acceleration, jerk, snap } = *self;
        Self {
            path: path + t * (velocity + half * (acceleration + third * (jerk + quarter * snap))),
            velocity: velocity + t * (acceleration + half * (jerk + third * snap)),
            acceleration: acceleration + t * (jerk + half * snap),
            jerk: jerk + t * snap,
            snap,
        }
    }
}

/// The built ramp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ramp<R> {
    /// First period of each segment.
    starts: [u32; 7],
    /// At these.
    corners: [ProfilePoint<R>; 7],
    dt: R,
}

impl<R: Real> Ramp<R> {
    /// The ramp of these widths with the snap's level (rad/s^4), and path (rad) and speed (rad/s) at its end.
    pub fn build(widths: &Widths, snap: R, dt: R) -> (Self, R, R) {
        let starts = widths.corners();
        let mut corners = [ProfilePoint::default(); 7];
        let mut point = ProfilePoint::default();
        let ends = starts.iter().skip(1).copied().chain([widths.ramp()]);
        for (((corner, sign), start), end) in corners.iter_mut().zip(SIGNS).zip(starts).zip(ends) {
            point.snap = snap * R::from_i32(sign);
            *corner = point;
            point = point.after(time(end - start, dt));
        }
        (Self { starts, corners, dt }, point.path, point.velocity)
    }

    /// At the start of period `now`, by the segment that `period` lies in.
    #[inline]
    pub fn at(&self, now: u32, period: u32) -> ProfilePoint<R> {
        let mut found = (0, &self.corners[0]);
        for (&start, corner) in self.starts.iter().zip(&self.corners) {
            if start <= period {
                found = (start, corner);
            }
        }
        found.1.after(time(now - found.0, self.dt))
    }
}
