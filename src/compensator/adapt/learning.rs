//! Adaptation: learnt factors on the gear ([`super::parameters`]), ripple ([`super::ripple`]) and gravity
//! ([`super::gravity`]), and the corrections of observer and feed-forward by them.
//!
//! ```text
//! correction of the observer     f*tau_fric of both sides, 1/c - 1 of the stiffness, the ripple's torque at the motor and
//!                                its position at the output, (1 - f_J)*J_fs*ddq as a torque on the flexspline
//! ```
//!
//! so that it need not be built anew, and its residual is what is learnt from. Every correction is scaled by its gain and
//! returns with it. Units: rad, N m; signs as in [`crate::gear`].
//!
//! Both are slow ([`crate::compensator::schedule`]): the factors are learnt in every second round, with a step of two
//! rounds (in every third while a gain is ramped: as if slower by half), and of the ripple one order in each round.

use zerocopy::KnownLayout;

use crate::angle::{Angle, Heading, Ratio};
use crate::compensator::adapt::gravity::{Gravity, GravityState};
use crate::compensator::adapt::parameters::{
    Adaptation, AdaptationParams, AdaptationState, Excitation, Factors, Observed,
};
use crate::compensator::adapt::ripple::{
    LearntRipple, LearntRippleParams, RippleMap, RippleNow, RippleSample,
};
use crate::compensator::estimate::observer::GearCorrection;
use crate::compensator::reference::feed_forward::ModelCorrection;
use crate::compensator::schedule::{OBSERVER_PERIODS, PLAN_TO_LEARN, SLOW_PERIODS};
use crate::compensator::{CompensationGains, Limits};
use crate::constants::constants;
use crate::error::Error;
use crate::gear::GearParams;
use crate::real::Real;

/// Steps of the observer from the feed-forward's slot to the adaptation's, less the first.
const STEPS_TO_LEARN: i32 = (PLAN_TO_LEARN / OBSERVER_PERIODS) as i32;

/// Learnt factors and ripple, as stored in a file.
#[constants]
#[derive(Clone, Copy, Debug, Default, PartialEq, KnownLayout)]
pub struct Learnt<R: Real> {
    /// Factors on the gear's parameters.
    pub factors: Factors<R>,
    /// Ripple.
    pub ripple: RippleMap<R>,
}

/// Parameters of the learning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearningParams<R> {
    /// Parameters of the factors.
    pub adaptation: AdaptationParams<R>,
    /// Parameters of the ripple.
    pub ripple: LearntRippleParams<R>,
}

/// The built learning.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Learning<R> {
    adaptation: Adaptation<R>,
    ripple: LearntRipple<R>,
    gravity: Gravity<R>,
    ratio: R,
    inverse_ratio: R,
    /// Between two steps of the observer (s).
    observed: R,
    flexspline_inertia: R,
}

/// State of the learning.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LearningState<R: Real> {
    adaptation: AdaptationState<R>,
    /// The factors as applied: times the adaptation's gain.
    applied: Factors<R>,
    map: RippleMap<R>,
    now: RippleNow<R>,
    gravity: GravityState<R>,
    /// Heading of the setpoint, and g there times the adaptation's gain (N m).
    heading: Heading<R>,
    gravity_torque: R,
    excitation: Excitation<R>,
    /// Speed of the motor by the setpoint, without the wind-up (rad/s).
    speed: R,
    /// Measured output less setpoint (rad), where there is an output encoder.
    position: Option<R>,
    /// epsilon (N m).
    residual: R,
    /// The epsilon that the ripple learns from in this round, if it learns.
    for_ripple: Option<R>,
}

impl<R: Real> LearningParams<R> {
    /// Prepares the learning for a gear, its limits and the control period dt (s).
    ///
    /// # Errors
    /// As [`AdaptationParams::build`], [`LearntRippleParams::build`] and [`Ratio::one_over`].
    pub fn build(&self, gear: &GearParams<R>, limits: &Limits<R>, dt: R) -> Result<Learning<R>, Error> {
        let (n, round) = (R::from_i32(gear.ratio), R::from_i32(SLOW_PERIODS as i32) * dt);
        let factors = round + round;
        Ok(Learning {
            adaptation: self.adaptation.build(n, gear.flexspline_inertia, limits.output_torque, factors)?,
            ripple: self.ripple.build(round)?,
            gravity: Gravity::build(gear.rated_torque, factors),
            ratio: Ratio::one_over(gear.ratio)?.value(),
            inverse_ratio: n,
            observed: R::from_i32(OBSERVER_PERIODS as i32) * dt,
            flexspline_inertia: gear.flexspline_inertia,
        })
    }
}

impl<R: Real> LearningState<R> {
    /// Learnt factors and ripple so far.
    pub fn learnt(&self) -> Learnt<R> {
        Learnt { factors: *self.adaptation.factors(), ripple: self.map }
    }

    /// g at the setpoint, times the adaptation's gain (N m).
    #[inline(always)]
    pub fn gravity_torque(&self) -> R {
        self.gravity_torque
    }

    /// Keeps epsilon, which the factors' slot may renew, for the ripple's slot of this round, where it `learns`.
    #[inline(always)]
    pub fn keep_for_ripple(&mut self, learns: bool) {
        self.for_ripple = learns.then_some(self.residual);
    }

    /// The factors as applied: times the adaptation's gain.
    #[inline(always)]
    pub fn applied(&self) -> &Factors<R> {
        &self.applied
    }
}

impl<R: Real> Learning<R> {
    /// Starts from stored factors and ripple, limited to their bounds.
    pub fn starting_from(&self, stored: &Learnt<R>) -> LearningState<R> {
        LearningState {
            adaptation: self.adaptation.starting_from(&stored.factors),
            map: stored.ripple.within(&self.ripple),
            ..LearningState::default()
        }
    }

    /// Evaluates ripple and gravity at these reference angles of motor and output, in the models' slot.
    #[inline(always)]
    pub fn step_models(
        &self,
        state: &mut LearningState<R>,
        motor: Angle<R>,
        output: Angle<R>,
        gains: &CompensationGains<R>,
    ) {
        self.ripple.evaluate_next(&state.map, &mut state.now, motor, output, state.speed);
        state.heading = output.heading();
        state.gravity_torque = gains.adaptation * state.gravity.torque(&state.heading);
    }

    /// Learnt correction of the gear's model at the observer's next step, and the change of its load from one of its
    /// steps to the next (N m).
    #[inline(always)]
    pub fn gear_correction(
        &self,
        state: &LearningState<R>,
        gains: &CompensationGains<R>,
    ) -> (GearCorrection<R>, R) {
        let Factors { inertia, input_friction, output_friction, .. } = state.applied;
        let Excitation { acceleration, jerk, .. } = state.excitation;
        let heavier = (R::ONE - inertia) * self.flexspline_inertia;
        let rate = heavier * jerk * self.observed;
        let correction = GearCorrection {
            friction: [input_friction - R::ONE, output_friction - R::ONE],
            stiffening: state.applied.stiffening(),
            position: gains.ripple * state.now.position,
            motor_torque: gains.ripple * state.now.torque,
            load: heavier * acceleration + state.gravity_torque + R::from_i32(STEPS_TO_LEARN) * rate,
        };
        (correction, rate)
    }

    /// Learnt correction of the feed-forward's model, with the compensated external torque `load` (N m).
    #[inline(always)]
    pub fn correction(
        &self,
        state: &LearningState<R>,
        load: R,
        gains: &CompensationGains<R>,
    ) -> ModelCorrection<R> {
        let [ripple, torque] = [state.now.position, state.now.torque].map(|now| gains.ripple * now);
        ModelCorrection {
            factors: state.applied,
            load: load + state.gravity_torque,
            ripple,
            torque: torque - self.ratio * state.gravity_torque,
        }
    }

    /// Learns gravity from a residual external torque (N m) while the setpoint moves.
    #[inline(always)]
    pub fn learn_gravity(&self, state: &mut LearningState<R>, external_torque: R) {
        if state.excitation.velocity != R::ZERO {
            self.gravity.step(&mut state.gravity, &state.heading, external_torque);
        }
    }

    /// Learns the factors from the observer's residual, while it `learns`.
    #[inline(always)]
    pub fn adapt(
        &self,
        state: &mut LearningState<R>,
        [presliding, stiffness]: [R; 2],
        observed: &Observed<R>,
        gains: &CompensationGains<R>,
        learns: bool,
    ) {
        state.excitation.presliding = presliding;
        state.excitation.stiffness = stiffness;
        state.residual = self.adaptation.step(&mut state.adaptation, &state.excitation, observed, learns);
        state.applied = state.adaptation.factors().scaled(gains.adaptation);
    }

    /// Takes the feed-forward's regressors, and the measured output less the setpoint (rad) where it is measured.
    #[inline(always)]
    pub fn follow(&self, state: &mut LearningState<R>, excitation: &Excitation<R>, position: Option<R>) {
        state.excitation = *excitation;
        state.speed = excitation.velocity * self.inverse_ratio;
        state.position = position;
    }

    /// Learns the ripple from this round, where it learns: in the slot of the checks, which has more time than that of the factors.
    #[inline(always)]
    pub fn learn_ripple(&self, state: &mut LearningState<R>) {
        let Some(residual) = state.for_ripple else {
            return;
        };
        let torque = -self.ratio * residual;
        let acceleration = state.excitation.acceleration * self.inverse_ratio;
        let sample = RippleSample { speed: state.speed, acceleration, position: state.position, torque };
        self.ripple.learn(&mut state.map, &mut state.now, &sample);
    }
}
