//! What runs on the joint controller, once every 0.1 ms.
//!
//! ```text
//! guard, encoders -> observer, or feed-forward, or what is learnt -> cascade -> fallback -> torque command
//! ```
//!
//! The model takes [`turns`], so that no control period bears the whole of it. From one plan of the feed-forward
//! to the next the motor goes on by the acceleration and jerk that were planned: what it is sent to is smooth to the
//! third order. All that is compared in every period is kept relative to the motor's encoder: small numbers, that an
//! f32 holds.
//!
//! [`Compensator::control`] is total: for any input bits every output is finite and bounded, and what is wrong is
//! reported as [`Faults`] by name. Units: rad, rad/s, N m; signs as in [`crate::gear`].

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
pub mod turns;

pub use command::Command;
pub use directions::Directions;
pub use faults::Faults;
pub use limits::Limits;

use crate::angle::Angle;
use crate::error::Error;
use crate::flexspline::Reduced;
use crate::friction::JointFriction;
use crate::gear::{Gear, GearParams};
use crate::real::{RADIANS_PER_COUNT, Real};
use adaptation::{Factors, Observed};
use command::{Commander, CommanderState};
use encoder::{Encoder, EncoderParams, EncoderState, Reading};
use external_load::{ExternalLoad, ExternalLoadState, Yielding};
use fallback::{Fallback, FallbackState};
use feed_forward::{FeedForward, FeedForwardState};
use feedback::{Feedback, FeedbackParams, FeedbackState, Wanted};
use guard::{FrozenEncoder, InputGuard, InputGuardState};
use learning::{Learning, LearningParams, LearningState, Learnt};
use motor_torque::{MotorTorque, MotorTorqueState};
use observer::{Known, Measurement, Observer, ObserverParams, ObserverState};
use output_feedback::{Deviation, OutputFeedback, OutputFeedbackParams, OutputFeedbackState};
use turns::{OBSERVED, ROUND, Slow, Turn};

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
    /// The outer controller's wish: read once a round ([`turns::ROUND`] control periods).
    pub command: Command<R>,
    /// What is switched on, for either direction of the output.
    pub shares: Directions<R>,
}

/// What the observer believes: motion and external torque at the end of its period, torsion and torques at its
/// beginning ([`turns::OBSERVED`] control periods before).
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

/// What one step commands: finite and bounded for any input bits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Commanded<R> {
    /// Torque command to the motor (N m).
    pub motor_torque: R,
    /// What is wrong, by name.
    pub faults: Faults,
}

/// The same with what it rested on: finite and bounded for any input bits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Output<R: Real> {
    /// Torque command to the motor (N m).
    pub motor_torque: R,
    /// The part of it that is feed-forward (N m).
    pub feed_forward_torque: R,
    /// Where the motor should be.
    pub motor_reference: Angle<R>,
    /// The observer's estimates, from its last turn.
    pub estimate: Estimate<R>,
    /// The observer's turn was in this step.
    pub observed: bool,
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
    load: ExternalLoad<R>,
    feed_forward: FeedForward<R>,
    feedback: Feedback<R>,
    output_feedback: OutputFeedback<R>,
    learning: Learning<R>,
    /// What it starts from.
    learnt: Learnt<R>,
    motor_torque: MotorTorque<R>,
    fallback: Fallback<R>,
    limits: Limits<R>,
    dt: R,
    /// From the torques that the observer saw to the plan (s).
    behind: R,
}

/// What the compensator remembers from step to step.
#[derive(Clone, Debug)]
pub struct State<R: Real> {
    turn: Turn,
    guard: InputGuardState<R>,
    motor_encoder: EncoderState,
    output_encoder: EncoderState,
    heard: Heard<R>,
    /// Output encoder's angle where the observer's output angle is zero.
    output_zero: Option<Angle<R>>,
    frozen_path: R,
    frozen_output_path: R,
    /// Of the output encoder since its standstill was looked for, and when it was.
    output_raw: Option<u32>,
    last_output: Option<u32>,
    last_motor: Angle<R>,
    commander: CommanderState<R>,
    observer: ObserverState<R>,
    load: ExternalLoadState<R>,
    yielding: Yielding<R>,
    feed_forward: FeedForwardState<R>,
    course: Course<R>,
    feedback: FeedbackState<R>,
    output_feedback: OutputFeedbackState<R>,
    learning: LearningState<R>,
    known: Known<R>,
    /// By how much its load changes until the observer's next turn but one (N m).
    load_rate: R,
    /// Whose turn it is among what is slow.
    slow: Slow,
    motor_torque: MotorTorqueState<R>,
    fallback: FallbackState<R>,
    /// By how much the motor's reference was ahead of it in the last step (rad), and the feed-forward (N m).
    sent: [R; 2],
    /// What the last turns found wrong, and what was reported.
    faults: TurnsFaults,
    reported: Faults,
    limited: bool,
    /// Nothing has been wrong since the factors' last turn.
    sound: bool,
}

/// What the sensors have said since the observer's last turn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Heard<R> {
    /// Sum of the motor's torque (N m).
    motor_torque: R,
    /// Raw count of the output encoder, and how many control periods ago it was.
    output: Option<u32>,
    age: u32,
    /// Strain gauge (N m).
    output_torque: Option<R>,
}

/// Where the motor is sent, from one plan to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Course<R> {
    /// theta_ref - theta (rad), dtheta_ref (rad/s), ddtheta_ref (rad/s^2) and its rate.
    ahead: R,
    velocity: R,
    acceleration: R,
    jerk: R,
    /// Share of the acceleration that the cascade knows of.
    known: R,
    /// Feed-forward (N m).
    torque: R,
    torque_rate: R,
    transmission: R,
    wound: R,
    /// Torque at the output flange in the place of a motion (N m).
    output_torque: Option<R>,
    /// The command is of another kind than the last one.
    switched: bool,
    /// There is a plan.
    planned: bool,
}

/// What is wrong, by who has found it in its last turn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct TurnsFaults {
    observer: Faults,
    plan: Faults,
    standstill: Faults,
    shares: Faults,
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
        let [observed, round] = [OBSERVED, ROUND].map(|periods| R::from_i32(periods as i32) * self.dt);
        // Periods between readings of the output encoder that the observer sees, and that its standstill is looked for in.
        let [readings, looks] = [ROUND, 2 * ROUND]
            .map(|least| R::from_i32(self.observer.output_encoder_period.max(least) as i32));
        Ok(Compensator {
            gear: self.gear.build(Reduced::build(&self.gear.flexspline, self.gear.rated_torque)?, self.dt)?,
            commander: Commander::build(limits, n, guard.acceleration(), round)?,
            guard,
            motor_encoder: encoder(self.motor_encoder_bits, self.limits.motor_speed)?,
            output_encoder: encoder(self.output_encoder_bits, limits.output_speed(n) * readings)?,
            frozen_encoder: FrozenEncoder::of_motor(round + round),
            frozen_output: FrozenEncoder::of_output(self.dt * looks),
            observer: self.observer.build(&self.gear, &self.limits, self.dt)?,
            load: ExternalLoad::build(&self.gear, self.dt)?,
            feed_forward: FeedForward::build(&self.gear, self.dt)?,
            feedback: self.feedback.build(self.dt)?,
            output_feedback: OutputFeedback::build(
                &self.output_feedback,
                self.gear.flexspline_inertia,
                limits.output_speed(n),
                R::lit(core::f64::consts::TAU) / R::from_i32(1 << self.output_encoder_bits.min(30)),
                round,
            )?,
            learning: self.learning.build(&self.gear, &self.limits, self.dt)?,
            learnt: self.learnt,
            motor_torque: MotorTorque::build(self.limits.motor_torque, self.dt)?,
            fallback: Fallback::build(self.limits.motor_torque, self.dt),
            limits: self.limits,
            dt: self.dt,
            behind: observed + self.dt,
        })
    }
}

impl<R: Real> Compensator<R> {
    /// The state before the first step: what was learnt before, within its bounds.
    pub fn rest(&self) -> State<R> {
        State {
            turn: Turn::default(),
            guard: InputGuardState::default(),
            motor_encoder: EncoderState::default(),
            output_encoder: EncoderState::default(),
            heard: Heard::default(),
            output_zero: None,
            frozen_path: R::ZERO,
            frozen_output_path: R::ZERO,
            output_raw: None,
            last_output: None,
            last_motor: Angle::default(),
            commander: CommanderState::default(),
            observer: self.observer.rest(),
            load: ExternalLoadState::default(),
            yielding: Yielding::default(),
            feed_forward: FeedForwardState::default(),
            course: Course::default(),
            feedback: FeedbackState::default(),
            output_feedback: OutputFeedbackState::default(),
            learning: self.learning.starting_from(&self.learnt),
            known: Known::default(),
            load_rate: R::ZERO,
            slow: Slow::Lead,
            motor_torque: MotorTorqueState::default(),
            fallback: FallbackState::default(),
            sent: [R::ZERO; 2],
            faults: TurnsFaults::default(),
            reported: Faults::NONE,
            limited: false,
            sound: true,
        }
    }

    /// What has been learnt of the joint, to be stored.
    pub fn learnt(&self, state: &State<R>) -> Learnt<R> {
        state.learning.learnt()
    }

    /// One control step, and all that is to be known of it: [`Self::control`] and [`Self::output`].
    pub fn step(&self, state: &mut State<R>, input: &Input<R>) -> Output<R> {
        self.control(state, input);
        self.output(state)
    }

    /// One control step.
    #[inline(never)] // The timing budget counts it by its symbol.
    pub fn control(&self, state: &mut State<R>, input: &Input<R>) -> Commanded<R> {
        let mut faults = Faults::NONE;
        let sensors = self.guard.sensors(&mut state.guard, &input.sensors, &mut faults);
        let motor = self.read(state, &sensors, &mut faults);
        match state.turn {
            Turn::Observe => self.observe(state, motor.angle, true),
            Turn::Plan => self.plan(state, &input.command, motor.angle),
            Turn::ObserveAgain => self.observe(state, motor.angle, false),
            Turn::Learn => self.learn(state, &input.shares, motor.angle),
        }
        state.turn = state.turn.next();
        let TurnsFaults { observer, plan, standstill, shares } = state.faults;
        faults = faults.with(observer).with(plan).with(standstill).with(shares);
        let motor_torque = self.drive(state, &motor, &mut faults);
        state.sound &= faults == Faults::NONE && !state.limited;
        state.reported = faults;
        Commanded { motor_torque, faults }
    }

    /// What the last step commanded, rested on and believed. Apart from the control step: who does not look at it
    /// does not pay for it.
    #[inline(never)] // The timing budget counts it by its symbol.
    pub fn output(&self, state: &State<R>) -> Output<R> {
        let [ahead, feed_forward] = state.sent;
        Output {
            motor_torque: state.fallback.torque(),
            feed_forward_torque: feed_forward.limit(self.limits.motor_torque),
            motor_reference: state.motor_encoder.angle().plus(ahead),
            estimate: self.observer.estimate(&state.observer, &state.known),
            observed: matches!(state.turn, Turn::Plan | Turn::Learn),
            factors: *state.learning.applied(),
            faults: state.reported,
        }
    }

    /// The sensors' turn: every period.
    #[inline(always)]
    fn read(&self, state: &mut State<R>, sensors: &Sensors<R>, faults: &mut Faults) -> Reading<R> {
        let motor = self.motor_encoder.step(&mut state.motor_encoder, sensors.motor_encoder);
        faults.raise_if(!motor.believed, Faults::MOTOR_ENCODER_JUMP);
        let (commanded, feedback) = (state.fallback.torque(), state.guard.shares().feedback);
        let heard = &mut state.heard;
        heard.motor_torque +=
            self.motor_torque.step(&mut state.motor_torque, commanded, feedback, sensors.motor_torque);
        if sensors.output_encoder.is_some() {
            (heard.output, heard.age) = (sensors.output_encoder, 0);
        } else {
            heard.age = heard.age.saturating_add(1);
            if !self.observer.looks_back() {
                heard.output = None;
            }
        }
        if sensors.output_torque.is_some() {
            heard.output_torque = sensors.output_torque;
        }
        state.course.ahead -= motor.moved;
        motor
    }

    /// The observer's turn: the first of a round reads the output's encoder.
    #[inline(never)] // The timing budget counts this turn by its symbol.
    fn observe(&self, state: &mut State<R>, motor: Angle<R>, with_output: bool) {
        let mut faults = Faults::NONE;
        let age = state.heard.age;
        let output = if with_output {
            state.known.load += state.load_rate;
            self.read_output(state, motor, &mut faults)
        } else {
            None
        };
        let measured = Measurement {
            motor,
            output,
            age,
            motor_torque: R::lit(1.0 / OBSERVED as f64) * state.heard.motor_torque,
            output_torque: state.heard.output_torque.take(),
        };
        state.heard.motor_torque = R::ZERO;
        self.observer.step(&self.gear, &mut state.observer, &measured, &state.known, &mut faults);
        self.load.follow(&mut state.load, state.observer.external_torque());
        state.yielding = self.load.yielding(&state.load, state.course.wound, state.guard.shares().wind_up);
        let kept = if with_output { Faults::NONE } else { Faults::OUTPUT_ENCODER_JUMP };
        state.faults.observer = faults.with(state.faults.observer.among(kept));
    }

    /// The output encoder's angle, where the observer's is its zero.
    #[inline(always)]
    fn read_output(&self, state: &mut State<R>, motor: Angle<R>, faults: &mut Faults) -> Option<Angle<R>> {
        let raw = state.heard.output.take()?;
        let Reading { angle, believed, .. } = self.output_encoder.step::<R>(&mut state.output_encoder, raw);
        faults.raise_if(!believed, Faults::OUTPUT_ENCODER_JUMP);
        state.output_raw = Some(raw);
        // The two encoders are mounted at any angle to each other: the first readings that are both
        // believed are their zero, with the torsion of that moment.
        if state.output_zero.is_none() && believed && state.motor_encoder.is_believed() {
            let age = state.heard.age;
            let then = self.observer.output_at_reading(&self.gear, &state.observer, motor, age);
            state.output_zero = then.map(|then| angle.less(then));
        }
        let frozen = state.faults.standstill.contains(Faults::OUTPUT_ENCODER_FROZEN);
        state.output_zero.filter(|_| believed && !frozen).map(|zero| angle.less(zero))
    }

    /// The feed-forward's turn.
    #[inline(never)] // The timing budget counts this turn by its symbol.
    fn plan(&self, state: &mut State<R>, command: &Command<R>, motor: Angle<R>) {
        let mut faults = Faults::NONE;
        let command = self.guard.command(&mut state.guard, command, &mut faults);
        let now = || self.observer.estimate(&state.observer, &state.known);
        let followed = self.commander.step(&mut state.commander, &command, now, &mut faults);
        state.faults.plan = faults;
        let setpoint = &followed.setpoint;
        let shares = state.guard.shares();
        let reference = state.course.reference(motor);
        self.learning.turn_to(&mut state.learning, reference, setpoint.position);
        let load = self.load.rest_on(&mut state.load, state.observer.external_torque());
        let believed = self.learning.believed(&state.learning, load, shares);
        let demand = self.feed_forward.step(&self.gear, &mut state.feed_forward, setpoint, shares, &believed);
        let ahead = demand.motor.angle.minus(motor);
        // What was seen a period ago moves on.
        let velocity = state.observer.output_velocity() + self.dt * setpoint.acceleration;
        let position =
            demand.ahead + self.observer.output_beside(&state.observer, &state.known, ahead, self.dt);
        let measured =
            self.observer.output_innovation(&state.observer).map(|innovation| position + innovation);
        let lesson = learning::Course { excitation: demand.excitation, position: measured };
        let deviation = Deviation {
            position,
            velocity: velocity - setpoint.velocity,
            asked_velocity: setpoint.velocity,
            torque: self.observer.transmitted(&state.observer)
                - state.observer.output_friction()
                - (demand.accelerating - self.behind * demand.accelerating_rate)
                + load.at_once,
            measured,
        };
        let shift = self.output_feedback.step(&mut state.output_feedback, &deviation, !state.limited);
        let share = shares.output_feedback * R::from_i32(self.gear.ratio().n());
        state.course = Course {
            ahead: ahead + share * shift.angle,
            velocity: demand.motor.velocity + share * shift.rate,
            acceleration: demand.acceleration,
            jerk: demand.jerk,
            known: shares.wind_up,
            torque: demand.torque,
            torque_rate: demand.torque_rate,
            transmission: demand.transmission,
            wound: demand.wound,
            output_torque: followed.torque,
            switched: followed.switched,
            planned: true,
        };
        let learns = state.learns();
        self.learning.follow(&mut state.learning, &lesson, learns);
        (state.known, state.load_rate) = self.learning.known(&state.learning, shares);
    }

    /// The turn of what is learnt.
    #[inline(always)]
    fn learn(&self, state: &mut State<R>, shares: &Directions<R>, motor: Angle<R>) {
        let trusted = state.fallback.trusted();
        let mut arrived = true;
        let falls_back = !trusted && !self.guard.model_is_off(&state.guard);
        match if falls_back { Slow::Lead } else { state.slow } {
            Slow::Adapt => self.adapt(state),
            Slow::Deviate => {
                self.observer.deviate(&mut state.observer);
                self.notice_standstill(state, motor);
                arrived = self.guard.shares_have_arrived(&state.guard, shares, trusted);
                state.faults.shares = Faults::NONE;
            }
            Slow::Lead => {
                let course = guard::Course { velocity: state.commander.velocity(), trusted };
                let mut faults = Faults::NONE;
                self.guard.lead(&mut state.guard, shares, course, &mut faults);
                state.faults.shares = faults;
            }
        }
        state.slow = state.slow.next(arrived);
        let reference = state.course.reference(motor);
        let factors = state.learning.applied();
        self.feed_forward.remember(&self.gear, &mut state.feed_forward, reference, factors);
    }

    /// Raises the faults of encoders that stand still while the motor is asked to move. A joint that is held against
    /// its load by a brake is noticed by it too: what the output feedback asks is a motion.
    #[inline(always)]
    fn notice_standstill(&self, state: &mut State<R>, motor: Angle<R>) {
        let mut faults = Faults::NONE;
        let asked = state.course.asked();
        let stood_still = motor == state.last_motor;
        state.last_motor = motor;
        let frozen = self.frozen_encoder.step(&mut state.frozen_path, stood_still, asked);
        faults.raise_if(frozen, Faults::MOTOR_ENCODER_FROZEN);
        if let Some(raw) = state.output_raw.take() {
            let stood_still = state.last_output.replace(raw) == Some(raw);
            self.frozen_output.step(&mut state.frozen_output_path, stood_still, asked);
        }
        faults
            .raise_if(self.frozen_output.is_frozen(state.frozen_output_path), Faults::OUTPUT_ENCODER_FROZEN);
        state.faults.standstill = faults;
    }

    /// The factors' turn.
    #[inline(always)]
    fn adapt(&self, state: &mut State<R>) {
        let observed = Observed {
            external_torque: state.observer.external_torque(),
            torsion: state.observer.torsion(),
            output_innovation: self.observer.moving_output_innovation(&state.observer),
        };
        let shares = state.guard.shares();
        let learns = state.learns();
        self.learning.adapt(&mut state.learning, &observed, shares, learns);
        state.sound = true;
    }

    /// The cascade's turn: every period. Answers with the torque that is commanded.
    #[inline(always)]
    fn drive(&self, state: &mut State<R>, motor: &Reading<R>, faults: &mut Faults) -> R {
        let (course, yielding) = (&state.course, &state.yielding);
        let wanted = Wanted {
            ahead: course.ahead,
            velocity: course.velocity + yielding.velocity,
            acceleration: course.known * course.acceleration + yielding.acceleration,
        };
        let held = state.limited || course.output_torque.is_some() || !course.planned;
        let feedback = self.feedback.step(&mut state.feedback, motor.moved, &wanted, held) + yielding.torque;
        let closed = match course.output_torque {
            Some(torque) => course.transmission * torque,
            None if !course.planned => R::ZERO,
            None => {
                let feedback = self.taken_over(state, feedback);
                state.guard.shares().feedback * feedback
            }
        };
        let (wanted, switched) = (state.course.torque + closed, state.course.switched);
        state.course.switched = false;
        let torque = self.command(state, wanted, switched, faults);
        state.sent = [state.course.ahead, state.course.torque];
        state.course.advance(state.yielding.velocity, self.dt);
        torque
    }

    /// The feedback, which goes on from the torque (N m) so far when it was switched to.
    fn taken_over(&self, state: &mut State<R>, feedback: R) -> R {
        if !state.course.switched {
            return feedback;
        }
        let left = state.fallback.torque() - state.course.torque - feedback;
        feedback + self.feedback.take_over(&mut state.feedback, left)
    }

    /// The torque that is commanded: none without a motor encoder, never more than the motor's peak.
    fn command(&self, state: &mut State<R>, wanted: R, switched: bool, faults: &mut Faults) -> R {
        let limited = wanted.limit(self.limits.motor_torque);
        faults.raise_if(limited != wanted, Faults::TORQUE_LIMITED);
        let torque = self.fallback.step(&mut state.fallback, limited, *faults, switched);
        // The feedback's integral must not run while its torque does not reach the motor.
        state.limited = torque != wanted;
        torque
    }
}

impl<R: Real> State<R> {
    /// What is learnt may rest on this round.
    #[inline(always)]
    fn learns(&self) -> bool {
        self.sound && self.guard.shares().adaptation > R::ZERO && self.course.output_torque.is_none()
    }
}

impl<R: Real> Course<R> {
    /// Speed that the motor is asked for (rad/s). Where a torque is commanded no motion is.
    #[inline(always)]
    fn asked(&self) -> R {
        if self.output_torque.is_some() { R::ZERO } else { self.velocity }
    }

    /// Where a motor that is at `motor` is sent, to a count.
    #[inline(always)]
    fn reference(&self, motor: Angle<R>) -> Angle<R> {
        let ahead = (self.ahead * R::lit(1.0 / RADIANS_PER_COUNT)).to_i32();
        Angle::from_counts(motor.counts.wrapping_add(i64::from(ahead)))
    }

    /// One control period dt (s) later, with the motor sent on by another `velocity` (rad/s).
    #[inline(always)]
    fn advance(&mut self, velocity: R, dt: R) {
        let change = dt * self.acceleration;
        self.ahead += dt * (self.velocity + R::lit(0.5) * change + velocity);
        self.velocity += change;
        self.acceleration += dt * self.jerk;
        self.torque += dt * self.torque_rate;
    }
}
