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

use crate::angle::{Angle, Ratio};
use crate::compensator::adapt::parameters::{
    Adaptation, AdaptationParams, AdaptationState, Excitation, Factors, Observed,
};
use crate::compensator::adapt::ripple::{LearntRipple, LearntRippleParams, Lesson, RippleMap, RippleNow};
use crate::compensator::estimate::observer::Known;
use crate::compensator::reference::feed_forward::Believed;
use crate::compensator::schedule::{OBSERVER_PERIODS, SLOW_PERIODS};
use crate::compensator::{Limits, Shares};
use crate::error::Error;
use crate::gear::GearParams;
use crate::real::Real;

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
    ratio: R,
    inverse_ratio: R,
    /// From a plan to the middle of what the observer's next turn but one is about (s).
    until_observed: R,
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
    excitation: Excitation<R>,
    /// Speed of the motor by the setpoint: what winds the gear up is no turning (rad/s).
    speed: R,
    /// epsilon (N m).
    missed: R,
}

/// How the feed-forward moved, for what comes after it.
#[derive(Clone, Copy, Debug)]
pub struct Course<R> {
    /// What it rested on.
    pub excitation: Excitation<R>,
    /// Measured output less setpoint (rad), where there is an output encoder.
    pub position: Option<R>,
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
            ratio: Ratio::one_over(gear.ratio)?.value(),
            inverse_ratio: n,
            until_observed: R::from_i32(OBSERVER_PERIODS as i32) * dt,
            flexspline_inertia: gear.flexspline_inertia,
        })
    }
}

impl<R: Real> LearningState<R> {
    /// What has been learnt so far.
    pub fn learnt(&self) -> Learnt<R> {
        Learnt { factors: *self.adaptation.factors(), ripple: self.map }
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

    /// The ripple's turn, with motor and output meant to be at these angles.
    #[inline(always)]
    pub fn turn_to(&self, state: &mut LearningState<R>, motor: Angle<R>, output: Angle<R>) {
        self.ripple.turn_to(&state.map, &mut state.now, motor, output, state.speed);
    }

    /// What is known of the gear beside its model, and by how much its load changes until the observer's next turn
    /// but one (N m).
    #[inline(always)]
    pub fn known(&self, state: &LearningState<R>, shares: &Shares<R>) -> (Known<R>, R) {
        let Factors { inertia, input_friction, output_friction, .. } = state.applied;
        let Excitation { acceleration, jerk, .. } = state.excitation;
        let heavier = (R::ONE - inertia) * self.flexspline_inertia;
        let known = Known {
            friction: [input_friction - R::ONE, output_friction - R::ONE],
            stiffening: state.applied.stiffening(),
            position: shares.ripple * state.now.position,
            motor_torque: shares.ripple * state.now.torque,
            load: heavier * acceleration,
        };
        (known, heavier * jerk * self.until_observed)
    }

    /// What is believed beside the model, with the external torque as far as it is followed.
    #[inline(always)]
    pub fn believed(&self, state: &LearningState<R>, load: R, shares: &Shares<R>) -> Believed<R> {
        let [ripple, torque] = [state.now.position, state.now.torque].map(|now| shares.ripple * now);
        Believed { factors: state.applied, load, ripple, torque }
    }

    /// The factors' turn: learns from what the observer missed, while it `learns`.
    #[inline(always)]
    pub fn adapt(
        &self,
        state: &mut LearningState<R>,
        observed: &Observed<R>,
        shares: &Shares<R>,
        learns: bool,
    ) {
        state.missed = self.adaptation.step(&mut state.adaptation, &state.excitation, observed, learns);
        state.applied = state.adaptation.factors().scaled(shares.adaptation);
    }

    /// Learns the ripple from this round, while it `learns`.
    #[inline(always)]
    pub fn follow(&self, state: &mut LearningState<R>, course: &Course<R>, learns: bool) {
        state.excitation = course.excitation;
        state.speed = course.excitation.velocity * self.inverse_ratio;
        if learns {
            let torque = -self.ratio * state.missed;
            let lesson = Lesson { speed: state.speed, position: course.position, torque };
            self.ripple.learn(&mut state.map, &state.now, &lesson);
        }
    }
}
