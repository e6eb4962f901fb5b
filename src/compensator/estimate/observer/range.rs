//! Range of the observer's states: its estimates are bounded for any readings.
//!
//! ```text
//! |omega_wg| <= 2*motor_speed,   |omega_fs| <= 2*motor_speed/|n|,   |d| <= tau_p,   |b| <= tau_p/|n|,   n = 1/r
//! |s| <= 3*u_K*|tau_t| + 0.045*tau_rated,   |phi| <= phi(4*tau_p),   |tau_t| <= 4*tau_p
//! ```
//!
//! tau_p is the gear's peak torque at its output, u_K as in [`super::deviation`]. The states are limited; a torsion
//! beyond its bound starts the observer again; tau_t is limited where it is reported. Where the motor moves b is 0.
//! Units: rad, rad/s, N m.

use crate::branch::seldom;
use crate::compensator::estimate::observer::multi_rate::Torques;
use crate::compensator::estimate::observer::state::ObserverState;
use crate::compensator::faults::Faults;
use crate::compensator::tuned::HYSTERESIS_TORQUE;
use crate::compensator::{Limits, Tolerances};
use crate::constants::constants;
use crate::error::Error;
use crate::gear::GearParams;
use crate::real::Real;

/// Bounds of the observer's states: twice the joint's speeds, its peak torque, and the torsion of four times the peak
/// torque, far beyond ratcheting of the teeth.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range<R> {
    motor_speed: R,
    output_speed: R,
    external_torque: R,
    held_torque: R,
    /// Bound of s: fraction of the transmitted torque, and the torque that is added to it (N m).
    stiffness_torque: [R; 2],
    pub(super) torsion: R,
    pub(super) transmitted: R,
    /// Largest innovation of the output encoder that corrects at once.
    pub(super) output_innovation: R,
}

impl<R: Real> Range<R> {
    /// Of a gear whose stiffness has this standard deviation, relative to itself, and an output encoder with this count (rad).
    ///
    /// # Errors
    /// As the gear's flexspline.
    pub(super) fn build(
        gear: &GearParams<R>,
        limits: &Limits<R>,
        tolerances: &Tolerances<R>,
        stiffness: R,
        output_count: R,
    ) -> Result<Self, Error> {
        let line = gear.flexspline.line.build()?;
        Ok(Self {
            motor_speed: R::lit(2.0) * limits.motor_speed,
            output_speed: R::lit(2.0) * limits.output_speed(gear.ratio),
            external_torque: limits.output_torque,
            held_torque: limits.output_torque / R::from_i32(gear.ratio).abs(),
            stiffness_torque: [R::lit(3.0) * stiffness, R::lit(HYSTERESIS_TORQUE.get()) * gear.rated_torque],
            torsion: line.torsion(R::lit(4.0) * limits.output_torque),
            transmitted: R::lit(4.0) * limits.output_torque,
            output_innovation: tolerances.of_torsion() * line.torsion(limits.output_torque)
                + R::lit(2.0) * output_count,
        })
    }

    /// Limits every state to its bound; a limited speed or load is reported.
    #[inline(always)]
    pub(super) fn keep(
        &self,
        state: &mut ObserverState<R>,
        torques: &Torques<R>,
        moved: bool,
        faults: &mut Faults,
    ) {
        self.keep_motion(state, faults);
        if moved {
            let [fraction, least] = self.stiffness_torque;
            state.stiffness_torque =
                state.stiffness_torque.limit(fraction * torques.transmitted.abs() + least);
            state.held_torque = R::ZERO;
        } else {
            state.held_torque = state.held_torque.limit(self.held_torque);
        }
    }

    /// Limits speeds and load, and reports it.
    #[inline(always)]
    pub(super) fn keep_motion(&self, state: &mut ObserverState<R>, faults: &mut Faults) {
        for (value, bound) in [
            (&mut state.wave_generator_speed, self.motor_speed),
            (&mut state.flange_speed, self.output_speed),
            (&mut state.external_torque, self.external_torque),
        ] {
            if !value.is_within(bound) {
                seldom();
                faults.raise_if(true, Faults::ESTIMATE_LIMITED);
                *value = value.limit(bound);
            }
        }
    }
}
