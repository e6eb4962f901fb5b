//! Slots of the observer and of the checks.

use crate::angle::Angle;
use crate::compensator::estimate::observer::Measurement;
use crate::compensator::reference::motor_reference::MotorReference;
use crate::compensator::schedule::Slot;
use crate::compensator::sense::rotor::RotorInput;
use crate::compensator::{Compensator, Directions, Faults, State};
use crate::real::Real;

impl<R: Real> Compensator<R> {
    /// The observer's slot.
    #[inline(always)]
    pub(super) fn observe(&self, state: &mut State<R>, gains: &Directions<R>, motor: Angle<R>) {
        let reads_output = state.slot == Slot::ObserveOutput && {
            state.backward_has_settled = self.guard.have_settled(&state.guard, &gains.backward);
            self.correct_gear(state);
            self.keep_output_reading(state)
        };
        let mut faults = Faults::NONE;
        let ([commanded, measured], period) = state.latch.take_torques();
        let measured = self.pulleys.at_wave_generator(measured);
        let feedback = state.guard.gains().feedback;
        let motor_torque = self.motor_torque.step(&mut state.motor_torque, commanded, feedback, measured);
        state.rotor.add([motor_torque, state.motor_torque.drive_error()], period, motor);
        state.since_plan += period;
        state.motor_moved |= motor.counts != state.last_motor.counts;
        let reads_gauge = core::mem::take(&mut state.latch.gauge_is_new)
            && !state.disabled_sensors.contains(Faults::TORQUE_SENSOR_OFF);
        let measured = Measurement {
            motor,
            motor_speed: self.motor_encoder.speed(&state.motor_encoder),
            reads_output,
            period,
            motor_torque,
            output_torque: if reads_gauge { state.gauge } else { None },
        };
        self.observer.step(
            &self.gear,
            &mut state.observer,
            &measured,
            &state.gear_correction,
            state.motor_reference.rests,
            &mut faults,
        );
        state.gear_correction.load += state.load_rate;
        self.disturbance.step_fast(&mut state.disturbance, state.observer.external_torque());
        state.wind_up = self.disturbance.wind_up(&state.disturbance);
        state.faults.observer = faults;
        if state.slot == Slot::Observe {
            self.compare_torsions(state);
        }
    }

    /// Compares the torsion by the output encoder, as of the last correction, with the rotor's.
    #[inline(always)]
    fn compare_torsions(&self, state: &mut State<R>) {
        if state.output_zero.is_none() {
            return;
        }
        if let Some(innovation) = self.observer.output_innovation(&state.observer) {
            let torsion = state.observer.torsion() - innovation;
            let disagrees = self.rotor.torsion_disagrees(&mut state.rotor, torsion);
            state.disabled_sensors = state.disabled_sensors.with(disagrees);
        }
    }

    /// Keeps the output encoder's reading of this period, which [`Self::check`] corrects the observer by; whether there is one.
    #[inline(always)]
    fn keep_output_reading(&self, state: &mut State<R>) -> bool {
        let latch = &mut state.latch;
        let is_new = core::mem::take(&mut latch.output_is_new);
        let reads = is_new && (latch.age == 0 || self.observer.looks_back());
        state.output_reading = reads.then_some((latch.output, latch.age));
        reads
    }

    /// Compares the balance of the rotor with its reference, the drive and the torque sensor; learns the ripple. False where the
    /// output encoder's zero took this period, and all of that is left to the next.
    #[inline(always)]
    pub(super) fn check(&self, state: &mut State<R>) -> bool {
        let mut faults = Faults::NONE;
        if !self.read_output(state, &mut faults) {
            return false;
        }
        let runs = !state.limited && state.supervisor.gain() == R::ONE;
        let MotorReference { rests, position_error, .. } = state.motor_reference;
        let motor_lag = if rests { position_error.dead_zone(self.rounding) } else { R::ZERO };
        let at_output = self.gear.ratio().rounded::<R>() * motor_lag;
        self.output_feedback.integrate(&mut state.output_feedback, at_output, runs);
        let reference = &state.motor_reference;
        state.followed = self.braking.gain(reference.position_error);
        // With a feedback gain below 1 another controller moves the motor.
        let controlled = reference.planned && reference.output_torque.is_none();
        let driven = state.mode.mode().drives() && state.guard.gains().feedback == R::ONE;
        let input = RotorInput {
            motor: state.observer.motor(),
            reference: controlled.then_some([state.followed * reference.position_error, reference.velocity]),
            driven,
        };
        self.rotor.step(&mut state.rotor, &input, &mut faults);
        let [torque, rate, friction] = state.rotor.gear();
        self.protection.follow(&mut state.protection, torque, rate, friction);
        if state.output_zero.is_some() {
            faults.raise_if(state.latch.age > self.output_lost, Faults::OUTPUT_ENCODER_LOST);
        }
        if let Some(gauge) = state.gauge {
            state.disabled_sensors =
                state.disabled_sensors.with(self.rotor.gauge_disagrees(&mut state.rotor, gauge));
        }
        state.faults.rotor = faults.with(state.disabled_sensors);
        state.faults.collect();
        self.learning.learn_ripple(&mut state.learning);
        true
    }
}
