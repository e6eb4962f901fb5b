//! The four widths of a move in control periods.

use crate::real::Real;
use crate::trajectory::TrajectoryParams;

/// Widest, in control periods: whole numbers are exact in f32 up to here.
const WIDEST: u32 = 1 << 24;

/// Widths of the four averages, in control periods.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Widths {
    /// T_s/dt: how long snap is held.
    pub snap: u32,
    /// T_j/dt: from one start of a jerk to the start of its end.
    pub jerk: u32,
    /// T_a/dt.
    pub acceleration: u32,
    /// T_v/dt.
    pub velocity: u32,
}

impl Widths {
    /// The narrowest that cover `distance` (rad, >= 0) within the limits; `None` when one exceeds [`WIDEST`].
    ///
    /// Each width ends where the next level's limit is reached, or where the profile without the outer
    /// stretches covers the distance.
    pub fn shortest<R: Real>(limits: &TrajectoryParams<R>, distance: R, dt: R) -> Option<Self> {
        let two = R::lit(2.0);
        let TrajectoryParams { velocity, acceleration, jerk, snap } = *limits;
        let end = |a: R, v: R, d: R| a >= acceleration || v >= velocity || d >= distance;
        let n_s = least(1, dt, |t| {
            let (j, a) = (snap * t, snap * t * t);
            j >= jerk || end(a, two * a * t, R::lit(8.0) * a * t * t)
        })?;
        let t_s = time(n_s, dt);
        let jerk = jerk.min(snap * t_s);
        let n_j = least(n_s, dt, |t| {
            let (a, rise) = (jerk * t, t + t_s);
            end(a, a * rise, two * a * rise * rise)
        })?;
        let acceleration = acceleration.min(jerk * time(n_j, dt));
        let rise = time(n_j + n_s, dt);
        let n_a = least(n_j + n_s, dt, |t| {
            let v = acceleration * t;
            v >= velocity || v * (t + rise) >= distance
        })?;
        let velocity = velocity.min(acceleration * time(n_a, dt));
        let n_v = least(n_a + n_j + n_s, dt, |t| velocity * t >= distance)?;
        Some(Self { snap: n_s, jerk: n_j, acceleration: n_a, velocity: n_v })
    }

    /// Widths of a move that is stopped at `elapsed`: a stretch that has begun ends there, later ones are left out.
    pub fn until(&self, elapsed: u32) -> Self {
        let snap = self.snap.min(elapsed);
        let jerk = self.jerk.min(elapsed.max(snap));
        let acceleration = self.acceleration.min(elapsed.max(jerk + snap));
        let velocity = self.velocity.min(elapsed.max(acceleration + jerk + snap));
        Self { snap, jerk, acceleration, velocity }
    }

    /// From rest to the highest speed.
    pub fn ramp(&self) -> u32 {
        self.acceleration + self.jerk + self.snap
    }

    /// At the highest speed.
    pub fn full_speed(&self) -> u32 {
        self.velocity - self.ramp()
    }

    /// The whole move.
    pub fn total(&self) -> u32 {
        self.velocity + self.ramp()
    }

    /// The first corner of each segment of the ramp.
    pub fn corners(&self) -> [u32; 7] {
        let Self { snap, jerk, acceleration, .. } = *self;
        [0, snap, jerk, jerk + snap, acceleration, acceleration + snap, acceleration + jerk]
    }
}

/// A number of control periods (s).
pub(super) fn time<R: Real>(periods: u32, dt: R) -> R {
    R::from_i32(periods.cast_signed()) * dt
}

/// The least number of periods from `from` on whose time is `enough`, which no longer time ceases to be.
fn least<R: Real>(from: u32, dt: R, enough: impl Fn(R) -> bool) -> Option<u32> {
    let (mut below, mut found) = (from, WIDEST);
    if from > WIDEST || !enough(time(WIDEST, dt)) {
        return None;
    }
    while below < found {
        let middle = below + (found - below) / 2;
        if enough(time(middle, dt)) {
            found = middle;
        } else {
            below = middle + 1;
        }
    }
    Some(found)
}
