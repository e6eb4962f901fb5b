//! Slots of the observer and of the checks.

use crate::angle::Angle;
use crate::compensator::estimate::observer::Measurement;
use crate::compensator::reference::motor_reference::MotorReference;
use crate::compensator::schedule::OBSERVER_PERIODS;
use crate::compensator::sense::rotor::RotorInput;
use crate::compensator::{Compensator, Faults, State};
use crate::real::Real;

impl<R: Real> Compensator<R> {
    /// The observer's slot.
    #[inline(never)] // The timing budget counts this slot by its symbol.
    pub(super) fn observe(&self, state: &mut State<R>, motor: Angle<R>, reads_output: bool) {
        let mut faults = Faults::NONE;
        let torques = [state.latch.motor_torque, state.latch.drive_errors];
        state.rotor.add(torques, state.latch.time, motor);
        state.since_plan += state.latch.time;
        state.motor_moved |= motor.counts != state.last_motor.counts;
        let gauge = state.latch.output_torque.take();
        let measured = Measurement {
            motor,
            reads_output,
            period: state.latch.time,
            motor_torque: R::lit(1.0 / OBSERVER_PERIODS as f64) * state.latch.motor_torque,
            output_torque: gauge.filter(|_| !state.disabled_sensors.contains(Faults::TORQUE_SENSOR_OFF)),
        };
        (state.latch.motor_torque, state.latch.drive_errors, state.latch.time) = (R::ZERO, R::ZERO, R::ZERO);
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
    }

    /// Compares the balance of the rotor with its reference, the drive and the sensors at the output; learns the ripple.
    #[inline(always)]
    pub(super) fn check(&self, state: &mut State<R>) {
        let mut faults = Faults::NONE;
        let runs = !state.limited && state.supervisor.gain() == R::ONE;
        let MotorReference { rests, position_error, .. } = state.motor_reference;
        let motor_lag = if rests { position_error.dead_zone(self.rounding) } else { R::ZERO };
        let at_output = self.gear.ratio().rounded::<R>() * motor_lag;
        self.output_feedback.integrate(&mut state.output_feedback, at_output, runs);
        // In the round that finds the zero nothing is compared with it yet: that takes time, and all of it agrees by construction.
        let has_zero = state.output_zero.is_some();
        self.read_output(state, &mut faults);
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
        if has_zero {
            if let Some(innovation) = self.observer.output_innovation(&state.observer) {
                let torsion = state.observer.torsion() - innovation;
                state.disabled_sensors =
                    state.disabled_sensors.with(self.rotor.torsion_disagrees(&mut state.rotor, torsion));
            }
            faults.raise_if(state.latch.age > self.output_lost, Faults::OUTPUT_ENCODER_LOST);
        }
        if let Some(gauge) = state.gauge {
            state.disabled_sensors =
                state.disabled_sensors.with(self.rotor.gauge_disagrees(&mut state.rotor, gauge));
        }
        state.faults.rotor = faults.with(state.disabled_sensors);
        state.faults.collect();
        self.learning.learn_ripple(&mut state.learning);
    }
}
