//! Parameters of a joint's compensator, checked and built.
//!
//! Each part checks its own. Common to them, and set here: the period that each of them runs with
//! ([`crate::compensator::schedule`]), and the largest motion of the encoders between two evaluated readings.

use crate::belt::{SeriesBelt, SeriesBeltParams};
use crate::compensator::actuate::braking::Braking;
use crate::compensator::actuate::cascade::FeedbackParams;
use crate::compensator::actuate::fallback::Fallback;
use crate::compensator::actuate::protection::Protection;
use crate::compensator::actuate::supervisor::Supervisor;
use crate::compensator::adapt::learning::{LearningParams, Learnt};
use crate::compensator::estimate::disturbance::DisturbanceParams;
use crate::compensator::estimate::observer::ObserverParams;
use crate::compensator::reference::command::Commander;
use crate::compensator::reference::feed_forward::FeedForward;
use crate::compensator::reference::measured_feedback::{MeasuredFeedback, MeasuredFeedbackParams};
use crate::compensator::reference::output_feedback::{OutputFeedback, OutputFeedbackParams};
use crate::compensator::schedule::{OBSERVER_PERIODS, SLOW_PERIODS};
use crate::compensator::sense::clock::Clock;
use crate::compensator::sense::encoder::EncoderParams;
use crate::compensator::sense::motor_encoder::MotorEncoder;
use crate::compensator::sense::motor_torque::MotorTorque;
use crate::compensator::sense::output_zero::OutputZero;
use crate::compensator::sense::pulleys::Pulleys;
use crate::compensator::sense::rotor::Rotor;
use crate::compensator::sense::validation::{FrozenEncoder, InputGuard};
use crate::compensator::tuned::UNCERTAINTY_MARGIN;
use crate::compensator::{Compensator, Limits, Tolerances};
use crate::error::{Error, require};
use crate::flexspline::Reduced;
use crate::gear::GearParams;
use crate::real::Real;

/// Everything that a joint's compensator is built from; generated from a gear file.
///
/// `strainwave export` builds it on the host; firmware reads the result by [`Compensator::from_words`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointParams<R: Real> {
    /// Control period (s).
    pub dt: R,
    /// The gear; behind a belt the inertia of its wave generator is that of all in front of it, as it is there.
    pub gear: GearParams<R>,
    /// The tooth belt between motor and wave generator, where there is one.
    pub belt: Option<SeriesBeltParams<R>>,
    /// Resolution of the motor encoder, 2^bits counts a revolution.
    pub motor_encoder_bits: u32,
    /// Control periods for which the motor encoder at rest tells the same count at most, for its noise changes it; `None` where it may for ever.
    pub motor_encoder_still: Option<u32>,
    /// Resolution of the output encoder, 2^bits counts a revolution.
    pub output_encoder_bits: u32,
    /// Output encoder's reading where that of the motor's is 0 (rad, -pi..=pi), where it is known ([`OutputZero`]).
    pub output_encoder_zero: Option<R>,
    /// Limits of motor and gear.
    pub limits: Limits<R>,
    /// How well the joint is known.
    pub tolerances: Tolerances<R>,
    /// Time in which a sound drive reaches its command, 0..=0.1 (s).
    pub drive_response: R,
    /// The observer's gains.
    pub observer: ObserverParams<R>,
    /// The disturbance path.
    pub disturbance: DisturbanceParams<R>,
    /// The motor-side cascade.
    pub feedback: FeedbackParams<R>,
    /// Output feedback without and with an output encoder.
    pub output_feedback: [OutputFeedbackParams<R>; 2],
    /// Output feedback by the measured angle.
    pub measured_feedback: MeasuredFeedbackParams<R>,
    /// Adaptation and ripple.
    pub learning: LearningParams<R>,
    /// Learnt factors and ripple to start from.
    pub learnt: Learnt<R>,
}

impl<R: Real> JointParams<R> {
    /// Checks every parameter once and precomputes the constants of the step.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the name of the first parameter that is out of its range.
    pub fn build(&self) -> Result<Compensator<R>, Error> {
        self.limits.check()?;
        self.tolerances.check()?;
        require(self.drive_response >= R::ZERO && self.drive_response <= R::lit(0.1), "drive_response")?;
        let stretch = self.belt.as_ref().map_or(Ok(SeriesBelt::NONE), SeriesBeltParams::build)?;
        let pulleys = Pulleys::build(self.belt.as_ref());
        require(!stretch.stretches() || stretch.contracts(&self.gear), "belt_compliance")?;
        let limits = &pulleys.limits_at_wave_generator(&self.limits);
        let encoder = |bits, speed| EncoderParams { bits, speed_limit: R::lit(2.0) * speed }.build(self.dt);
        let count = |bits: u32| R::lit(core::f64::consts::TAU) / R::from_i32(1 << bits.min(30));
        let motor_count = pulleys.ratio() * count(self.motor_encoder_bits);
        let guard = InputGuard::build(&self.gear, limits, self.dt)?.in_front_of(&pulleys);
        let n = self.gear.ratio;
        let [observed, round] =
            [OBSERVER_PERIODS, SLOW_PERIODS].map(|periods| R::from_i32(periods as i32) * self.dt);
        // Periods between readings of the output encoder that the observer uses.
        let readings = R::from_i32(self.observer.output_encoder_period.max(SLOW_PERIODS) as i32);
        let still = self.motor_encoder_still.map(|periods| R::from_i32(periods as i32) * self.dt);
        require(still.is_none_or(R::is_positive), "motor_encoder_still")?;
        let protection = Protection::build(&self.gear, limits, &self.tolerances, self.dt);
        let line = self.gear.flexspline.line.build()?;
        let count_out = count(self.output_encoder_bits);
        // The farthest that a sound output comes from its motor, from one peak torque to the other.
        let apart =
            R::lit(UNCERTAINTY_MARGIN.get()) * (R::lit(2.0) * line.torsion(limits.output_torque) + count_out);
        let commander = Commander::build(&self.gear, limits, &self.feedback, &protection, round)?;
        let acceleration = commander.acceleration() * R::from_i32(n).abs();
        Ok(Compensator {
            gear: self.gear.build(Reduced::build(&self.gear.flexspline, self.gear.rated_torque)?, self.dt)?,
            commander,
            clock: Clock::build(self.dt)?,
            guard,
            motor_encoder: MotorEncoder::build(self.motor_encoder_bits, &self.gear, limits, self.dt)?
                .in_front_of(&pulleys),
            output_encoder: encoder(self.output_encoder_bits, limits.output_speed(n) * readings)?,
            output_zero: OutputZero::build(self.output_encoder_zero, n)?,
            frozen_encoder: FrozenEncoder::of_motor(round + round, still),
            frozen_output: FrozenEncoder::of_output(R::from_i32(n).abs() * apart),
            observer: self.observer.build(&self.gear, limits, &self.tolerances, self.dt)?.behind(stretch),
            disturbance: self.disturbance.build(&self.gear, self.dt)?,
            feed_forward: FeedForward::build(&self.gear, self.dt)?
                .with_motor(&self.gear, limits.motor_torque)
                .behind(stretch),
            feedback: self.feedback.build(self.dt)?,
            estimates_speed: self.feedback.estimates_speed(motor_count, self.dt),
            braking: Braking::build(self.feedback.position_gain, acceleration),
            output_feedback: OutputFeedback::build(
                &self.output_feedback,
                self.gear.flexspline_inertia,
                limits.output_speed(n),
                count_out,
                apart,
                round,
            )?,
            measured_feedback: MeasuredFeedback::build(
                &self.measured_feedback,
                limits.output_speed(n),
                count_out,
                [self.dt, observed],
            )?,
            learning: self.learning.build(&self.gear, limits, self.dt)?,
            learnt: self.learnt,
            pulleys,
            motor_torque: MotorTorque::build(limits.motor_torque, observed)?,
            rotor: Rotor::build(
                &self.gear,
                limits,
                &self.tolerances,
                [motor_count, count_out],
                self.drive_response,
                self.feedback.position_gain,
                self.dt,
            )?,
            supervisor: Supervisor::build(&self.gear, limits.motor_torque, motor_count, self.dt),
            protection,
            fallback: Fallback::build(limits.motor_torque, self.dt),
            limits: *limits,
            dt: self.dt,
            output_lost: (4 * self.observer.output_encoder_period.min(1 << 20)).max(10),
            behind: observed + self.dt,
            rounding: R::lit(0.5) * motor_count,
        })
    }
}
