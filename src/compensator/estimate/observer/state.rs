//! State of the observer, and its correction by an innovation.

use crate::angle::Angle;
use crate::compensator::EstimateDeviation;
use crate::compensator::estimate::observer::Observer;
use crate::compensator::estimate::observer::deviation::{Magnitudes, SpreadState};
use crate::compensator::estimate::observer::gains::Correction;
use crate::compensator::estimate::observer::multi_rate::MultiRateGear;
use crate::compensator::estimate::observer::past::Past;
use crate::compensator::estimate::observer::standstill::Standstill;
use crate::real::Real;

/// State of the observer. Both angles are relative, so that they are small and need no more than an f32.
#[derive(Clone, Debug)]
pub struct ObserverState<R: Real> {
    pub(super) gear: MultiRateGear<R>,
    /// theta_m of the last period.
    pub(super) motor: Angle<R>,
    /// theta_wg - theta_m (rad) and omega_wg (rad/s).
    pub(super) motor_residual: R,
    pub(super) wave_generator_speed: R,
    /// theta_fs - r*theta_wg (rad) and omega_fs (rad/s).
    pub(super) link_offset: R,
    pub(super) flange_speed: R,
    /// tau of the last period (N m).
    pub(super) motor_torque: R,
    pub(super) external_torque: R,
    /// s (N m).
    pub(super) stiffness_torque: R,
    /// b (N m).
    pub(super) held_torque: R,
    /// theta_o - theta_fs at the last reading (rad).
    pub(super) output_innovation: R,
    pub(super) standstill: Standstill,
    /// Own periods since a reading of the output encoder.
    pub(super) since_output: u32,
    /// Readings of it in a row whose innovation was gross.
    pub(super) gross: u32,
    pub(super) past: Past,
    pub(super) spread: SpreadState<R>,
    pub(super) deviation: EstimateDeviation<R>,
    /// Magnitudes of the next standard deviations, and whether output encoder and gauge were read.
    pub(super) magnitudes: Magnitudes<R>,
    pub(super) readings: [bool; 2],
    pub(super) started: bool,
}

impl<R: Real> Observer<R> {
    /// The state at rest at the zero angle.
    pub fn rest(&self) -> ObserverState<R> {
        ObserverState {
            gear: MultiRateGear::default(),
            motor: Angle::default(),
            motor_residual: R::ZERO,
            wave_generator_speed: R::ZERO,
            link_offset: R::ZERO,
            flange_speed: R::ZERO,
            motor_torque: R::ZERO,
            external_torque: R::ZERO,
            stiffness_torque: R::ZERO,
            held_torque: R::ZERO,
            output_innovation: R::ZERO,
            standstill: Standstill::resting(),
            since_output: u32::MAX,
            gross: 0,
            past: Past::default(),
            spread: SpreadState::default(),
            deviation: EstimateDeviation::default(),
            magnitudes: Magnitudes::default(),
            readings: [false; 2],
            started: false,
        }
    }
}

impl<R: Real> ObserverState<R> {
    /// Measured angle of the motor at the last step.
    #[inline(always)]
    pub fn motor(&self) -> Angle<R> {
        self.motor
    }

    /// omega_wg (rad/s).
    #[inline(always)]
    pub fn motor_velocity(&self) -> R {
        self.wave_generator_speed
    }

    /// omega_fs (rad/s).
    #[inline(always)]
    pub fn output_velocity(&self) -> R {
        self.flange_speed
    }

    /// Friction at the flexspline (N m).
    #[inline(always)]
    pub fn output_friction(&self) -> R {
        self.magnitudes.output_friction
    }

    /// phi (rad).
    #[inline(always)]
    pub fn torsion(&self) -> R {
        self.magnitudes.torsion
    }

    /// s (N m).
    #[inline(always)]
    pub fn stiffness_torque(&self) -> R {
        self.stiffness_torque
    }

    /// d (N m).
    #[inline(always)]
    pub fn external_torque(&self) -> R {
        self.external_torque
    }

    /// Corrects by one sensor's innovation.
    #[inline(always)]
    pub(super) fn correct(&mut self, by: &Correction<R>, innovation: R, moved: bool) {
        self.motor_residual += by[0] * innovation;
        self.wave_generator_speed += by[1] * innovation;
        self.link_offset += by[2] * innovation;
        self.flange_speed += by[3] * innovation;
        self.external_torque += by[4] * innovation;
        let last = if moved { &mut self.stiffness_torque } else { &mut self.held_torque };
        *last += by[5] * innovation;
    }
}
