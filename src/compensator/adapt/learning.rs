//! What the compensator learns of its joint: factors on the gear ([`super::parameters`]) and ripple
//! ([`super::ripple`]), and where both enter.
//!
//! ```text
//! the observer knows     f*tau_fric of both sides, 1/c - 1 of the stiffness, the ripple's torque at the motor and its
//!                        position at the output, (1 - f_J)*J_fs*ddq as a torque on the flexspline
//! ```
//!
//! so that it need not be built anew, and what it still misses is what is learnt from. Everything is scaled by its
//! share and comes back as it was when the share does. Units: rad, N m; signs as in [`crate::gear`].
//!
//! Both are slow ([`crate::compensator::schedule`]): the factors are learnt in every second round, with a step of two rounds (in
//! every third while a share is on its way: as if it were slower by half), and of the ripple one order in each round.

use crate::angle::{Angle, Heading, Ratio};
use crate::compensator::adapt::gravity::{Gravity, GravityState};
use crate::compensator::adapt::parameters::{
    Adaptation, AdaptationParams, AdaptationState, Excitation, Factors, Observed,
};
use crate::compensator::adapt::ripple::{
    LearntRipple, LearntRippleParams, RippleMap, RippleNow, RippleSample,
};
use crate::compensator::estimate::observer::Known;
use crate::compensator::reference::feed_forward::ModelCorrection;
use crate::compensator::schedule::{OBSERVER_PERIODS, PLAN_TO_LEARN, SLOW_PERIODS};
use crate::compensator::{Limits, Shares};
use crate::error::Error;
use crate::gear::GearParams;
use crate::real::Real;

/// Steps of the observer from the feed-forward's slot to that of what is learnt, less the first.
const STEPS_TO_LEARN: i32 = (PLAN_TO_LEARN / OBSERVER_PERIODS) as i32;

/// What has been learnt: kept in a file, and started from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Learnt<R: Real> {
    /// Factors on the gear's parameters.
    pub factors: Factors<R>,
    /// Ripple.
    pub ripple: RippleMap<R>,
}

/// Parameters of what is learnt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearningParams<R> {
    /// Of the factors.
    pub adaptation: AdaptationParams<R>,
    /// Of the ripple.
    pub ripple: LearntRippleParams<R>,
}

/// The built learning.
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

/// What has been learnt, and what the next step needs of this one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LearningState<R: Real> {
    adaptation: AdaptationState<R>,
    /// The factors as far as they are applied.
    applied: Factors<R>,
    map: RippleMap<R>,
    now: RippleNow<R>,
    gravity: GravityState<R>,
    /// Of the setpoint, and g there, as far as it is applied (N m).
    heading: Heading<R>,
    gravity_torque: R,
    excitation: Excitation<R>,
    /// Speed of the motor by the setpoint: what winds the gear up is no turning (rad/s).
    speed: R,
    /// Measured output less setpoint (rad), where there is an output encoder.
    position: Option<R>,
    /// epsilon (N m).
    missed: R,
}

impl<R: Real> LearningParams<R> {
    /// Prepares the learning for a gear, its limits and the control period dt (s).
    ///
    /// # Errors
    /// As [`AdaptationParams::build`], [`LearntRippleParams::build`] and [`Ratio::one_over`].
    pub fn build(&self, gear: &GearParams<R>, limits: &Limits<R>, dt: R) -> Result<Learning<R>, Error> {
        let (n, turn) = (R::from_i32(gear.ratio), R::from_i32(SLOW_PERIODS as i32) * dt);
        let factors = turn + turn;
        Ok(Learning {
            adaptation: self.adaptation.build(n, gear.flexspline_inertia, limits.output_torque, factors)?,
            ripple: self.ripple.build(turn)?,
            gravity: Gravity::build(gear.rated_torque, factors),
            ratio: Ratio::one_over(gear.ratio)?.value(),
            inverse_ratio: n,
            observed: R::from_i32(OBSERVER_PERIODS as i32) * dt,
            flexspline_inertia: gear.flexspline_inertia,
        })
    }
}

impl<R: Real> LearningState<R> {
    /// What has been learnt so far.
    pub fn learnt(&self) -> Learnt<R> {
        Learnt { factors: *self.adaptation.factors(), ripple: self.map }
    }

    /// g where the setpoint is, as far as it is applied (N m).
    #[inline(always)]
    pub fn gravity_torque(&self) -> R {
        self.gravity_torque
    }

    /// The factors as far as they are applied.
    #[inline(always)]
    pub fn applied(&self) -> &Factors<R> {
        &self.applied
    }
}

impl<R: Real> Learning<R> {
    /// Starts from what is stored, limited to its bounds.
    pub fn starting_from(&self, stored: &Learnt<R>) -> LearningState<R> {
        LearningState {
            adaptation: self.adaptation.starting_from(&stored.factors),
            map: stored.ripple.within(&self.ripple),
            ..LearningState::default()
        }
    }

    /// The ripple's turn and gravity's, with motor and output meant to be at these angles.
    #[inline(always)]
    pub fn turn_to(
        &self,
        state: &mut LearningState<R>,
        motor: Angle<R>,
        output: Angle<R>,
        shares: &Shares<R>,
    ) {
        self.ripple.turn_to(&state.map, &mut state.now, motor, output, state.speed);
        state.heading = output.heading();
        state.gravity_torque = shares.adaptation * state.gravity.torque(&state.heading);
    }

    /// What is known of the gear beside its model at the observer's next step, and by how much its load changes from
    /// one of its steps to the next (N m).
    #[inline(always)]
    pub fn known(&self, state: &LearningState<R>, shares: &Shares<R>) -> (Known<R>, R) {
        let Factors { inertia, input_friction, output_friction, .. } = state.applied;
        let Excitation { acceleration, jerk, .. } = state.excitation;
        let heavier = (R::ONE - inertia) * self.flexspline_inertia;
        let rate = heavier * jerk * self.observed;
        let known = Known {
            friction: [input_friction - R::ONE, output_friction - R::ONE],
            stiffening: state.applied.stiffening(),
            position: shares.ripple * state.now.position,
            motor_torque: shares.ripple * state.now.torque,
            load: heavier * acceleration + state.gravity_torque + R::from_i32(STEPS_TO_LEARN) * rate,
        };
        (known, rate)
    }

    /// What has been learnt beside the model, with the external torque as far as it is followed.
    #[inline(always)]
    pub fn correction(&self, state: &LearningState<R>, load: R, shares: &Shares<R>) -> ModelCorrection<R> {
        let [ripple, torque] = [state.now.position, state.now.torque].map(|now| shares.ripple * now);
        ModelCorrection {
            factors: state.applied,
            load: load + state.gravity_torque,
            ripple,
            torque: torque - self.ratio * state.gravity_torque,
        }
    }

    /// Gravity's slot: learns from an external torque that is left (N m), where the setpoint moves.
    #[inline(always)]
    pub fn learn_gravity(&self, state: &mut LearningState<R>, external_torque: R) {
        if state.excitation.velocity != R::ZERO {
            self.gravity.step(&mut state.gravity, &state.heading, external_torque);
        }
    }

    /// The factors' turn: learns from what the observer missed, while it `learns`.
    #[inline(always)]
    pub fn adapt(
        &self,
        state: &mut LearningState<R>,
        [presliding, stiffness]: [R; 2],
        observed: &Observed<R>,
        shares: &Shares<R>,
        learns: bool,
    ) {
        state.excitation.presliding = presliding;
        state.excitation.stiffness = stiffness;
        state.missed = self.adaptation.step(&mut state.adaptation, &state.excitation, observed, learns);
        state.applied = state.adaptation.factors().scaled(shares.adaptation);
    }

    /// How the feed-forward moves, and the measured output less the setpoint (rad) where it is measured.
    #[inline(always)]
    pub fn follow(&self, state: &mut LearningState<R>, excitation: &Excitation<R>, position: Option<R>) {
        state.excitation = *excitation;
        state.speed = excitation.velocity * self.inverse_ratio;
        state.position = position;
    }

    /// Learns the ripple from this round.
    #[inline(always)]
    pub fn learn_ripple(&self, state: &mut LearningState<R>) {
        let torque = -self.ratio * state.missed;
        let sample = RippleSample { speed: state.speed, position: state.position, torque };
        self.ripple.learn(&mut state.map, &state.now, &sample);
    }
}
