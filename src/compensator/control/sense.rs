//! Stages that read the sensors.

use crate::angle::Angle;
use crate::branch::seldom;
use crate::compensator::estimate::observer::OutputReading;
use crate::compensator::sense::clock::Elapsed;
use crate::compensator::sense::encoder::Reading;
use crate::compensator::{Compensator, Faults, Input, State, Status};
use crate::real::Real;

impl<R: Real> Compensator<R> {
    /// Reads the sensors, in every period; the second value: the motor's count is accepted, as the one before it was.
    #[inline(always)]
    pub(super) fn read(
        &self,
        state: &mut State<R>,
        &Input { ref sensors, status, .. }: &Input<R>,
        elapsed: &Elapsed<R>,
        faults: &mut Faults,
    ) -> (Reading<R>, bool) {
        let sound = !status.contains(Status::MOTOR_ENCODER_INVALID);
        let (motor, usual) =
            self.motor_encoder.step(&mut state.motor_encoder, sensors.motor_encoder, sound, elapsed, faults);
        let motor = self.pulleys.reading(&mut state.pulleys, motor);
        let latch = &mut state.latch;
        latch.commanded += state.fallback.torque();
        latch.measured += self.guard.motor_torque(&mut state.guard, sensors.motor_torque, faults);
        latch.time += elapsed.time;
        latch.age = latch.age.saturating_add(1);
        if let Some(raw) = sensors.output_encoder
            && !status.contains(Status::OUTPUT_ENCODER_INVALID)
        {
            (latch.output, latch.age, latch.output_is_new) = (raw, 0, true);
        }
        if let Some(torque) = sensors.output_torque {
            let torque = self.guard.output_torque(&mut state.guard, torque, faults);
            (state.gauge, latch.gauge_is_new) = (Some(torque), true);
        }
        state.motor_reference.advance(state.wind_up.velocity, elapsed.time);
        state.motor_reference.position_error -= motor.moved;
        (motor, usual)
    }

    /// Corrects the observer by the output encoder's reading of its last step; false where the encoder's zero took this period.
    #[inline(always)]
    pub(super) fn read_output(&self, state: &mut State<R>, faults: &mut Faults) -> bool {
        let Some((raw, age)) = state.output_reading.take() else {
            return true;
        };
        let Reading { angle, accepted, .. } = self.output_encoder.step::<R>(&mut state.output_encoder, raw);
        faults.raise_if(!accepted, Faults::OUTPUT_ENCODER_JUMP);
        state.output_raw = Some(raw);
        // The two encoders are mounted at any angle to each other: the first readings that are both accepted tell it.
        if state.output_zero.is_none() && accepted && state.motor_encoder.is_accepted() {
            seldom();
            let then = self.observer.output_at_reading(&self.gear, &state.observer, age);
            state.output_zero = then.map(|then| self.output_zero.of(angle.less(then)));
            return false;
        }
        let unsound = Faults::OUTPUT_ENCODER_FROZEN.with(Faults::OUTPUT_ENCODER_OFF);
        let frozen = state.faults.standstill.with(state.disabled_sensors).intersects(unsound);
        if let Some(zero) = state.output_zero.filter(|_| accepted && !frozen) {
            let reading = OutputReading { angle: angle.less(zero), age };
            self.observer.correct_output(&mut state.observer, &reading, &state.gear_correction, faults);
        }
        true
    }

    /// Raises the faults of encoders that stand still: the motor's while a motion is commanded or its noise should show, the output's while
    /// the motor moves. A joint that a brake holds against its load is detected too: the shift of the output feedback is a
    /// commanded motion.
    #[inline(always)]
    pub(super) fn detect_standstill(&self, state: &mut State<R>, motor: Angle<R>) {
        let mut faults = Faults::NONE;
        let velocity = state.motor_reference.commanded_velocity();
        let stood_still = !core::mem::replace(&mut state.motor_moved, false);
        state.last_motor = motor;
        let step = self.frozen_encoder.commanded(velocity);
        let frozen = self.frozen_encoder.step(&mut state.frozen_path, stood_still, step);
        faults.raise_if(frozen && state.mode.mode().drives(), Faults::MOTOR_ENCODER_FROZEN);
        if let Some(raw) = state.output_raw.take() {
            let stood_still = state.last_output.replace(raw) == Some(raw);
            let moved = motor.minus(core::mem::replace(&mut state.motor_at_output, motor));
            self.frozen_output.step(&mut state.frozen_output_path, stood_still, moved);
        }
        faults
            .raise_if(self.frozen_output.is_frozen(state.frozen_output_path), Faults::OUTPUT_ENCODER_FROZEN);
        state.faults.standstill = faults;
    }
}
