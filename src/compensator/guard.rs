//! What stands between the outside and the control step: its inputs are finite and bounded.
//!
//! A value that is not finite is replaced by its last finite one; the setpoint's fraction of a count by 0.
//! The setpoint's derivatives are limited to what the joint can do, and reported:
//!
//! ```text
//! |dq| <= motor_speed/|n|,   |ddq| <= 2*motor_torque*|n|/(J_fs + n^2*J_wg),   |dddq| <= that/dt,
//! |ddddq| <= that/dt,   n = 1/r
//! ```
//!
//! Measured torques are limited to twice the peak torque of motor and gear: a torque sensor that says
//! more is off its range; a commanded torque ends at the gear's peak torque. The shares, those of the direction of
//! motion, are limited to 0..=1 and follow their command at 1 per 10 ms, so that
//! switching one makes no step in the output. The setpoint's position may be any angle; the feedback's
//! answer to a jump of it ends at the motor's torque, and is ramped ([`crate::compensator::fallback`]). Units: rad, N m, s; signs as in [`crate::gear`].

use crate::compensator::command::{Command, angle_of};
use crate::compensator::directions::Crossover;
use crate::compensator::faults::Faults;
use crate::compensator::{Input, Limits, Sensors, Setpoint, Shares};
use crate::error::{Error, require};
use crate::gear::GearParams;
use crate::real::Real;

/// Time in which a share goes from 0 to 1 (s).
const SHARE_RAMP: f64 = 0.01;

/// The built guard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputGuard<R> {
    velocity: R,
    acceleration: R,
    jerk: R,
    snap: R,
    motor_torque: R,
    output_torque: R,
    peak_output_torque: R,
    share_step: R,
    crossover: Crossover<R>,
}

/// The last input that passed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InputGuardState<R> {
    passed: Passed<R>,
}

/// What passed the guard.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Passed<R> {
    /// The joint's sensors.
    pub sensors: Sensors<R>,
    /// The outer controller's wish.
    pub command: Command<R>,
    /// What is switched on now, in the direction of the motion.
    pub shares: Shares<R>,
}

/// What the rest of the step knows of the shares.
#[derive(Clone, Copy, Debug)]
pub struct Course<R> {
    /// Speed of the reference of the output (rad/s).
    pub velocity: R,
    /// What is compensated may rest on the model.
    pub trusted: bool,
}

impl<R: Real> InputGuard<R> {
    /// Prepares the guard for the control period dt (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `dt` or `flexspline_inertia` unless finite and positive.
    pub fn build(gear: &GearParams<R>, limits: &Limits<R>, dt: R) -> Result<Self, Error> {
        require(dt.is_finite() && dt > R::ZERO, "dt")?;
        let n = R::from_i32(gear.ratio).abs();
        let inertia = gear.flexspline_inertia + gear.wave_generator_inertia * n * n;
        require(inertia.is_finite() && inertia > R::ZERO, "flexspline_inertia")?;
        let acceleration = R::lit(2.0) * limits.motor_torque * n / inertia;
        Ok(Self {
            velocity: limits.output_speed(gear.ratio),
            acceleration,
            jerk: acceleration / dt,
            snap: acceleration / (dt * dt),
            motor_torque: R::lit(2.0) * limits.motor_torque,
            output_torque: R::lit(2.0) * limits.output_torque,
            peak_output_torque: limits.output_torque,
            share_step: dt * R::lit(1.0 / SHARE_RAMP),
            crossover: Crossover::build(limits.output_speed(gear.ratio)),
        })
    }

    /// Largest acceleration of a setpoint (rad/s^2).
    pub fn acceleration(&self) -> R {
        self.acceleration
    }

    /// The input as the control step may use it.
    pub fn step(
        &self,
        state: &mut InputGuardState<R>,
        input: &Input<R>,
        course: Course<R>,
        faults: &mut Faults,
    ) -> Passed<R> {
        let last = &state.passed;
        let torque =
            |value: R, held: R, bound: R, faults: &mut Faults| finite(value, held, faults).limit(bound);
        let sensors = Sensors {
            motor_torque: torque(
                input.sensors.motor_torque,
                last.sensors.motor_torque,
                self.motor_torque,
                faults,
            ),
            output_torque: input.sensors.output_torque.map(|value| {
                let held = last.sensors.output_torque.unwrap_or(R::ZERO);
                torque(value, held, self.output_torque, faults)
            }),
            ..input.sensors
        };
        let command = self.command(&input.command, &last.command, faults);
        let shares = self.shares(input, &last.shares, course, faults);
        state.passed = Passed { sensors, command, shares };
        state.passed
    }

    /// The command within what the joint can do; what is not finite is as it was last commanded.
    fn command(&self, command: &Command<R>, last: &Command<R>, faults: &mut Faults) -> Command<R> {
        match *command {
            Command::Position(wanted) => {
                let held = match *last {
                    Command::Position(setpoint) => setpoint,
                    _ => Setpoint::default(),
                };
                let position = angle_of(wanted.position, faults);
                Command::Position(Setpoint {
                    position,
                    velocity: bounded(wanted.velocity, held.velocity, self.velocity, faults),
                    acceleration: bounded(wanted.acceleration, held.acceleration, self.acceleration, faults),
                    jerk: bounded(wanted.jerk, held.jerk, self.jerk, faults),
                    snap: bounded(wanted.snap, held.snap, self.snap, faults),
                })
            }
            Command::Velocity { velocity, acceleration } => {
                let held = match *last {
                    Command::Velocity { velocity, .. } => velocity,
                    _ => R::ZERO,
                };
                Command::Velocity {
                    velocity: bounded(velocity, held, self.velocity, faults),
                    acceleration: bounded(acceleration, R::ZERO, self.acceleration, faults),
                }
            }
            Command::Torque(wanted) => {
                let held = match *last {
                    Command::Torque(torque) => torque,
                    _ => R::ZERO,
                };
                Command::Torque(bounded(wanted, held, self.peak_output_torque, faults))
            }
        }
    }

    /// The shares on their way to what is commanded for the direction of the motion.
    fn shares(&self, input: &Input<R>, now: &Shares<R>, course: Course<R>, faults: &mut Faults) -> Shares<R> {
        let w = self.crossover.forward(course.velocity);
        let (f, b) = (&input.shares.forward, &input.shares.backward);
        let model = if course.trusted { R::ONE } else { R::ZERO };
        let mut share = |forward: R, backward: R, now: R, trust: R| {
            let wanted = finite(backward + w * (forward - backward), now, faults);
            now + (trust * wanted.max(R::ZERO).min(R::ONE) - now).limit(self.share_step)
        };
        Shares {
            feedback: share(f.feedback, b.feedback, now.feedback, R::ONE),
            inertia: share(f.inertia, b.inertia, now.inertia, model),
            friction: share(f.friction, b.friction, now.friction, model),
            wind_up: share(f.wind_up, b.wind_up, now.wind_up, model),
            kinematic_error: share(f.kinematic_error, b.kinematic_error, now.kinematic_error, model),
        }
    }
}

/// A finite value within its bound.
#[inline(always)]
fn bounded<R: Real>(value: R, held: R, bound: R, faults: &mut Faults) -> R {
    let value = finite(value, held, faults);
    let limited = value.limit(bound);
    faults.raise_if(limited != value, Faults::SETPOINT_LIMITED);
    limited
}

/// A value, or what was held when it is not finite.
#[inline(always)]
fn finite<R: Real>(value: R, held: R, faults: &mut Faults) -> R {
    faults.raise_if(!value.is_finite(), Faults::INPUT_NOT_FINITE);
    value.finite_or(held)
}

/// Path that the motor may be asked to move while its encoder stands still (rad).
const MOTOR_PATH: f64 = 0.5;

/// The same while the output's encoder does: more than winds up the gear from one peak torque to the other.
const OUTPUT_PATH: f64 = 2.0;

/// Notices an encoder that stands still while the motor is asked to move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrozenEncoder<R> {
    dt: R,
    farthest: R,
}

impl<R: Real> FrozenEncoder<R> {
    /// The motor's, for the control period dt (s).
    pub fn of_motor(dt: R) -> Self {
        Self { dt, farthest: R::lit(MOTOR_PATH) }
    }

    /// The output's.
    pub fn of_output(dt: R) -> Self {
        Self { dt, farthest: R::lit(OUTPUT_PATH) }
    }

    /// Adds to the path while the encoder stands still; true once the path is too long.
    #[inline]
    pub fn step(&self, path: &mut R, stood_still: bool, velocity: R) -> bool {
        *path = if stood_still { (*path + self.dt * velocity.abs()).min(self.farthest) } else { R::ZERO };
        *path >= self.farthest
    }
}
