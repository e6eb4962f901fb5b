//! What the compensator learns of its joint: factors on the gear ([`super::adaptation`]) and ripple
//! ([`super::learnt_ripple`]), and where both enter.
//!
//! ```text
//! the observer is told   tau_motor - (f_in - 1)*tau_fric_in - ripple torque,   theta_o - ripple position
//! its estimates become   f*tau_fric,   theta_fs + ripple position,   d - what inertia and output friction explain
//! ```
//!
//! so that it stays the nominal gear's observer, and what it misses is what is learnt from. Everything is scaled by its share and
//! comes back as it was when the share does. Units: rad, N m; signs as in [`crate::gear`].

use crate::angle::{Angle, Ratio};
use crate::compensator::adaptation::{
    Adaptation, AdaptationParams, AdaptationState, Excitation, Factors, Missed, Observed,
};
use crate::compensator::feed_forward::Believed;
use crate::compensator::learnt_ripple::{Lesson, LearntRipple, LearntRippleParams, RippleMap, RippleNow};
use crate::compensator::observer::Measurement;
use crate::compensator::{Estimate, Limits, Shares};
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
}

/// What has been learnt, and what the next step needs of this one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LearningState<R: Real> {
    adaptation: AdaptationState<R>,
    map: RippleMap<R>,
    now: RippleNow<R>,
    /// Friction of the wave generator in the last step, of the nominal gear (N m).
    input_friction: R,
    excitation: Excitation<R>,
    missed: Missed<R>,
}

/// How the feed-forward moved, for what comes after it.
#[derive(Clone, Copy, Debug)]
pub struct Course<R> {
    /// What it rested on.
    pub excitation: Excitation<R>,
    /// Speed of the motor's reference (rad/s).
    pub speed: R,
    /// Measured output less setpoint (rad), where there is an output encoder.
    pub position: Option<R>,
}

impl<R: Real> LearningParams<R> {
    /// Prepares the learning for a gear, its limits and the control period dt (s).
    ///
    /// # Errors
    /// As [`AdaptationParams::build`], [`LearntRippleParams::build`] and [`Ratio::one_over`].
    pub fn build(&self, gear: &GearParams<R>, limits: &Limits<R>, dt: R) -> Result<Learning<R>, Error> {
        let n = R::from_i32(gear.ratio);
        Ok(Learning {
            adaptation: self.adaptation.build(n, gear.flexspline_inertia, limits.output_torque, dt)?,
            ripple: self.ripple.build(dt)?,
            ratio: Ratio::one_over(gear.ratio)?.value(),
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
    pub fn applied(&self, shares: &Shares<R>) -> Factors<R> {
        self.adaptation.factors().scaled(shares.adaptation)
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

    /// Takes the ripple where the motor's reference is, `reduced` being r times it.
    #[inline(always)]
    pub fn turn_to(&self, state: &mut LearningState<R>, reference: Angle<R>, reduced: Angle<R>) {
        state.now = self.ripple.at(&state.map, reference, reduced);
    }

    /// What the observer is told of a measurement.
    #[inline(always)]
    pub fn told(&self, state: &LearningState<R>, measured: &Measurement<R>, shares: &Shares<R>) -> Measurement<R> {
        let factor = state.applied(shares).input_friction;
        let position = shares.ripple * state.now.position;
        Measurement {
            output: measured.output.map(|angle| angle.plus(-position)),
            motor_torque: measured.motor_torque
                - (factor - R::ONE) * state.input_friction
                - shares.ripple * state.now.torque,
            ..*measured
        }
    }

    /// Puts what has been learnt into the estimate, and learns from what the observer missed, while it `learns`.
    #[inline(always)]
    pub fn believe(
        &self,
        state: &mut LearningState<R>,
        estimate: &mut Estimate<R>,
        stiffness_torque: Option<R>,
        shares: &Shares<R>,
        learns: bool,
    ) -> Believed<R> {
        let observed = Observed {
            external_torque: estimate.external_torque,
            transmitted_torque: estimate.transmitted_torque,
            stiffness_torque,
        };
        state.missed = self.adaptation.step(&mut state.adaptation, &state.excitation, &observed, learns);
        state.input_friction = estimate.input_friction;
        let factors = state.applied(shares);
        let ripple = shares.ripple * state.now.position;
        estimate.output_position = estimate.output_position.plus(ripple);
        estimate.input_friction = factors.input_friction * estimate.input_friction;
        estimate.output_friction = factors.output_friction * estimate.output_friction;
        estimate.external_torque -= shares.adaptation * state.missed.explained;
        let torque = shares.ripple * state.now.torque;
        Believed { factors, external_torque: estimate.external_torque, ripple, torque }
    }

    /// Learns the ripple from this control period, while it `learns`.
    #[inline(always)]
    pub fn follow(&self, state: &mut LearningState<R>, course: &Course<R>, learns: bool) {
        state.excitation = course.excitation;
        if learns {
            let torque = -self.ratio * state.missed.left;
            let lesson = Lesson { speed: course.speed, position: course.position, torque };
            self.ripple.learn(&mut state.map, &state.now, &lesson);
        }
    }
}
