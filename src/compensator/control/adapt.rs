//! Slot of the adaptation and of what is slow.

use crate::angle::Angle;
use crate::compensator::adapt::parameters::{Factors, Observed};
use crate::compensator::estimate::disturbance::DisturbanceInput;
use crate::compensator::schedule::SlowSlot;
use crate::compensator::sense::validation::CommandedMotion;
use crate::compensator::{Compensator, Directions, Faults, State};
use crate::real::Real;

impl<R: Real> Compensator<R> {
    /// The slot of the slow disturbance estimate, of the feed-forward's line and hysteresis, and of the adaptation.
    #[inline(always)]
    pub(super) fn learn(&self, state: &mut State<R>, gains: &Directions<R>, motor: Angle<R>) {
        let supervised = state.supervisor.gain();
        let joint = DisturbanceInput {
            motor_torque: state.motor_reference.torque,
            rests: state.commander.velocity() == R::ZERO,
            compliance: supervised * state.motor_reference.wind_up_compliance,
            gain: supervised * state.guard.gains().wind_up,
            gravity: state.learning.gravity_torque(),
            supervised,
        };
        let external_torque = state.observer.external_torque();
        self.disturbance.step_slow(&mut state.disturbance, external_torque, &joint);
        self.feed_forward.step_torsion(&self.gear, &mut state.feed_forward, state.learning.applied());
        let learns = state.learns();
        state.learning.keep_for_ripple(learns);
        let trusted = state.fallback.trusted();
        let falls_back = !trusted && !self.guard.model_is_off(&state.guard);
        let mut settled = false;
        match if falls_back { SlowSlot::RampGains } else { state.slow } {
            SlowSlot::Adapt => self.adapt(state, learns),
            SlowSlot::StandardDeviations => {
                self.shape(state);
                self.observer.step_standard_deviations(&mut state.observer);
                if learns {
                    let external_torque = state.observer.external_torque();
                    self.learning.learn_gravity(&mut state.learning, external_torque);
                }
                self.detect_standstill(state, motor);
                state.faults.gains = Faults::NONE;
                settled = trusted
                    && state.backward_has_settled
                    && self.guard.have_settled(&state.guard, &gains.forward);
            }
            SlowSlot::RampGains => {
                let motion = CommandedMotion { velocity: state.commander.velocity(), trusted };
                let mut faults = Faults::NONE;
                self.guard.ramp_gains(&mut state.guard, gains, motion, &mut faults);
                state.faults.gains = faults;
            }
        }
        state.slow = state.slow.next(settled);
        state.faults.collect();
    }

    /// What the observer's gear is corrected by, from the factors as learnt.
    #[inline(always)]
    pub(super) fn correct_gear(&self, state: &mut State<R>) {
        (state.gear_correction, state.load_rate) =
            self.learning.gear_correction(&state.learning, state.guard.gains());
    }

    /// The factors' slot.
    #[inline(always)]
    fn adapt(&self, state: &mut State<R>, learns: bool) {
        let observed = Observed {
            external_torque: state.observer.external_torque(),
            torsion: state.observer.torsion(),
            output_innovation: self.observer.moving_output_innovation(&state.observer),
            stiffness_torque: state.observer.stiffness_torque(),
        };
        let gains = state.guard.gains();
        let presliding = self.feed_forward.presliding(&self.gear, &state.feed_forward);
        self.learning.adapt(&mut state.learning, presliding, &observed, gains, learns);
        state.sound = true;
    }

    /// Sets the learnt shape and stiffness of the friction's presliding.
    #[inline(always)]
    fn shape(&self, state: &mut State<R>) {
        let Factors { presliding, presliding_stiffness, .. } = *state.learning.applied();
        let stiffening = presliding_stiffness - R::ONE;
        self.feed_forward.shape(&self.gear, &mut state.feed_forward, presliding, stiffening);
        self.observer.shape(&self.gear, &mut state.observer, presliding, stiffening);
    }
}
