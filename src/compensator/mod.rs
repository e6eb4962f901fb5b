//! What runs on the joint controller, once every 0.1 ms.
//!
//! ```text
//! encoders -> observer -> feed-forward -> feedback -> torque command
//! ```
//!
//! [`Compensator::step`] is total: for any input bits every output is finite and bounded, and what is
//! wrong is reported as [`Faults`] by name. Units: rad, rad/s, N m; signs as in [`crate::gear`].

pub mod encoder;
pub mod faults;
pub mod feed_forward;
pub mod feedback;
pub mod guard;
pub mod limits;
pub mod observer;

pub use faults::Faults;
pub use limits::Limits;

use crate::angle::Angle;
use crate::error::Error;
use crate::flexspline::Reduced;
use crate::friction::JointFriction;
use crate::gear::{Gear, GearParams};
use crate::real::Real;
use encoder::{Encoder, EncoderParams, EncoderState};
use feed_forward::{FeedForward, FeedForwardState};
use feedback::{Feedback, FeedbackParams, FeedbackState};
use guard::{FrozenEncoder, InputGuard, InputGuardState};
use observer::{Measurement, Observer, ObserverParams, ObserverState};

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
}

/// What one step reads.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Input<R> {
    /// The joint's sensors.
    pub sensors: Sensors<R>,
    /// The outer controller's wish.
    pub setpoint: Setpoint<R>,
    /// What is switched on.
    pub shares: Shares<R>,
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
pub struct Output<R> {
    /// Torque command to the motor (N m).
    pub motor_torque: R,
    /// The part of it that is feed-forward (N m).
    pub feed_forward_torque: R,
    /// Where the motor should be.
    pub motor_reference: Angle<R>,
    /// The observer's estimates.
    pub estimate: Estimate<R>,
    /// What is wrong, by name.
    pub faults: Faults,
}

/// Everything that a joint's compensator is built from; generated from a gear file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointParams<R> {
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
}

/// The built compensator of a joint.
#[derive(Clone, Debug)]
pub struct Compensator<R: Real> {
    gear: RealTimeGear<R>,
    guard: InputGuard<R>,
    motor_encoder: Encoder,
    output_encoder: Encoder,
    frozen_encoder: FrozenEncoder<R>,
    observer: Observer<R>,
    feed_forward: FeedForward<R>,
    feedback: Feedback<R>,
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
    last_motor: Angle<R>,
    observer: ObserverState<R>,
    feed_forward: FeedForwardState<R>,
    feedback: FeedbackState<R>,
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
        Ok(Compensator {
            gear: self.gear.build(Reduced::build(&self.gear.flexspline, self.gear.rated_torque)?, self.dt)?,
            guard: InputGuard::build(&self.gear, &self.limits, self.dt)?,
            motor_encoder: encoder(self.motor_encoder_bits, self.limits.motor_speed)?,
            output_encoder: encoder(
                self.output_encoder_bits,
                self.limits.output_speed(self.gear.ratio)
                    * R::from_i32(self.observer.output_encoder_period as i32),
            )?,
            frozen_encoder: FrozenEncoder::build(self.dt),
            observer: self.observer.build(&self.gear, &self.limits, self.dt)?,
            feed_forward: FeedForward::build(&self.gear, self.dt)?,
            feedback: self.feedback.build(self.dt)?,
            limits: self.limits,
        })
    }
}

impl<R: Real> Compensator<R> {
    /// The state before the first step.
    pub fn rest(&self) -> State<R> {
        State {
            guard: InputGuardState::default(),
            motor_encoder: EncoderState::default(),
            output_encoder: EncoderState::default(),
            output_zero: None,
            frozen_path: R::ZERO,
            last_motor: Angle::default(),
            observer: self.observer.rest(&self.gear),
            feed_forward: FeedForwardState::default(),
            feedback: FeedbackState::default(),
            limited: false,
        }
    }

    /// One control step.
    #[inline(never)] // The timing budget counts blocks by their symbols.
    pub fn step(&self, state: &mut State<R>, input: &Input<R>) -> Output<R> {
        let mut faults = Faults::NONE;
        let input = self.guard.step(&mut state.guard, input, &mut faults);
        let measured = self.measure(state, &input.sensors, &mut faults);
        let estimate = self.observer.step(&self.gear, &mut state.observer, &measured, &mut faults);
        let demand = self.feed_forward.step(
            &self.gear,
            &mut state.feed_forward,
            &input.setpoint,
            &input.shares,
            estimate.external_torque,
        );
        let stood_still = measured.motor == state.last_motor;
        state.last_motor = measured.motor;
        let frozen = self.frozen_encoder.step(&mut state.frozen_path, stood_still, demand.motor.velocity);
        faults.raise_if(frozen, Faults::MOTOR_ENCODER_FROZEN);
        let feedback = self.feedback.step(&mut state.feedback, measured.motor, &demand.motor, state.limited);
        let wanted = demand.torque + input.shares.feedback * feedback;
        let motor_torque = self.command(state, wanted, &mut faults);
        Output {
            motor_torque,
            feed_forward_torque: demand.torque.limit(self.limits.motor_torque),
            motor_reference: demand.motor.angle,
            estimate,
            faults,
        }
    }

    /// The sensors' raw counts as unbounded angles.
    fn measure(&self, state: &mut State<R>, sensors: &Sensors<R>, faults: &mut Faults) -> Measurement<R> {
        let (motor, believed) = self.motor_encoder.step(&mut state.motor_encoder, sensors.motor_encoder);
        faults.raise_if(!believed, Faults::MOTOR_ENCODER_JUMP);
        let output = sensors.output_encoder.and_then(|raw| {
            let (angle, output_believed) = self.output_encoder.step::<R>(&mut state.output_encoder, raw);
            faults.raise_if(!output_believed, Faults::OUTPUT_ENCODER_JUMP);
            // The two encoders are mounted at any angle to each other: the first readings that are both
            // believed are their zero, with the torsion of that moment.
            if state.output_zero.is_none() && believed && output_believed {
                let then = self.observer.output_at_reading(&self.gear, &state.observer, motor);
                state.output_zero = then.map(|then| angle.less(then));
            }
            state.output_zero.filter(|_| output_believed).map(|zero| angle.less(zero))
        });
        Measurement {
            motor,
            output,
            motor_torque: sensors.motor_torque,
            output_torque: sensors.output_torque,
        }
    }

    /// The torque that is commanded: none without a motor encoder, never more than the motor's peak.
    fn command(&self, state: &mut State<R>, wanted: R, faults: &mut Faults) -> R {
        let blind =
            faults.contains(Faults::MOTOR_ENCODER_JUMP) || faults.contains(Faults::MOTOR_ENCODER_FROZEN);
        let wanted = if blind { R::ZERO } else { wanted };
        let limited = wanted.limit(self.limits.motor_torque);
        faults.raise_if(limited != wanted, Faults::TORQUE_LIMITED);
        // The feedback's integral must not run while its torque does not reach the motor.
        state.limited = blind || limited != wanted;
        limited
    }
}
