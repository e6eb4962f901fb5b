//! Setpoints from a target that an operator moves: the joint follows it in smooth moves from rest to rest.
//!
//! The moves are those of [`strainwave::trajectory`], within [`LIMITS`]. The idle loop plans them ([`Planner`]), which takes thousands of
//! cycles; the control interrupt goes through them ([`Jog`]). A target that moves during a move is taken up when that has ended. Angles of
//! the output, from the origin (rad).

use core::cell::RefCell;
use critical_section::Mutex;
use strainwave::compensator::Setpoint;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::trajectory::{Move, MoveState, Trajectory, TrajectoryParams};
use strainwave::{Angle, Error};

/// Limits of a move: those of a hand that shows the way, full speed after 0.4 s.
pub const LIMITS: TrajectoryParams<f32> =
    TrajectoryParams { velocity: 0.5, acceleration: 2.0, jerk: 20.0, snap: 400.0 };

/// Farthest target either way (rad).
pub const FARTHEST: f32 = 1.5;

/// What the joint holds or goes through: the control interrupt's end.
pub struct Jog(Mutex<RefCell<Place>>);

struct Place {
    /// Where it rests, or rested last; absent until it holds.
    here: Option<Angle<f32>>,
    /// The move that is under way.
    way: Option<(Move<f32>, MoveState)>,
}

impl Jog {
    /// Holds nothing yet.
    #[expect(clippy::new_without_default, reason = "only ever a static")]
    pub const fn new() -> Self {
        Self(Mutex::new(RefCell::new(Place { here: None, way: None })))
    }

    /// Holds an angle, from which moves then begin.
    pub fn hold(&self, angle: Angle<f32>) {
        self.with(|place| place.here = Some(angle));
    }

    /// Holds nothing, and ends the move that is under way.
    pub fn forget(&self) {
        self.with(|place| (place.here, place.way) = (None, None));
    }

    /// The setpoint of the next period; `None` while nothing is held.
    pub fn step(&self) -> Option<Setpoint<f32>> {
        self.with(Place::step).flatten()
    }

    /// Where it rests.
    fn rest(&self) -> Option<Angle<f32>> {
        self.with(|place| place.here.filter(|_| place.way.is_none())).flatten()
    }

    fn set_out(&self, way: &Move<f32>) {
        self.with(|place| place.way = Some((*way, MoveState::default())));
    }

    fn with<T>(&self, action: impl FnOnce(&mut Place) -> T) -> Option<T> {
        critical_section::with(|section| {
            // Not `borrow_mut`: it could panic. It is never borrowed twice, as nothing nests in `action`.
            self.0.borrow(section).try_borrow_mut().ok().map(|mut place| action(&mut place))
        })
    }
}

impl Place {
    fn step(&mut self) -> Option<Setpoint<f32>> {
        let Some((way, state)) = &mut self.way else {
            return self.here.map(|position| Setpoint { position, ..Setpoint::default() });
        };
        let setpoint = way.step(state);
        if way.done(state) {
            (self.here, self.way) = (Some(way.end()), None);
        }
        Some(setpoint)
    }
}

/// The idle loop's end.
pub struct Planner {
    jog: &'static Jog,
    trajectory: Trajectory<f32>,
    /// Where the joint held first.
    origin: Option<Angle<f32>>,
    target: f32,
}

impl Planner {
    /// For the moves of a jog.
    ///
    /// # Errors
    /// As [`TrajectoryParams::build`].
    pub fn new(jog: &'static Jog) -> Result<Self, Error> {
        Ok(Self { jog, trajectory: LIMITS.build(CONTROL_PERIOD as f32)?, origin: None, target: 0.0 })
    }

    /// Plans the move to a new `target` [rad from the origin] once the joint rests; NaN is no target.
    pub fn plan(&mut self, target: f32) {
        let Some(rest) = self.jog.rest() else { return };
        let origin = *self.origin.get_or_insert(rest);
        if (target - self.target).abs() > 0.0 {
            self.target = target;
            let end = origin.plus(target.clamp(-FARTHEST, FARTHEST));
            // None where there is no way there.
            if let Ok(way) = self.trajectory.plan(rest, end) {
                self.jog.set_out(&way);
            }
        }
    }
}
