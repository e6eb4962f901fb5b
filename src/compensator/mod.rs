//! What runs on the joint controller, once every 0.1 ms.
//!
//! ```text
//! guard, encoders -> observer -> command -> feed-forward -> feedback -> fallback -> torque command
//! ```
//!
//! [`Compensator::step`] is total: for any input bits every output is finite and bounded, and what is
//! wrong is reported as [`Faults`] by name. Units: rad, rad/s, N m; signs as in [`crate::gear`].

pub mod adaptation;
pub mod command;
pub mod directions;
pub mod encoder;
pub mod external_load;
pub mod fallback;
pub mod faults;
pub mod feed_forward;
pub mod feedback;
pub mod guard;
pub mod learning;
pub mod learnt_ripple;
pub mod limits;
pub mod motor_torque;
pub mod observer;
pub mod output_feedback;

pub use command::Command;
pub use directions::Directions;
pub use faults::Faults;
pub use limits::Limits;

use crate::angle::Angle;
use crate::error::Error;
use crate::flexspline::Reduced;
use crate::friction::JointFriction;
use crate::gear::{Gear, GearParams};
use crate::real::Real;
use adaptation::Factors;
use command::{Commander, CommanderState, Followed};
use encoder::{Encoder, EncoderParams, EncoderState};
use fallback::{BLIND, Fallback, FallbackState};
use feed_forward::{Demand, FeedForward, FeedForwardState};
use feedback::{Feedback, FeedbackParams, FeedbackState};
use guard::{Course, FrozenEncoder, InputGuard, InputGuardState};
use learning::{Learning, LearningParams, LearningState, Learnt};
use motor_torque::{MotorTorque, MotorTorqueState};
use observer::{Measurement, Observer, ObserverParams, ObserverState};
use output_feedback::{Deviation, OutputFeedback, OutputFeedbackParams, OutputFeedbackState};

/// Levels of the hysteresis that runs in real time.
pub const HYSTERESIS_LEVELS: usize = 24;

/// Turning points that it remembers: a state of 244 bytes.
pub const HYSTERESIS_MEMORY: usize = 28;

/// Nodes around and slices along of the mesh whose reduction runs in real time.
pub const MESH: (usize, usize) = (8, 3);

/// The flexspline as it runs in real time.
pub type RealTimeFlexspline<R> = Reduced<R, { MESH.0 }, { MESH.1 }>;

/// The gear as it runs in real time.
pub type RealTimeGear<R> =
    Gear<R, RealTimeFlexspline<R>, JointFriction<R>, HYSTERESIS_LEVELS, HYSTERESIS_MEMORY>;

/// What the joint's sensors report to one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensors<R> {
    /// Motor (wave-generator) encoder, raw count within the turn.
    pub motor_encoder: u32,
    /// Output (flexspline) encoder, raw count within the turn.
    pub output_encoder: Option<u32>,
    /// Torque of the motor at its shaft (N m).
    pub motor_torque: R,
    /// Torque through the flexspline from a strain gauge (N m).
    pub output_torque: Option<R>,
}

/// Where the output should be, with the derivatives that the feed-forward uses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Setpoint<R> {
    /// Output angle.
    pub position: Angle<R>,
    /// Output speed (rad/s).
    pub velocity: R,
    /// Output acceleration (rad/s^2).
    pub acceleration: R,
    /// Output jerk (rad/s^3).
    pub jerk: R,
    /// Output snap (rad/s^4).
    pub snap: R,
}

/// How much of each correction is applied, 0..=1; changed at run time without a step in the output.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shares<R> {
    /// The cascaded feedback.
    pub feedback: R,
    /// Inertia of motor and load.
    pub inertia: R,
    /// Friction of both sides.
    pub friction: R,
    /// Wind-up: torsion, with hysteresis.
    pub wind_up: R,
    /// Kinematic error.
    pub kinematic_error: R,
    /// Output feedback: the torsional vibration's damping.
    pub output_feedback: R,
    /// Factors that have been learnt; 0 also stops the learning.
    pub adaptation: R,
    /// Ripple that has been learnt; 0 also stops the learning.
    pub ripple: R,
}

impl<R: Real> Shares<R> {
    /// Everything on.
    pub const ALL: Self = Self {
        feedback: R::ONE,
        inertia: R::ONE,
        friction: R::ONE,
        wind_up: R::ONE,
        kinematic_error: R::ONE,
        output_feedback: R::ONE,
        adaptation: R::ONE,
        ripple: R::ONE,
    };
}

/// What one step reads.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Input<R> {
    /// The joint's sensors.
    pub sensors: Sensors<R>,
    /// The outer controller's wish.
    pub command: Command<R>,
    /// What is switched on, for either direction of the output.
    pub shares: Directions<R>,
}

/// What the observer believes: motion and external torque at the end of the control period, torsion
/// and torques at its beginning.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate<R> {
    /// Output angle.
    pub output_position: Angle<R>,
    /// Output speed (rad/s).
    pub output_velocity: R,
    /// Torsion of the flexspline (rad).
    pub torsion: R,
    /// Torque through the flexspline (N m).
    pub transmitted_torque: R,
    /// Friction at the wave generator (N m).
    pub input_friction: R,
    /// Friction at the flexspline (N m).
    pub output_friction: R,
    /// External torque on the flexspline (N m).
    pub external_torque: R,
    /// How far off they may be.
    pub deviation: EstimateDeviation<R>,
}

/// Standard deviations of an [`Estimate`], as [`observer::deviation`] declares them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EstimateDeviation<R> {
    /// Of the output angle (rad).
    pub output_position: R,
    /// Of the output speed (rad/s).
    pub output_velocity: R,
    /// Of the torsion (rad).
    pub torsion: R,
    /// Of the torque through the flexspline (N m).
    pub transmitted_torque: R,
    /// Of the friction at the wave generator (N m).
    pub input_friction: R,
    /// Of the friction at the flexspline (N m).
    pub output_friction: R,
    /// Of the external torque on the flexspline (N m).
    pub external_torque: R,
}

/// What one step writes: finite and bounded for any input bits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Output<R: Real> {
    /// Torque command to the motor (N m).
    pub motor_torque: R,
    /// The part of it that is feed-forward (N m).
    pub feed_forward_torque: R,
    /// Where the motor should be.
    pub motor_reference: Angle<R>,
    /// The observer's estimates.
    pub estimate: Estimate<R>,
    /// What has been learnt of the joint, as far as it is applied.
    pub factors: Factors<R>,
    /// What is wrong, by name.
    pub faults: Faults,
}

/// Everything that a joint's compensator is built from; generated from a gear file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointParams<R: Real> {
    /// Control period (s).
    pub dt: R,
    /// The gear.
    pub gear: GearParams<R>,
    /// Resolution of the motor encoder, 2^bits counts a turn.
    pub motor_encoder_bits: u32,
    /// Resolution of the output encoder, 2^bits counts a turn.
    pub output_encoder_bits: u32,
    /// What the joint can do.
    pub limits: Limits<R>,
    /// The observer's gains.
    pub observer: ObserverParams<R>,
    /// The motor-side cascade.
    pub feedback: FeedbackParams<R>,
    /// Output feedback without and with an output encoder.
    pub output_feedback: [OutputFeedbackParams<R>; 2],
    /// Adaptation and ripple.
    pub learning: LearningParams<R>,
    /// What has been learnt of the joint before.
    pub learnt: Learnt<R>,
}

/// The built compensator of a joint.
#[derive(Clone, Debug)]
pub struct Compensator<R: Real> {
    gear: RealTimeGear<R>,
    guard: InputGuard<R>,
    motor_encoder: Encoder,
    output_encoder: Encoder,
    frozen_encoder: FrozenEncoder<R>,
    frozen_output: FrozenEncoder<R>,
    commander: Commander<R>,
    observer: Observer<R>,
    feed_forward: FeedForward<R>,
    feedback: Feedback<R>,
    output_feedback: OutputFeedback<R>,
    learning: Learning<R>,
    /// What it starts from.
    learnt: Learnt<R>,
    motor_torque: MotorTorque<R>,
    fallback: Fallback<R>,
    limits: Limits<R>,
}

/// What the compensator remembers from step to step.
#[derive(Clone, Debug)]
pub struct State<R: Real> {
    guard: InputGuardState<R>,
    motor_encoder: EncoderState,
    output_encoder: EncoderState,
    /// Output encoder's angle where the observer's output angle is zero.
    output_zero: Option<Angle<R>>,
    frozen_path: R,
    frozen_output_path: R,
    /// Speed that the motor was asked for (rad/s).
    asked: R,
    last_output: Option<u32>,
    last_motor: Angle<R>,
    commander: CommanderState<R>,
    observer: ObserverState<R>,
    feed_forward: FeedForwardState<R>,
    feedback: FeedbackState<R>,
    output_feedback: OutputFeedbackState<R>,
    learning: LearningState<R>,
    motor_torque: MotorTorqueState<R>,
    fallback: FallbackState<R>,
    limited: bool,
}

impl<R: Real> JointParams<R> {
    /// Checks every parameter once and precomputes all that the step needs.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the name of the first parameter that is out of its range.
    pub fn build(&self) -> Result<Compensator<R>, Error> {
        self.limits.check()?;
        let encoder = |bits, speed| EncoderParams { bits, speed_limit: R::lit(2.0) * speed }.build(self.dt);
        let guard = InputGuard::build(&self.gear, &self.limits, self.dt)?;
        let (limits, n) = (&self.limits, self.gear.ratio);
        // Periods between readings of the output encoder.
        let readings = R::from_i32(self.observer.output_encoder_period as i32);
        Ok(Compensator {
            gear: self.gear.build(Reduced::build(&self.gear.flexspline, self.gear.rated_torque)?, self.dt)?,
            commander: Commander::build(limits, n, guard.acceleration(), self.dt)?,
            guard,
            motor_encoder: encoder(self.motor_encoder_bits, self.limits.motor_speed)?,
            output_encoder: encoder(self.output_encoder_bits, limits.output_speed(n) * readings)?,
            frozen_encoder: FrozenEncoder::of_motor(self.dt),
            frozen_output: FrozenEncoder::of_output(self.dt * readings),
            observer: self.observer.build(&self.gear, &self.limits, self.dt)?,
            feed_forward: FeedForward::build(&self.gear, self.dt)?,
            feedback: self.feedback.build(self.dt)?,
            output_feedback: OutputFeedback::build(
                &self.output_feedback,
                self.gear.flexspline_inertia,
                limits.output_speed(n),
                R::lit(core::f64::consts::TAU) / R::from_i32(1 << self.output_encoder_bits.min(30)),
                self.dt,
            )?,
            learning: self.learning.build(&self.gear, &self.limits, self.dt)?,
            learnt: self.learnt,
            motor_torque: MotorTorque::build(self.limits.motor_torque, self.dt)?,
            fallback: Fallback::build(self.limits.motor_torque, self.dt),
            limits: self.limits,
        })
    }
}

impl<R: Real> Compensator<R> {
    /// The state before the first step: what was learnt before, within its bounds.
    pub fn rest(&self) -> State<R> {
        State {
            guard: InputGuardState::default(),
            motor_encoder: EncoderState::default(),
            output_encoder: EncoderState::default(),
            output_zero: None,
            frozen_path: R::ZERO,
            frozen_output_path: R::ZERO,
            asked: R::ZERO,
            last_output: None,
            last_motor: Angle::default(),
            commander: CommanderState::default(),
            observer: self.observer.rest(&self.gear),
            feed_forward: FeedForwardState::default(),
            feedback: FeedbackState::default(),
            output_feedback: OutputFeedbackState::default(),
            learning: self.learning.starting_from(&self.learnt),
            motor_torque: MotorTorqueState::default(),
            fallback: FallbackState::default(),
            limited: false,
        }
    }

    /// What has been learnt of the joint, to be stored.
    pub fn learnt(&self, state: &State<R>) -> Learnt<R> {
        state.learning.learnt()
    }

    /// One control step.
    #[inline(never)] // The timing budget counts blocks by their symbols.
    pub fn step(&self, state: &mut State<R>, input: &Input<R>) -> Output<R> {
        let mut faults = Faults::NONE;
        let course = Course { velocity: state.commander.velocity(), trusted: state.fallback.trusted() };
        let input = self.guard.step(&mut state.guard, input, course, &mut faults);
        let measured = self.measure(state, &input.sensors, &mut faults);
        let mut estimate = self.observe(state, &measured, &mut faults);
        let shares = state.guard.shares();
        let learns = faults == Faults::NONE && !state.limited && shares.adaptation > R::ZERO;
        let followed = self.commander.step(&mut state.commander, &input.command, &estimate, &mut faults);
        let learns = learns && followed.torque.is_none();
        let believed = self.learning.believe(
            &mut state.learning,
            &mut estimate,
            self.observer.output_innovation(&state.observer),
            shares,
            learns,
        );
        let setpoint = &followed.setpoint;
        let mut demand =
            self.feed_forward.step(&self.gear, &mut state.feed_forward, setpoint, shares, &believed);
        let error = measured.output.map(|angle| angle.minus(setpoint.position));
        let learnt =
            learning::Course { excitation: demand.excitation, speed: demand.motor.velocity, position: error };
        self.learning.follow(&mut state.learning, &learnt, learns);
        self.give_way(state, &mut demand, setpoint, &estimate, error);
        // Where a torque is commanded no motion is. What the output feedback asks is one: a joint that is held against its
        // load by a brake, or by an encoder that no longer moves, is noticed by it.
        state.asked = if followed.torque.is_some() { R::ZERO } else { demand.motor.velocity };
        let shares = state.guard.shares();
        let stood_still = measured.motor == state.last_motor;
        state.last_motor = measured.motor;
        let frozen = self.frozen_encoder.step(&mut state.frozen_path, stood_still, state.asked);
        faults.raise_if(frozen, Faults::MOTOR_ENCODER_FROZEN);
        let held = state.limited || followed.torque.is_some();
        let feedback = self.feedback.step(
            &mut state.feedback,
            measured.motor,
            &demand.motor,
            shares.wind_up * demand.acceleration + demand.yielding.acceleration,
            held,
        ) + demand.yielding.torque;
        let closed = match followed.torque {
            Some(torque) => demand.transmission * torque,
            None => {
                let share = shares.feedback;
                share * self.taken_over(state, &followed, demand.torque, feedback)
            }
        };
        Output {
            motor_torque: self.command(state, demand.torque + closed, followed.switched, &mut faults),
            feed_forward_torque: demand.torque.limit(self.limits.motor_torque),
            motor_reference: demand.motor.angle,
            estimate,
            factors: *state.learning.applied(),
            faults,
        }
    }

    /// What the observer believes.
    #[inline(always)]
    fn observe(&self, state: &mut State<R>, measured: &Measurement<R>, faults: &mut Faults) -> Estimate<R> {
        let (motor, output) = (state.feed_forward.reference(), state.commander.position());
        self.learning.turn_to(&mut state.learning, motor, output);
        let told = self.learning.told(&state.learning, measured, state.guard.shares());
        self.observer.step(&self.gear, &mut state.observer, &told, faults)
    }

    /// Moves the motor's reference for the output to behave like its reference model.
    #[inline(always)]
    fn give_way(
        &self,
        state: &mut State<R>,
        demand: &mut Demand<R>,
        setpoint: &Setpoint<R>,
        estimate: &Estimate<R>,
        measured: Option<R>,
    ) {
        let deviation = Deviation {
            position: estimate.output_position.minus(setpoint.position),
            velocity: estimate.output_velocity - setpoint.velocity,
            asked_velocity: setpoint.velocity,
            torque: estimate.transmitted_torque - estimate.output_friction - demand.accelerating
                + demand.external_torque,
            measured,
        };
        let shift = self.output_feedback.step(&mut state.output_feedback, &deviation, !state.limited);
        let share = state.guard.shares().output_feedback * R::from_i32(self.gear.ratio().n());
        demand.motor.angle = demand.motor.angle.plus(share * shift.angle);
        demand.motor.velocity += demand.yielding.velocity + share * shift.rate;
    }

    /// The sensors' raw counts as unbounded angles.
    fn measure(&self, state: &mut State<R>, sensors: &Sensors<R>, faults: &mut Faults) -> Measurement<R> {
        let (motor, believed) = self.motor_encoder.step(&mut state.motor_encoder, sensors.motor_encoder);
        faults.raise_if(!believed, Faults::MOTOR_ENCODER_JUMP);
        let output = sensors.output_encoder.and_then(|raw| {
            let (angle, output_believed) = self.output_encoder.step::<R>(&mut state.output_encoder, raw);
            faults.raise_if(!output_believed, Faults::OUTPUT_ENCODER_JUMP);
            let stood_still = state.last_output.replace(raw) == Some(raw);
            let frozen = self.frozen_output.step(&mut state.frozen_output_path, stood_still, state.asked);
            faults.raise_if(frozen, Faults::OUTPUT_ENCODER_FROZEN);
            // The two encoders are mounted at any angle to each other: the first readings that are both
            // believed are their zero, with the torsion of that moment.
            if state.output_zero.is_none() && believed && output_believed {
                let then = self.observer.output_at_reading(&self.gear, &state.observer, motor);
                state.output_zero = then.map(|then| angle.less(then));
            }
            state.output_zero.filter(|_| output_believed && !frozen).map(|zero| angle.less(zero))
        });
        let (commanded, feedback) = (state.fallback.torque(), state.guard.shares().feedback);
        let torque = sensors.motor_torque;
        Measurement {
            motor,
            output,
            motor_torque: self.motor_torque.step(&mut state.motor_torque, commanded, feedback, torque),
            known_torque: R::ZERO,
            known_stiffness: R::ZERO,
            output_torque: sensors.output_torque,
        }
    }

    /// The feedback, which goes on from the torque (N m) so far when it was switched to.
    fn taken_over(&self, state: &mut State<R>, followed: &Followed<R>, fed: R, feedback: R) -> R {
        if !followed.switched {
            return feedback;
        }
        let left = state.fallback.torque() - fed - feedback;
        feedback + self.feedback.take_over(&mut state.feedback, left)
    }

    /// The torque that is commanded: none without a motor encoder, never more than the motor's peak.
    fn command(&self, state: &mut State<R>, wanted: R, switched: bool, faults: &mut Faults) -> R {
        let wanted = if faults.intersects(BLIND) { R::ZERO } else { wanted };
        let limited = wanted.limit(self.limits.motor_torque);
        faults.raise_if(limited != wanted, Faults::TORQUE_LIMITED);
        let torque = self.fallback.step(&mut state.fallback, limited, *faults, switched);
        // The feedback's integral must not run while its torque does not reach the motor.
        state.limited = faults.intersects(BLIND) || torque != wanted;
        torque
    }
}
