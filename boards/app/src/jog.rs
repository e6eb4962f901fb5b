//! Setpoints from a target that an operator moves: the joint follows it in smooth moves from rest to rest.
//!
//! The moves are those of [`strainwave::trajectory`], within [`LIMITS`]. A target that moves during a move is taken
//! up when that has ended. Angles of the output, from the origin (rad).

use strainwave::Angle;
use strainwave::compensator::Setpoint;
pub use strainwave::trajectory::Trajectory;
use strainwave::trajectory::{Move, MoveState, TrajectoryParams};

/// Limits of a move: those of a hand that shows the way, full speed after 0.4 s.
pub const LIMITS: TrajectoryParams<f32> =
    TrajectoryParams { velocity: 0.5, acceleration: 2.0, jerk: 20.0, snap: 400.0 };

/// Farthest target either way (rad).
pub const FARTHEST: f32 = 1.5;

/// The move that is under way, or was last.
#[derive(Clone, Copy, Debug)]
pub struct Jog {
    trajectory: Trajectory<f32>,
    origin: Angle<f32>,
    planned: Move<f32>,
    state: MoveState,
    target: f32,
}

impl Jog {
    /// At rest at `origin`, with moves as `trajectory` plans them.
    pub fn at(trajectory: Trajectory<f32>, origin: Angle<f32>) -> Self {
        let planned = trajectory.rest(origin);
        Self { trajectory, origin, planned, state: MoveState::default(), target: 0.0 }
    }

    /// The setpoint of the next period, on the way to `target` [rad from the origin]; NaN is no target.
    pub fn step(&mut self, target: f32) -> Setpoint<f32> {
        if self.planned.done(&self.state) && (target - self.target).abs() > 0.0 {
            self.set_out(target);
        }
        self.planned.step(&mut self.state)
    }

    /// Starts the next move where the last one ended, unless there is no way there.
    fn set_out(&mut self, target: f32) {
        self.target = target;
        let end = self.origin.plus(target.clamp(-FARTHEST, FARTHEST));
        if let Ok(planned) = self.trajectory.plan(self.planned.end(), end) {
            (self.planned, self.state) = (planned, MoveState::default());
        }
    }
}
