//! A planned move, and where it is.

use crate::angle::Angle;
use crate::compensator::Setpoint;
use crate::error::{Error, require};
use crate::real::Real;
use crate::trajectory::full_speed::FullSpeed;
use crate::trajectory::ramp::{ProfilePoint, Ramp};
use crate::trajectory::widths::{Widths, time};

/// A planned move from rest to rest.
///
/// No derivative passes its limit, every setpoint follows from the one before, and the last one is the target to the bit:
///
/// ```
/// use strainwave::Angle;
/// use strainwave::trajectory::{MoveState, TrajectoryParams};
///
/// let limits = TrajectoryParams { velocity: 2.0_f32, acceleration: 30.0, jerk: 1500.0, snap: 2e5 };
/// let (start, target) = (Angle::from_radians(0.1), Angle::from_radians(0.6));
/// let way = limits.build(1e-4)?.plan(start, target)?;
/// let (mut state, mut last) = (MoveState::default(), start);
/// while !way.done(&state) {
///     let setpoint = way.step(&mut state);
///     assert!(setpoint.velocity.abs() <= 2.0 && setpoint.acceleration.abs() <= 30.0);
///     assert!(setpoint.jerk.abs() <= 1500.0 && setpoint.snap.abs() <= 2e5);
///     assert!(setpoint.position.minus(last).abs() <= 2.0 * 1e-4 + 1e-6);
///     last = setpoint.position;
/// }
/// assert_eq!(way.step(&mut state).position, target);
/// assert!(way.periods() as f32 * 1e-4 < 0.4); // s
///
/// // Stopped in the middle it comes to rest within the same limits, short of the target.
/// let mut state = MoveState::default();
/// for _ in 0..1000 {
///     way.step(&mut state);
/// }
/// assert!(way.stop(&state).end().minus(start) < 0.5);
/// # Ok::<(), strainwave::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move<R> {
    start: Angle<R>,
    end: Angle<R>,
    pub(super) widths: Widths,
    /// Level of the snap (rad/s^4).
    snap: R,
    ramp: Ramp<R>,
    full_speed: FullSpeed<R>,
    /// Highest speed (rad/s).
    velocity: R,
    dt: R,
}

/// Distance of a move.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MoveState {
    pub(super) elapsed: u32,
}

impl<R: Real> Move<R> {
    /// Rest at an angle.
    pub(super) fn rest(at: Angle<R>, dt: R) -> Self {
        let widths = Widths::default();
        let (ramp, _, velocity) = Ramp::build(&widths, R::ZERO, dt);
        let full_speed = FullSpeed::between(at, at, 0);
        Self { start: at, end: at, widths, snap: R::ZERO, ramp, full_speed, velocity, dt }
    }

    /// From `start` to `end` in these widths, none of which is zero.
    pub(super) fn over(start: Angle<R>, end: Angle<R>, widths: Widths, dt: R) -> Result<Self, Error> {
        let level = |of: R, periods| of / time(periods, dt);
        let velocity = level(end.minus(start), widths.velocity);
        let snap = level(level(level(velocity, widths.acceleration), widths.jerk), widths.snap);
        let (ramp, path, velocity) = Ramp::build(&widths, snap, dt);
        require(path.abs() <= R::lit(core::f64::consts::PI), "distance")?;
        let full_speed = FullSpeed::between(start.plus(path), end.plus(-path), widths.full_speed());
        Ok(Self { start, end, widths, snap, ramp, full_speed, velocity, dt })
    }

    /// The setpoint of the next control period: the first is the start, and at the end it stays.
    #[inline]
    pub fn step(&self, state: &mut MoveState) -> Setpoint<R> {
        let setpoint = self.at(state.elapsed);
        state.elapsed = (state.elapsed + 1).min(self.periods());
        setpoint
    }

    /// The setpoint after this number of control periods.
    #[inline]
    pub fn at(&self, elapsed: u32) -> Setpoint<R> {
        let (ramp, left) = (self.widths.ramp(), self.periods().saturating_sub(elapsed));
        if left == 0 {
            Setpoint { position: self.end, ..Setpoint::default() }
        } else if elapsed < ramp {
            setpoint(self.start, &self.ramp.at(elapsed, elapsed))
        } else if left > ramp {
            let position = self.full_speed.at(elapsed - ramp);
            Setpoint { position, velocity: self.velocity, ..Setpoint::default() }
        } else {
            setpoint(self.end, &mirrored(&self.ramp.at(left, left - 1)))
        }
    }

    /// The same move, but at rest as soon as the limits allow from where it is; the state goes on with it.
    #[must_use]
    pub fn stop(&self, state: &MoveState) -> Self {
        let widths = self.widths.until(state.elapsed);
        if widths == self.widths {
            return *self;
        }
        let (ramp, path, velocity) = Ramp::build(&widths, self.snap, self.dt);
        let full_speed = self.full_speed.from(self.start.plus(path));
        let end = full_speed.at(widths.full_speed()).plus(path);
        Self { end, widths, ramp, full_speed, velocity, ..*self }
    }

    /// Its length (control periods).
    pub fn periods(&self) -> u32 {
        self.widths.total()
    }

    /// Angle at its end.
    pub fn end(&self) -> Angle<R> {
        self.end
    }

    /// It is at rest where it ends.
    pub fn done(&self, state: &MoveState) -> bool {
        state.elapsed >= self.periods()
    }
}

fn setpoint<R: Real>(origin: Angle<R>, point: &ProfilePoint<R>) -> Setpoint<R> {
    let ProfilePoint { path, velocity, acceleration, jerk, snap } = *point;
    Setpoint { position: origin.plus(path), velocity, acceleration, jerk, snap }
}

/// With time and path reversed.
fn mirrored<R: Real>(point: &ProfilePoint<R>) -> ProfilePoint<R> {
    ProfilePoint { path: -point.path, acceleration: -point.acceleration, snap: -point.snap, ..*point }
}
