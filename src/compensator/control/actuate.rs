//! Torque command of every control period.

use crate::branch::seldom;
use crate::compensator::actuate::cascade::CascadeInput;
use crate::compensator::actuate::mode::Mode;
use crate::compensator::reference::motor_reference::MotorReference;
use crate::compensator::schedule::OBSERVER_PERIODS;
use crate::compensator::sense::clock::Elapsed;
use crate::compensator::tuned::ENCODER_NOISE;
use crate::compensator::{Compensator, Faults, State, Status};
use crate::real::Real;

impl<R: Real> Compensator<R> {
    /// The mode with this step's faults, to which a latched cause is added; true where it was Safe and is. Of a drive that is switched on
    /// with this step the reference begins at the output's angle.
    #[cold]
    #[inline(never)]
    pub(super) fn step_mode(&self, state: &mut State<R>, faults: &mut Faults, status: Status) -> bool {
        let before = state.mode.mode();
        let after = state.mode.step(faults, status);
        if !before.drives() && after.drives() {
            state.found = None;
            state.commander = Default::default();
            state.feedback = Default::default();
            state.output_feedback = Default::default();
            state.measured_feedback = Default::default();
            state.motor_reference = Default::default();
        }
        [before, after] == [Mode::Safe; 2]
    }

    /// No torque (N m), of a drive that is off: none that could be limited.
    #[inline(always)]
    pub(super) fn without_torque(&self, state: &mut State<R>, mut faults: Faults) -> R {
        self.fallback.step(&mut state.fallback, R::ZERO, &mut faults, &state.protection);
        state.fallback.sent(R::ZERO);
        state.limited = true;
        R::ZERO
    }

    /// Supervises the feedback functions and the whole loop, once a round.
    #[inline(always)]
    pub(super) fn supervise(&self, state: &mut State<R>) {
        let mut faults = Faults::NONE;
        let MotorReference { closed, rests, .. } = state.motor_reference;
        let torque = if closed { state.fallback.torque() } else { R::ZERO };
        let torsion = state.observer.torsion();
        self.supervisor.step(&mut state.supervisor, torsion, torque, rests, &mut faults);
        if state.swings.step(torque, self.limits.motor_torque) {
            seldom();
            faults.raise_if(state.supervisor.gain() == R::ZERO, Faults::LIMIT_CYCLE);
            self.supervisor.take_away(&mut state.supervisor);
        }
        state.faults.supervisor = faults;
    }

    /// Torque command of the cascade, in every period; `measures`: this one is a step of the feedback of the measured angle.
    #[inline(always)]
    pub(super) fn drive(
        &self,
        state: &mut State<R>,
        elapsed: &Elapsed<R>,
        measures: bool,
        faults: &mut Faults,
    ) -> R {
        let mut shift = state.measured_feedback.advance(elapsed.time);
        if measures {
            let read = state.latch.age < OBSERVER_PERIODS;
            let phase = read.then(|| self.output_encoder.phase(state.latch.output));
            shift = self.measured_feedback.step(&mut state.measured_feedback, phase);
        }
        let speed = self.motor_speed(state);
        let (reference, wind_up) = (&state.motor_reference, &state.wind_up);
        let position_error = state.followed * reference.position_error;
        let input = CascadeInput {
            position_error: reference.beyond_rounding(position_error + shift, self.rounding),
            velocity: reference.velocity + wind_up.velocity,
            acceleration: reference.acceleration_gain * reference.acceleration + wind_up.acceleration,
        };
        let held = state.limited || !reference.closed;
        let stiffness = state.supervisor.stiffness();
        let feedback =
            self.feedback.step(&mut state.feedback, speed, &input, stiffness, held) + wind_up.torque;
        let closed = if reference.closed {
            state.guard.gains().feedback * self.taken_over(state, feedback)
        } else {
            seldom();
            let torque = reference.transmission * reference.output_torque.unwrap_or_default();
            state.motor_reference.switched = false;
            torque
        };
        self.command(state, state.motor_reference.torque + closed, faults)
    }

    /// Speed of the motor (rad/s): by the last two readings of its encoder, or of a resting motor with a coarse encoder the
    /// observer's. Farther than [`ENCODER_NOISE`] from its reference it is controlled by what is measured: an observer that
    /// is wrong moves it by no more than that.
    #[inline(always)]
    fn motor_speed(&self, state: &State<R>) -> R {
        let reference = &state.motor_reference;
        if self.estimates_speed && reference.rests && state.fallback.trusted() {
            let near = R::lit(2.0 * ENCODER_NOISE.get()) * self.rounding;
            if reference.position_error.is_within(near) {
                return state.observer.motor_velocity();
            }
        }
        self.motor_encoder.speed(&state.motor_encoder)
    }

    /// The feedback, which goes on from the torque (N m) so far when it was switched to.
    fn taken_over(&self, state: &mut State<R>, feedback: R) -> R {
        if !state.motor_reference.switched {
            return feedback;
        }
        seldom();
        state.motor_reference.switched = false;
        let difference = state.fallback.torque() - state.motor_reference.torque - feedback;
        feedback + self.feedback.take_over(&mut state.feedback, difference)
    }

    /// The torque command: `target` (N m) limited to the motor's peak torque and to the gear's rating.
    fn command(&self, state: &mut State<R>, target: R, faults: &mut Faults) -> R {
        let limited = state.protection.limit(target, faults);
        let torque = self.fallback.step(&mut state.fallback, limited, faults, &state.protection);
        // The feedback's integral must not run while its torque does not reach the motor.
        state.limited = torque != target;
        torque
    }
}
