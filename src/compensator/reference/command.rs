//! Commands of the outer controller: position, velocity or torque of the output, changed at run time.
//!
//! ```text
//! position   q, dq, .. as commanded
//! velocity   v <- v + limit(v_c - v, a_max*dt),  q <- q + v*dt,  ddq = a_c      from the present reference on
//! torque     q, dq as estimated, ddq = 0;  tau_m = tau_ff + (r + s_e*de/dtheta)*tau_c,  no feedback
//! ```
//!
//! tau_c is the torque that the joint gives at its output flange, tau_t less the output's friction. The feed-forward,
//! which follows the estimated motion, adds the friction of both sides times its gain, s_e is the gain of the kinematic
//! error. Units: rad, N m, s; signs as in [`crate::gear`]. Velocity is integrated once per round dt.
//!
//! There is always a reference: before the first command, and after a torque command, it is the output's angle. A
//! setpoint that the joint can follow passes unchanged. With x the setpoint less the extrapolated last reference, and
//! s <- (1 - dt/T_s)*s + x, the joint cannot follow it when
//!
//! ```text
//! |s| > tau_max/(4*k_p*k_v*|n|)   or   |dq - dq_foreseen| > tau_max/(4*k_v*|n|) + a_max*dt
//! a_max = 0.6*min(tau_p/J_fs, tau_max*|n|/(n^2*J_wg + J_fs))
//! ```
//!
//! (dq_foreseen: the extrapolated speed), for that is a step that would take a quarter of the motor's torque. Then the
//! reference approaches it within the joint's speed (95 %), a_max and a jerk of a_max in 5 ms, until it reaches it:
//!
//! ```text
//! v = dq + limit(min(k*|e|, sqrt(a_max*|e|)))*sign(e),   ddq -> limit(ddq_c + 4*k*(v - dq), a_max),   k = 25/s
//! ```
//!
//! A first setpoint away from the output is not approached: the two controllers may disagree on the zero. The reference
//! stays at the initial angle of the output, with a fault, until the setpoint comes there.
//!
//! A setpoint that is older than [`STALE`] is not followed: the reference brakes to rest within the same limits, a torque
//! command becomes 0. One with a value that is not finite is replaced by the reference extrapolated at its acceleration,
//! for the same time. The motor's torque at a switch of the kind of command is ramped by
//! [`crate::compensator::actuate::fallback`].

use crate::angle::Angle;
use crate::compensator::actuate::cascade::FeedbackParams;
use crate::compensator::{Estimate, Faults, Limits, Setpoint};
use crate::error::Error;
use crate::gear::GearParams;
use crate::real::{RADIANS_PER_COUNT, Real};

/// Age at which a setpoint is stale (s): twenty periods of an outer controller of 1 kHz.
pub const STALE: f64 = 0.02;
/// T_s (s).
const SLIP_TIME: f64 = 0.02;
/// k (1/s).
const APPROACH_RATE: f64 = 25.0;
/// Time from no acceleration to a_max (s).
const JERK_TIME: f64 = 0.005;
/// Speed below which a braked reference rests (rad/s).
const REST: f64 = 1e-4;

/// Command of the outer controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command<R> {
    /// Position of the output, with its derivatives.
    Position(Setpoint<R>),
    /// Velocity of the output, integrated from the present reference on.
    Velocity {
        /// (rad/s)
        velocity: R,
        /// (rad/s^2)
        acceleration: R,
    },
    /// Torque of the joint at the output flange (N m).
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

/// The built generator of the output's reference from a command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Commander<R> {
    dt: R,
    inverse_dt: R,
    /// a_max (rad/s^2), and a_max*dt (rad/s).
    acceleration: R,
    velocity_step: R,
    /// Largest change of an approach's acceleration in dt (rad/s^2).
    acceleration_step: R,
    velocity: R,
    /// Bounds of s (rad) and of the speed's difference (rad/s) within which a setpoint passes unchanged.
    near: R,
    near_velocity: R,
    /// 1 - dt/T_s.
    keep: R,
    /// Farthest step of a position (counts).
    farthest: u64,
}

/// The last reference, and what it came from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CommanderState<R> {
    reference: Option<Setpoint<R>>,
    kind: Kind,
    /// s (rad).
    slip: R,
    approaches: bool,
    /// The first setpoint has not come near the output yet.
    waits: bool,
    /// Time without a readable command (s).
    unreadable: R,
}

/// Which kind a command is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Kind {
    #[default]
    Position,
    Velocity,
    Torque,
}

/// Age and validity of a command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CommandStatus<R> {
    /// Its age (s).
    pub age: R,
    /// All of its values are finite.
    pub readable: bool,
}

/// Target of the stages after it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Target<R> {
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
    /// For commands that are read every dt (s), of a joint with this cascade.
    ///
    /// # Errors
    /// As [`Limits::check`].
    pub fn build(
        gear: &GearParams<R>,
        limits: &Limits<R>,
        cascade: &FeedbackParams<R>,
        dt: R,
    ) -> Result<Self, Error> {
        limits.check()?;
        let n = R::from_i32(gear.ratio).abs();
        let whole = n * n * gear.wave_generator_inertia + gear.flexspline_inertia;
        let by_gear = limits.output_torque / gear.flexspline_inertia;
        let acceleration = R::lit(0.6) * by_gear.min(limits.motor_torque * n / whole);
        let quarter = R::lit(0.25) * limits.motor_torque / (cascade.velocity_gain * n);
        // Twice the top speed, and what the rounding of a setpoint in f32 may add.
        let counts = R::lit(2.0 / RADIANS_PER_COUNT) * limits.output_speed(gear.ratio) * dt;
        Ok(Self {
            dt,
            inverse_dt: R::ONE / dt,
            acceleration,
            velocity_step: acceleration * dt,
            acceleration_step: acceleration * dt * R::lit(1.0 / JERK_TIME),
            velocity: limits.setpoint_speed(gear.ratio),
            near: quarter / cascade.position_gain,
            near_velocity: quarter + acceleration * dt,
            keep: (R::ONE - dt * R::lit(1.0 / SLIP_TIME)).max(R::ZERO),
            farthest: u64::from(counts.to_i32().unsigned_abs()) + 256,
        })
    }

    /// The reference for a command that the guard let through.
    #[inline]
    pub fn step(
        &self,
        state: &mut CommanderState<R>,
        command: &Command<R>,
        CommandStatus { age, readable }: CommandStatus<R>,
        estimate: impl FnOnce() -> Estimate<R>,
        faults: &mut Faults,
    ) -> Target<R> {
        state.unreadable = if readable { R::ZERO } else { (state.unreadable + self.dt).min(R::ONE) };
        // An age that is not a number is stale.
        let fresh = age <= R::lit(STALE) && state.unreadable <= R::lit(STALE);
        let stale = !fresh;
        faults.raise_if(stale, Faults::SETPOINT_STALE);
        let (kind, setpoint, torque) = match *command {
            Command::Position(setpoint) => {
                let from = state.reference.unwrap_or_else(|| {
                    state.waits = true;
                    at_rest(&estimate())
                });
                let commanded = if readable { setpoint } else { self.extrapolated(&from) };
                (Kind::Position, self.positioned(state, from, commanded, stale, faults), None)
            }
            Command::Velocity { velocity, acceleration } => {
                let from = state.reference.unwrap_or_else(|| at_rest(&estimate()));
                let commanded = if stale { [R::ZERO; 2] } else { [velocity, acceleration] };
                (Kind::Velocity, self.integrated(from, commanded, faults), None)
            }
            Command::Torque(torque) => {
                let estimate = estimate();
                let setpoint = Setpoint { velocity: estimate.output_velocity, ..at_rest(&estimate) };
                (Kind::Torque, setpoint, Some(if stale { R::ZERO } else { torque }))
            }
        };
        let switched = state.reference.is_some() && state.kind != kind;
        (state.reference, state.kind) = (Some(setpoint), kind);
        Target { setpoint, torque, switched }
    }

    /// The reference extrapolated by a round.
    #[cold]
    fn extrapolated(&self, from: &Setpoint<R>) -> Setpoint<R> {
        let change = self.dt * from.acceleration;
        let position = from.position.plus(self.dt * (from.velocity + R::lit(0.5) * change));
        let velocity = (from.velocity + change).limit(self.velocity);
        Setpoint { position, velocity, acceleration: from.acceleration, ..Setpoint::default() }
    }

    #[inline(always)]
    fn positioned(
        &self,
        state: &mut CommanderState<R>,
        from: Setpoint<R>,
        commanded: Setpoint<R>,
        stale: bool,
        faults: &mut Faults,
    ) -> Setpoint<R> {
        let change = self.dt * from.acceleration;
        let step = self.dt * (from.velocity + R::lit(0.5) * change);
        state.slip = self.keep * state.slip + (commanded.position.minus(from.position) - step);
        let velocity_step = commanded.velocity - from.velocity - change;
        let near = state.slip.is_within(self.near) && velocity_step.is_within(self.near_velocity);
        if near && !state.approaches && !stale {
            state.waits = false;
            return commanded;
        }
        self.approach(state, from, commanded, stale, faults)
    }

    #[cold]
    #[inline(never)]
    fn approach(
        &self,
        state: &mut CommanderState<R>,
        from: Setpoint<R>,
        commanded: Setpoint<R>,
        stale: bool,
        faults: &mut Faults,
    ) -> Setpoint<R> {
        if state.waits && !commanded.position.minus(from.position).is_within(self.near) {
            faults.raise_if(true, Faults::SETPOINT_STEP);
            state.slip = R::ZERO;
            return Setpoint { position: from.position, ..Setpoint::default() };
        }
        state.waits = false;
        let moved = commanded.position.counts.wrapping_sub(from.position.counts).unsigned_abs();
        faults.raise_if(!state.approaches && !stale && moved > self.farthest, Faults::SETPOINT_STEP);
        // A reference is extrapolated by its jerk until the next one.
        let jerked = self.dt * from.jerk;
        let present = (from.acceleration + jerked).limit(self.acceleration);
        let change = self.dt * (present - R::lit(0.5) * jerked);
        let position = from.position.plus(self.dt * (from.velocity + R::lit(0.5) * change));
        let velocity = (from.velocity + change).limit(self.velocity);
        let distance = commanded.position.minus(position);
        let difference = commanded.velocity - velocity;
        let together = distance.is_within(R::lit(0.125) * self.near)
            && difference.is_within(R::lit(0.25) * self.near_velocity);
        state.approaches = stale || !together;
        state.slip = R::ZERO;
        if !state.approaches {
            return commanded;
        }
        faults.raise_if(!stale, Faults::SETPOINT_LIMITED);
        let (target, along) = if stale {
            (R::ZERO, R::ZERO)
        } else {
            let room = distance.abs();
            let speed = (R::lit(APPROACH_RATE) * room).min((self.acceleration * room).sqrt_or_zero());
            ((commanded.velocity + speed.copysign(distance)).limit(self.velocity), commanded.acceleration)
        };
        if stale && velocity.is_within(R::lit(REST)) {
            return Setpoint { position, ..Setpoint::default() };
        }
        let target_acceleration =
            (along + R::lit(4.0 * APPROACH_RATE) * (target - velocity)).limit(self.acceleration);
        let change = (target_acceleration - present).limit(self.acceleration_step);
        Setpoint { position, velocity, acceleration: present, jerk: change * self.inverse_dt, snap: R::ZERO }
    }

    fn integrated(
        &self,
        from: Setpoint<R>,
        [velocity, acceleration]: [R; 2],
        faults: &mut Faults,
    ) -> Setpoint<R> {
        let change = velocity - from.velocity;
        let limited = change.limit(self.velocity_step);
        faults.raise_if(limited != change, Faults::SETPOINT_LIMITED);
        let velocity = from.velocity + limited;
        let position = from.position.plus(velocity * self.dt);
        Setpoint { position, velocity, acceleration, ..Setpoint::default() }
    }
}

/// At rest at the output's angle.
fn at_rest<R: Real>(estimate: &Estimate<R>) -> Setpoint<R> {
    Setpoint { position: estimate.output_position, ..Setpoint::default() }
}
