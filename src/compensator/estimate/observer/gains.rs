//! The gains that the observer corrects by, computed off line: one set for each combination of sensors.
//!
//! They are given for the flange's angle theta_fs. What the observer keeps is theta_fs - r*theta_wg, so it is built
//! with l_theta_fs - r*l_theta_wg in their place.

use crate::compensator::estimate::observer::deviation::Spread;
use crate::compensator::estimate::observer::past::STEPS;
use crate::real::Real;

/// Number of observed states: the sixth is s where the motor moves, b where it stands.
pub const STATES: usize = 6;

/// Correction of each state [theta_wg, omega_wg, theta_fs, omega_fs, d, s or b] per unit of a sensor's innovation.
pub type Correction<R> = [R; STATES];

/// Gains for one combination of sensors; those of an absent sensor are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gains<R> {
    /// l_m, per rad of the motor encoder.
    pub motor: Correction<R>,
    /// l_t, per N m of the strain gauge.
    pub torque: Correction<R>,
    /// F^D l_o, per rad of the output encoder.
    pub output: Correction<R>,
    /// c_1..=c_D, of the past.
    pub past: [R; STEPS],
    /// What the estimates' deviations are made of.
    pub spread: Spread<R>,
}

/// Gains without further sensors, with output encoder, with strain gauge, with both.
pub type GainSets<R> = [Gains<R>; 4];

impl<R: Real> Gains<R> {
    /// With what corrects the flange's angle as what corrects by how much it is ahead of r*theta_wg.
    pub(super) fn relative(mut self, ratio: R) -> Self {
        for by in [&mut self.motor, &mut self.torque, &mut self.output] {
            by[2] -= ratio * by[0];
        }
        self
    }
}

/// The set of what is there.
#[inline(always)]
pub(super) fn set<R>(sets: &GainSets<R>, output: bool, gauge: bool) -> &Gains<R> {
    match (output, gauge) {
        (false, false) => &sets[0],
        (true, false) => &sets[1],
        (false, true) => &sets[2],
        (true, true) => &sets[3],
    }
}
