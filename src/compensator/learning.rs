//! What the compensator learns of its joint: factors on the gear ([`super::adaptation`]) and ripple
//! ([`super::learnt_ripple`]), and where both enter.
//!
//! ```text
//! the observer is told   tau_motor - (f_in - 1)*tau_fric_in - ripple torque,   theta_o - ripple position,
//!                        -(f_J - 1)*J_fs*ddq - (f_out - 1)*tau_fric_out as a torque on the flexspline
//! its estimates become   f*tau_fric,   theta_fs + ripple position
//! ```
//!
//! so that it need not be built anew, and what it still misses is what is learnt from. tau_fric are its own frictions of the
//! step before. Everything is scaled by its share and
//! comes back as it was when the share does. Units: rad, N m; signs as in [`crate::gear`].
//!
//! Both are slow: the factors are learnt in one of [`TURNS`] control periods dt, with a step of [`TURNS`]*dt, and of the ripple
//! one order in each period.

use crate::angle::{Angle, Ratio};
use crate::compensator::adaptation::{
    Adaptation, AdaptationParams, AdaptationState, Excitation, Factors, Observed,
};
use crate::compensator::feed_forward::Believed;
use crate::compensator::learnt_ripple::{LearntRipple, LearntRippleParams, Lesson, RippleMap, RippleNow};
use crate::compensator::observer::Measurement;
use crate::compensator::{Estimate, Limits, Shares};
use crate::error::Error;
use crate::gear::GearParams;
use crate::real::Real;

/// Control periods from one turn of the factors to the next.
pub const TURNS: u32 = 4;

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
    /// Control periods since the factors' turn.
    since_factors: u32,
    /// Friction of the wave generator in the last step, of the nominal gear (N m).
    input_friction: R,
    /// Of the flexspline.
    output_friction: R,
    excitation: Excitation<R>,
    /// Speed of the motor's reference (rad/s).
    speed: R,
    /// epsilon (N m).
    missed: R,
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
        let (n, turn) = (R::from_i32(gear.ratio), R::from_i32(TURNS as i32) * dt);
        Ok(Learning {
            adaptation: self.adaptation.build(n, gear.flexspline_inertia, limits.output_torque, turn)?,
            ripple: self.ripple.build(dt)?,
            ratio: Ratio::one_over(gear.ratio)?.value(),
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
            since_factors: TURNS - 1,
            ..LearningState::default()
        }
    }

    /// Begins the next control period, with motor and output meant to be at these angles.
    #[inline(always)]
    pub fn turn_to(&self, state: &mut LearningState<R>, motor: Angle<R>, output: Angle<R>) {
        state.since_factors = (state.since_factors + 1) % TURNS;
        self.ripple.turn_to(&state.map, &mut state.now, motor, output, state.speed);
    }

    /// What the observer is told of a measurement.
    #[inline(always)]
    pub fn told(
        &self,
        state: &LearningState<R>,
        measured: &Measurement<R>,
        shares: &Shares<R>,
    ) -> Measurement<R> {
        let factors = &state.applied;
        let inertia = self.flexspline_inertia * state.excitation.acceleration;
        let position = shares.ripple * state.now.position;
        Measurement {
            output: measured.output.map(|angle| angle.plus(-position)),
            motor_torque: measured.motor_torque
                - (factors.input_friction - R::ONE) * state.input_friction
                - shares.ripple * state.now.torque,
            known_torque: (R::ONE - factors.inertia) * inertia
                + (R::ONE - factors.output_friction) * state.output_friction,
            known_stiffness: factors.stiffening(),
            ..*measured
        }
    }

    /// Puts what has been learnt into the estimate, and learns from what the observer missed, while it `learns`.
    #[inline(always)]
    pub fn believe(
        &self,
        state: &mut LearningState<R>,
        estimate: &mut Estimate<R>,
        output_innovation: Option<R>,
        shares: &Shares<R>,
        learns: bool,
    ) -> Believed<R> {
        if state.since_factors == 0 {
            let observed = Observed {
                external_torque: estimate.external_torque,
                torsion: estimate.torsion,
                output_innovation,
            };
            state.missed = self.adaptation.step(&mut state.adaptation, &state.excitation, &observed, learns);
            state.applied = state.adaptation.factors().scaled(shares.adaptation);
        }
        state.input_friction = estimate.input_friction;
        state.output_friction = estimate.output_friction;
        let factors = state.applied;
        let ripple = shares.ripple * state.now.position;
        estimate.output_position = estimate.output_position.plus(ripple);
        estimate.input_friction = factors.input_friction * estimate.input_friction;
        estimate.output_friction = factors.output_friction * estimate.output_friction;
        let torque = shares.ripple * state.now.torque;
        Believed { factors, external_torque: estimate.external_torque, ripple, torque }
    }

    /// Learns the ripple from this control period, while it `learns`.
    #[inline(always)]
    pub fn follow(&self, state: &mut LearningState<R>, course: &Course<R>, learns: bool) {
        state.excitation = course.excitation;
        state.speed = course.speed;
        if learns {
            let torque = -self.ratio * state.missed;
            let lesson = Lesson { speed: course.speed, position: course.position, torque };
            self.ripple.learn(&mut state.map, &state.now, &lesson);
        }
    }
}
