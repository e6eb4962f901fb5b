//! Gains of the observer, computed off line: one set for each combination of sensors.
//!
//! They are given for the flange's angle theta_fs. The observer's state is theta_fs - r*theta_wg, so it is built with
//! l_theta_fs - r*l_theta_wg in their place.

use crate::compensator::estimate::observer::deviation::Spread;
use crate::compensator::estimate::observer::past::STEPS;
use crate::constants::constants;
use crate::real::Real;

/// Number of observed states: the sixth is s where the motor moves, b where it stands.
pub const STATES: usize = 6;

/// Correction of each state [theta_wg, omega_wg, theta_fs, omega_fs, d, s or b] per unit of a sensor's innovation.
pub type Correction<R> = [R; STATES];

/// Gains for one combination of sensors; those of an absent sensor are zero.
#[constants]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gains<R> {
    /// l_m, per rad of the motor encoder.
    pub motor: Correction<R>,
    /// l_t, per N m of the strain gauge.
    pub torque: Correction<R>,
    /// F^D l_o, per rad of the output encoder.
    pub output: Correction<R>,
    /// c_1..=c_D, of the past angles.
    pub past: [R; STEPS],
    /// Coefficients of the estimates' standard deviations.
    pub spread: Spread<R>,
}

/// Gains without further sensors, with output encoder, with strain gauge, with both.
pub type GainSets<R> = [Gains<R>; 4];

impl<R: Real> Gains<R> {
    /// The gains for the state theta_fs - r*theta_wg in the place of theta_fs.
    pub(super) fn relative(mut self, ratio: R) -> Self {
        for by in [&mut self.motor, &mut self.torque, &mut self.output] {
            by[2] -= ratio * by[0];
        }
        self
    }
}

/// The set for the sensors that are there.
#[inline(always)]
pub(super) fn set<R>(sets: &GainSets<R>, output: bool, gauge: bool) -> &Gains<R> {
    match (output, gauge) {
        (false, false) => &sets[0],
        (true, false) => &sets[1],
        (false, true) => &sets[2],
        (true, true) => &sets[3],
    }
}
