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
//! error. Units: rad, N m, s; signs as in [`crate::gear`]. Velocity is integrated once per round, over the
//! time dt that it took by the clock ([`crate::compensator::sense::clock`]).
//!
//! There is always a reference: before the first command, and after a torque command, it is the output's angle. A
//! setpoint that the joint can follow passes unchanged; any other is approached (`approach.rs`), from the round after that in which
//! the reference begins.
//!
//! A setpoint that was followed can still ask for more than a loaded joint can give. While the torque is limited and the
//! motor is further from its reference than 2*tau_max/(k_p^2*(J_wg + J_fs/n^2)) + |n*dq|/k_p, half of the fault "following
//! error" ([`crate::compensator::sense::rotor`]) and what a cascade without feed-forward lags, the joint has lost its
//! reference: that goes on from the estimated motion of the output and approaches the setpoint from there, unless the
//! model is not trusted ([`crate::compensator::actuate::fallback`]). The output must move at more than half of the
//! reference's speed: one that is held against its reference, or falls, stays lost, up to the fault.
//!
//! A first setpoint away from the output is not approached: the two controllers may disagree on the zero. The reference
//! stays at the initial angle of the output, with a fault, until the setpoint comes there.
//!
//! A setpoint that is older than [`SETTLED_TIME`] is not followed: the reference brakes to rest within the same limits, a torque
//! command becomes 0. One with a value that is not finite is replaced by the reference extrapolated at its acceleration,
//! for the same time. The motor's torque at a switch of the kind of command is ramped by
//! [`crate::compensator::actuate::fallback`].

use crate::angle::Angle;
use crate::branch::seldom;
use crate::compensator::actuate::cascade::FeedbackParams;
use crate::compensator::actuate::protection::Protection;
use crate::compensator::reference::approach::{Approach, Moment};
use crate::compensator::tuned::{SETTLED_TIME, UNCERTAINTY_MARGIN};
use crate::compensator::{Faults, Limits, Setpoint};
use crate::constants::constants;
use crate::error::Error;
use crate::gear::GearParams;
use crate::real::{RADIANS_PER_COUNT, Real};

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
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Commander<R> {
    approach: Approach<R>,
    /// 2*tau_max/(k_p^2*(J_wg + J_fs/n^2)) (rad), and |n|/k_p (s).
    lost: R,
    lag: R,
    /// Farthest step of a position (counts).
    farthest: u32,
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
    /// Time since the last one was read (s).
    pub time: R,
    /// Its age (s).
    pub age: R,
    /// All of its values are finite.
    pub readable: bool,
}

/// How the joint follows the last reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Following<R> {
    /// Position error of the motor (rad).
    pub error: R,
    /// The torque is limited, of a motor whose position is controlled.
    pub limited: bool,
    /// Estimated speed of the output (rad/s).
    pub velocity: R,
    /// Estimated external torque on it (N m).
    pub load: R,
}

/// Target of the stages after it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Target<R> {
    /// Reference of the output.
    pub setpoint: Setpoint<R>,
    /// Torque at the output flange, in place of the feedback (N m).
    pub torque: Option<R>,
    /// The last command was of another kind, or the reference went on from the output.
    pub switched: bool,
    /// The reference did not simply follow its command: it begins, approaches it, or goes on without it, which takes longer. Without a
    /// torque.
    pub detours: bool,
}

/// The present reference as a target, found in an earlier period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found<R> {
    /// When (s).
    pub time: R,
    /// [`Target::switched`].
    pub switched: bool,
}

impl<R: Real> CommanderState<R> {
    /// Angle of the reference; the zero angle before the first.
    #[inline(always)]
    pub fn position(&self) -> Angle<R> {
        self.reference.map_or(Angle::default(), |reference| reference.position)
    }

    /// The target that was found in an earlier period, at `time` (s): its reference goes on at its acceleration.
    #[inline(always)]
    pub fn target_after(&self, found: Found<R>, time: R) -> Target<R> {
        let mut setpoint = self.reference.unwrap_or_default();
        let late = time - found.time;
        setpoint.position = setpoint.position.plus(late * setpoint.velocity);
        setpoint.velocity += late * setpoint.acceleration;
        Target { setpoint, torque: None, switched: found.switched, detours: false }
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
        protection: &Protection<R>,
        dt: R,
    ) -> Result<Self, Error> {
        limits.check()?;
        let n = R::from_i32(gear.ratio).abs();
        let whole = n * n * gear.wave_generator_inertia + gear.flexspline_inertia;
        // Twice the top speed, and what the rounding of a setpoint in f32 may add.
        let counts = R::lit(2.0 / RADIANS_PER_COUNT) * limits.output_speed(gear.ratio) * dt;
        Ok(Self {
            approach: Approach::build(gear, limits, cascade, protection, dt),
            lost: R::lit(UNCERTAINTY_MARGIN.get()) * n * n * limits.motor_torque
                / (whole * cascade.position_gain * cascade.position_gain),
            lag: n / cascade.position_gain,
            farthest: counts.to_i32().unsigned_abs() + 256,
        })
    }

    /// Acceleration with which a setpoint is approached (rad/s^2).
    pub fn acceleration(&self) -> R {
        self.approach.acceleration()
    }

    /// Top speed of the reference (rad/s).
    pub fn speed(&self) -> R {
        self.approach.speed()
    }

    /// The reference for a command that the guard let through; `output` gives the estimated angle and speed (rad/s) of the output.
    #[inline]
    pub fn step(
        &self,
        state: &mut CommanderState<R>,
        command: &Command<R>,
        CommandStatus { time, age, readable }: CommandStatus<R>,
        following: Following<R>,
        output: impl Fn() -> (Angle<R>, R),
        faults: &mut Faults,
    ) -> Target<R> {
        let lost = following.limited
            && !following.error.is_within(self.lost + self.lag * state.velocity().abs())
            && moves_with(following.velocity, state.velocity());
        let begins = lost || state.reference.is_none();
        let mut detours = begins;
        let reached = || Setpoint { velocity: following.velocity, ..at_rest(output().0) };
        if lost {
            seldom();
            (state.reference, state.approaches) = (Some(reached()), true);
        }
        state.unreadable = if readable { R::ZERO } else { (state.unreadable + time).min(R::ONE) };
        // An age that is not a number is stale.
        let longest = R::lit(SETTLED_TIME.get());
        let fresh = age <= longest && state.unreadable <= longest;
        let stale = !fresh;
        faults.raise_if(stale, Faults::SETPOINT_STALE);
        let (kind, setpoint, torque) = match *command {
            Command::Position(setpoint) => {
                // No setpoint is handed on by reference here: that alone would write it to memory in every round.
                let from = state.reference.unwrap_or_else(|| {
                    seldom();
                    state.waits = true;
                    reached()
                });
                let commanded = if readable {
                    setpoint
                } else {
                    seldom();
                    detours = true;
                    self.approach.extrapolated(from, time)
                };
                let moment = Moment { time, stale, load: following.load };
                let next = self.followed(state, from, commanded, moment).unwrap_or_else(|| {
                    seldom();
                    detours = true;
                    if begins {
                        // That takes the whole of this period: the command is approached from the next round on.
                        state.slip = R::ZERO;
                        return from;
                    }
                    self.approached(state, from, &commanded, moment, faults)
                });
                (Kind::Position, next, None)
            }
            Command::Velocity { velocity, acceleration } => {
                let from = state.reference.unwrap_or_else(reached);
                let commanded = if stale { [R::ZERO; 2] } else { [velocity, acceleration] };
                (Kind::Velocity, self.integrated(from, commanded, time, faults), None)
            }
            Command::Torque(torque) => {
                let (position, velocity) = output();
                let setpoint = Setpoint { velocity, ..at_rest(position) };
                detours = false;
                (Kind::Torque, setpoint, Some(if stale { R::ZERO } else { torque }))
            }
        };
        let switched = lost || state.reference.is_some() && state.kind != kind;
        detours |= switched && kind != Kind::Torque;
        (state.reference, state.kind) = (Some(setpoint), kind);
        Target { setpoint, torque, switched, detours }
    }

    /// The commanded setpoint, where the joint can follow it.
    #[inline(always)]
    fn followed(
        &self,
        state: &mut CommanderState<R>,
        from: Setpoint<R>,
        commanded: Setpoint<R>,
        moment: Moment<R>,
    ) -> Option<Setpoint<R>> {
        let follows = self.approach.can_follow(&mut state.slip, &from, &commanded, moment.time);
        let follows = follows && !state.approaches && !moment.stale;
        if follows {
            state.waits = false;
        }
        follows.then_some(commanded)
    }

    #[cold]
    #[inline(never)]
    fn approached(
        &self,
        state: &mut CommanderState<R>,
        from: Setpoint<R>,
        commanded: &Setpoint<R>,
        moment: Moment<R>,
        faults: &mut Faults,
    ) -> Setpoint<R> {
        state.slip = R::ZERO;
        if state.waits && !self.approach.is_near(commanded.position.minus(from.position)) {
            // A joint that moves when its control begins, elsewhere than commanded: most likely the controller has started again,
            // and the encoders do not tell in which revolution the motor is.
            faults.raise_if(!self.approach.stops_near(from.velocity), Faults::RESTARTED);
            faults.raise_if(true, Faults::SETPOINT_STEP);
            return at_rest(from.position);
        }
        state.waits = false;
        let moved = commanded.position.counts.wrapping_sub(from.position.counts).unsigned_abs();
        let stepped = moved > u64::from(self.farthest);
        faults.raise_if(!state.approaches && !moment.stale && stepped, Faults::SETPOINT_STEP);
        let next = self.approach.step(&from, commanded, &moment);
        state.approaches = next.is_some();
        faults.raise_if(state.approaches && !moment.stale, Faults::SETPOINT_LIMITED);
        next.unwrap_or(*commanded)
    }

    fn integrated(
        &self,
        from: Setpoint<R>,
        [velocity, acceleration]: [R; 2],
        time: R,
        faults: &mut Faults,
    ) -> Setpoint<R> {
        let change = velocity - from.velocity;
        let limited = change.limit(self.approach.acceleration() * time);
        faults.raise_if(limited != change, Faults::SETPOINT_LIMITED);
        let velocity = from.velocity + limited;
        let position = from.position.plus(velocity * time);
        Setpoint { position, velocity, acceleration, ..Setpoint::default() }
    }
}

/// The reference moves, and the output at more than half of its speed (rad/s).
fn moves_with<R: Real>(output: R, reference: R) -> bool {
    reference * (output - R::lit(0.5) * reference) > R::ZERO
}

/// At rest at an angle.
fn at_rest<R: Real>(position: Angle<R>) -> Setpoint<R> {
    Setpoint { position, ..Setpoint::default() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensator::reference::approach::tests::{ROUND, joint};
    use crate::compensator::schedule::CONTROL_PERIOD;

    const GOOD: Following<f64> = Following { error: 0.0, limited: false, velocity: 0.0, load: 0.0 };

    fn commander() -> Commander<f64> {
        let (gear, limits, cascade, protection) = joint();
        Commander::build(&gear, &limits, &cascade, &protection, ROUND).unwrap()
    }

    fn moving(position: f64, velocity: f64) -> Command<f64> {
        let position = Angle::from_radians_f64(position);
        Setpoint { position, velocity, ..Setpoint::default() }.into()
    }

    /// Faults of a setpoint at 4 rad/s, every seventh of whose rounds takes two control periods more, by a clock that tells
    /// it or not.
    fn faults(told: bool) -> Faults {
        let (commander, mut state, mut faults) = (commander(), CommanderState::default(), Faults::NONE);
        let mut now = 0.0;
        for k in 0..200 {
            let time = if k % 7 == 6 { ROUND + 2.0 * CONTROL_PERIOD } else { ROUND };
            now += time;
            // 4 rad/s after 0.1 s.
            let accelerated = now.min(0.1);
            let position = 20.0 * accelerated * accelerated + 4.0 * (now - accelerated);
            let acceleration = if now < 0.1 { 40.0 } else { 0.0 };
            let position = Angle::from_radians_f64(position);
            let velocity = 40.0 * accelerated;
            let command = Setpoint { position, velocity, acceleration, ..Setpoint::default() }.into();
            let status = CommandStatus { time: if told { time } else { ROUND }, age: 0.0, readable: true };
            commander.step(&mut state, &command, status, GOOD, Default::default, &mut faults);
        }
        faults
    }

    #[test]
    fn a_round_that_took_longer_is_no_step_of_the_setpoint() {
        assert_eq!(faults(true), Faults::NONE);
        assert_eq!(faults(false), Faults::SETPOINT_LIMITED);
    }

    /// The reference after a round at 4 rad/s that the torque was limited in, of an output that is 0.1 rad behind at the
    /// speed `velocity` (rad/s).
    fn reference(error: f64, velocity: f64) -> Target<f64> {
        let (commander, mut state, mut faults) = (commander(), CommanderState::default(), Faults::NONE);
        let status = CommandStatus { time: ROUND, age: 0.0, readable: true };
        let mut target = Target::default();
        for k in 0..200 {
            let speed = 4.0 * (f64::from(k) / 100.0).min(1.0);
            let at = state.position().to_radians() + ROUND * speed;
            let behind = (Angle::from_radians_f64(at - 0.1), 0.0);
            let following = Following { error, limited: k == 199, velocity, load: 0.0 };
            target =
                commander.step(&mut state, &moving(at, speed), status, following, || behind, &mut faults);
        }
        target
    }

    #[test]
    fn a_lost_reference_goes_on_from_an_output_that_moves_with_it() {
        let lost = reference(-10.0, 3.0);
        assert!(lost.switched && (lost.setpoint.velocity - 3.0).abs() < 0.1, "{lost:?}");
        // Within what a cascade lags, and at an output that is held.
        for (error, velocity) in [(-2.0, 3.0), (-10.0, 0.5), (-10.0, -3.0)] {
            let kept = reference(error, velocity);
            assert!(!kept.switched && kept.setpoint.velocity == 4.0, "{kept:?}");
        }
    }

    /// A reference begins with the output's speed. On an output that moves, but not where the setpoint is, it does not.
    #[test]
    fn a_reference_that_begins_in_motion_needs_a_setpoint_near_by() {
        let status = CommandStatus { time: ROUND, age: 0.0, readable: true };
        let begun = |at: f64, velocity: f64| {
            let (mut state, mut faults) = (CommanderState::default(), Faults::NONE);
            let output = || (Angle::from_radians_f64(0.3), velocity);
            let following = Following { velocity, ..GOOD };
            let mut round = |k: i32| {
                let command = moving(at + f64::from(k) * ROUND * velocity, velocity);
                let target = commander().step(&mut state, &command, status, following, output, &mut faults);
                target.setpoint.velocity
            };
            assert_eq!(round(0), velocity);
            (round(1), faults)
        };
        assert_eq!(begun(0.3 + 3.0 * ROUND, 3.0), (3.0, Faults::NONE));
        assert_eq!(begun(0.1, 0.02), (0.0, Faults::SETPOINT_STEP));
        assert_eq!(begun(0.1, 3.0), (0.0, Faults::SETPOINT_STEP.with(Faults::RESTARTED)));
    }

    /// An output that a load pushes away from a reference at rest is not followed.
    #[test]
    fn a_reference_at_rest_is_never_lost() {
        for velocity in [-2.0, 0.0, 2.0] {
            assert!(!moves_with(velocity, 0.0), "{velocity}");
        }
    }
}
