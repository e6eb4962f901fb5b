//! Slots of the feed-forward.

use crate::angle::Angle;
use crate::branch::seldom;
use crate::compensator::estimate::observer::{GearCorrection, ObserverState};
use crate::compensator::reference::command::{CommandStatus, Following, Found, Target};
use crate::compensator::reference::measured_feedback::MeasuredError;
use crate::compensator::reference::motor_reference::MotorReference;
use crate::compensator::reference::output_feedback::OutputError;
use crate::compensator::schedule::OBSERVER_PERIODS;
use crate::compensator::{Compensator, Faults, Input, Setpoint, State};
use crate::real::{RADIANS_PER_COUNT, Real};

impl<R: Real> Compensator<R> {
    /// The feed-forward's slot; false where the command took this period, and the rest is left to the next.
    #[inline(always)]
    pub(super) fn plan(&self, state: &mut State<R>, input: &Input<R>, motor: Angle<R>) -> bool {
        let target = if let Some(found) = state.found.take() {
            seldom();
            state.commander.target_after(found, state.latch.time)
        } else {
            let target = self.target(state, input);
            if target.detours {
                seldom();
                state.found = Some(Found { time: state.latch.time, switched: target.switched });
                return false;
            }
            target
        };
        self.follow(state, &target, motor);
        true
    }

    /// The target of this round's command.
    #[inline(always)]
    fn target(&self, state: &mut State<R>, input: &Input<R>) -> Target<R> {
        let mut faults = Faults::NONE;
        let command = self.guard.command(&mut state.guard, &input.command, &mut faults);
        let time = core::mem::take(&mut state.since_plan);
        let status = CommandStatus {
            time,
            age: input.setpoint_age,
            readable: !faults.contains(Faults::INPUT_NOT_FINITE),
        };
        let gravity = state.learning.gravity_torque();
        let (observer, gear_correction) = (&state.observer, &state.gear_correction);
        let now = || self.output_now(observer, gear_correction);
        let controlled =
            state.motor_reference.closed && state.mode.mode().drives() && state.fallback.trusted();
        let following = Following {
            error: state.motor_reference.position_error,
            limited: state.limited && controlled,
            velocity: state.observer.output_velocity(),
            load: state.observer.external_torque() + gravity,
        };
        let target = self.commander.step(&mut state.commander, &command, status, following, now, &mut faults);
        state.faults.plan = faults;
        target
    }

    /// The feed-forward and the feedback of the output for a target.
    #[inline(always)]
    fn follow(&self, state: &mut State<R>, target: &Target<R>, motor: Angle<R>) {
        let gravity = state.learning.gravity_torque();
        let setpoint = &target.setpoint;
        let gains = state.guard.gains();
        let rests = setpoint.velocity == R::ZERO;
        let load = self.disturbance.compensated_load(&state.disturbance);
        let correction = self.learning.correction(&state.learning, load, gains);
        let demand =
            self.feed_forward.step(&self.gear, &mut state.feed_forward, setpoint, gains, &correction);
        let position_error = demand.motor.angle.minus(motor);
        // Extrapolates the estimate of a period ago. Its speed is that of the middle of the observer's period.
        let speed_behind = R::lit(1.0 + 0.5 * OBSERVER_PERIODS as f64) * self.dt;
        let velocity = state.observer.output_velocity() + speed_behind * setpoint.acceleration;
        let reads = self.observer.output_innovation(&state.observer).is_some();
        let newest = self.measured_error(state, setpoint).filter(|_| reads);
        let mean = self.measured_feedback.mean(&state.measured_feedback);
        let estimated = || {
            let (observer, correction) = (&state.observer, &state.gear_correction);
            demand.link_offset + self.observer.output_offset(observer, correction, position_error, self.dt)
        };
        let error = OutputError {
            position: newest.map_or_else(estimated, |newest| mean.unwrap_or(newest.error)),
            velocity: velocity - setpoint.velocity,
            setpoint_velocity: setpoint.velocity,
            torque: self.observer.transmitted(&state.observer)
                - state.observer.output_friction()
                - (demand.accelerating - self.behind * demand.accelerating_rate)
                + self.disturbance.whole_load(&state.disturbance)
                + gravity,
            measures: newest.is_some(),
        };
        let supervised = state.supervisor.gain();
        let shift = self.output_feedback.step(&mut state.output_feedback, &error, supervised);
        let gain = gains.output_feedback * R::from_i32(self.gear.ratio().n());
        let followed = newest.filter(|_| self.output_feedback.is_slow(setpoint.velocity));
        let measured_gain = supervised * gain;
        self.measured_feedback.plan(&mut state.measured_feedback, followed, setpoint.velocity, measured_gain);
        if target.switched {
            seldom();
            self.fallback.begin_ramp(&mut state.fallback);
        }
        state.motor_reference = MotorReference {
            position_error: position_error + gain * shift.angle,
            velocity: demand.motor.velocity + gain * shift.rate,
            acceleration: demand.acceleration,
            jerk: demand.jerk,
            acceleration_gain: gains.wind_up,
            torque: demand.torque,
            torque_rate: demand.torque_rate,
            transmission: demand.transmission,
            wind_up_compliance: demand.wind_up_compliance,
            output_torque: target.torque,
            rests: rests && target.torque.is_none(),
            switched: target.switched,
            planned: true,
            closed: target.torque.is_none(),
        };
        let position = newest.map(|newest| newest.error);
        self.learning.follow(&mut state.learning, &demand.excitation, position);
    }

    /// Estimated angle and speed (rad/s) of the output, where a reference begins.
    #[cold]
    #[inline(never)]
    fn output_now(&self, observer: &ObserverState<R>, correction: &GearCorrection<R>) -> (Angle<R>, R) {
        self.observer.output(observer, correction)
    }

    /// Output encoder's newest reading less the setpoint of its time, where it is near the last accepted one.
    #[inline(always)]
    fn measured_error(&self, state: &State<R>, setpoint: &Setpoint<R>) -> Option<MeasuredError<R>> {
        let phase = self.output_encoder.phase(state.latch.output);
        let zero = state.output_zero.filter(|_| self.output_encoder.is_near(&state.output_encoder, phase))?;
        let counts = phase.wrapping_sub(zero.phase()).wrapping_sub(setpoint.position.phase()).cast_signed();
        let late = R::from_i32((state.latch.age + self.observer.output_delay()).cast_signed()) * self.dt;
        let error = R::from_i32(counts) * R::lit(RADIANS_PER_COUNT) + late * setpoint.velocity;
        Some(MeasuredError { phase, error })
    }

    /// The slot of the feed-forward's models.
    #[inline(always)]
    pub(super) fn model(&self, state: &mut State<R>, motor: Angle<R>) {
        let reference = state.motor_reference.reference(motor);
        let factors = state.learning.applied();
        self.feed_forward.step_models(&self.gear, &mut state.feed_forward, reference, factors);
        let (position, gains) = (state.commander.position(), state.guard.gains());
        self.learning.step_models(&mut state.learning, reference, position, gains);
    }
}
