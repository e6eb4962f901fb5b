//! What the outer controller commands: position, velocity or torque of the output, changed at run time.
//!
//! ```text
//! position   q, dq, .. as commanded
//! velocity   v <- v + limit(v_c - v, a_max*dt),  q <- q + v*dt,  ddq = a_c      from the present reference on
//! torque     q, dq as estimated, ddq = 0;  tau_m = tau_ff + (r + s_e*de/dtheta)*tau_c,  no feedback
//! ```
//!
//! tau_c is the torque that the joint gives at its output flange, tau_t less the output's friction. The feed-forward,
//! which follows the estimated motion, adds the shares of the friction on both sides, s_e is the share of the
//! kinematic error. Units: rad, N m, s; signs as in [`crate::gear`]. Velocity is integrated once per round dt.
//!
//! A reference is always there to go on from: after a torque command it is where the output is. A position that is
//! farther from the last reference than the output can go in a period is a step, and reported. What a switch or a
//! step would do to the motor's torque is limited by [`crate::compensator::actuate::fallback`].

use crate::angle::Angle;
use crate::compensator::{Estimate, Faults, Limits, Setpoint};
use crate::error::Error;
use crate::real::{RADIANS_PER_COUNT, Real};

/// What the outer controller wants of the output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command<R> {
    /// Where it should be, with the derivatives of that.
    Position(Setpoint<R>),
    /// How fast it should turn, from where it is asked to be now.
    Velocity {
        /// (rad/s)
        velocity: R,
        /// (rad/s^2)
        acceleration: R,
    },
    /// Torque that the joint should give at the output flange (N m).
    Torque(R),
}

impl<R: Default> Default for Command<R> {
    fn default() -> Self {
        Self::Position(Setpoint::default())
    }
}

impl<R> From<Setpoint<R>> for Command<R> {
    fn from(setpoint: Setpoint<R>) -> Self {
        Self::Position(setpoint)
    }
}

/// From a command to a reference of the output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Commander<R> {
    dt: R,
    /// a_max*dt (rad/s).
    velocity_step: R,
    /// Farthest step of a position (counts).
    farthest: u64,
}

/// The last reference, and what it came from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CommanderState<R> {
    reference: Option<Setpoint<R>>,
    kind: Kind,
}

/// Which kind a command is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Kind {
    #[default]
    Position,
    Velocity,
    Torque,
}

/// What the stages after it follow.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Followed<R> {
    /// Reference of the output.
    pub setpoint: Setpoint<R>,
    /// Torque at the output flange, in place of the feedback (N m).
    pub torque: Option<R>,
    /// The last command was of another kind.
    pub switched: bool,
}

impl<R: Real> CommanderState<R> {
    /// Angle of the reference; the zero angle before the first.
    #[inline(always)]
    pub fn position(&self) -> Angle<R> {
        self.reference.map_or(Angle::default(), |reference| reference.position)
    }

    /// Speed of the reference (rad/s).
    pub fn velocity(&self) -> R {
        self.reference.map_or(R::ZERO, |reference| reference.velocity)
    }
}

impl<R: Real> Commander<R> {
    /// For commands that are read every dt (s), of a joint with this ratio 1/n, whose output reaches `acceleration`
    /// (rad/s^2).
    ///
    /// # Errors
    /// As [`Limits::check`].
    pub fn build(limits: &Limits<R>, n: i32, acceleration: R, dt: R) -> Result<Self, Error> {
        limits.check()?;
        // Twice the top speed, and what the rounding of a setpoint in f32 may add.
        let counts = R::lit(2.0 / RADIANS_PER_COUNT) * limits.output_speed(n) * dt;
        Ok(Self {
            dt,
            velocity_step: acceleration * dt,
            farthest: u64::from(counts.to_i32().unsigned_abs()) + 256,
        })
    }

    /// The reference for a command that the guard let through.
    #[inline]
    pub fn step(
        &self,
        state: &mut CommanderState<R>,
        command: &Command<R>,
        estimate: impl FnOnce() -> Estimate<R>,
        faults: &mut Faults,
    ) -> Followed<R> {
        let (kind, setpoint, torque) = match *command {
            Command::Position(setpoint) => (Kind::Position, self.positioned(state, setpoint, faults), None),
            Command::Velocity { velocity, acceleration } => {
                let from = state.reference.unwrap_or_else(|| at_rest(&estimate()));
                (Kind::Velocity, self.turned(from, velocity, acceleration, faults), None)
            }
            Command::Torque(torque) => {
                let estimate = estimate();
                let setpoint = Setpoint { velocity: estimate.output_velocity, ..at_rest(&estimate) };
                (Kind::Torque, setpoint, Some(torque))
            }
        };
        let switched = state.reference.is_some() && state.kind != kind;
        *state = CommanderState { reference: Some(setpoint), kind };
        Followed { setpoint, torque, switched }
    }

    fn positioned(
        &self,
        state: &CommanderState<R>,
        setpoint: Setpoint<R>,
        faults: &mut Faults,
    ) -> Setpoint<R> {
        let last = state.reference.unwrap_or(setpoint).position.counts;
        let moved = setpoint.position.counts.wrapping_sub(last).unsigned_abs();
        faults.raise_if(moved > self.farthest, Faults::SETPOINT_STEP);
        setpoint
    }

    fn turned(&self, from: Setpoint<R>, velocity: R, acceleration: R, faults: &mut Faults) -> Setpoint<R> {
        let change = velocity - from.velocity;
        let limited = change.limit(self.velocity_step);
        faults.raise_if(limited != change, Faults::SETPOINT_LIMITED);
        let velocity = from.velocity + limited;
        let position = from.position.plus(velocity * self.dt);
        Setpoint { position, velocity, acceleration, ..Setpoint::default() }
    }
}

/// At rest where the output is.
fn at_rest<R: Real>(estimate: &Estimate<R>) -> Setpoint<R> {
    Setpoint { position: estimate.output_position, ..Setpoint::default() }
}
