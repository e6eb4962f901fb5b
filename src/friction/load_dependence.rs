//! Load: friction of a strain-wave gear grows with the torque through it, and not by the same factor when
//! the motor drives the load as when the load drives the motor.
//!
//! ```text
//! level = F0 + |k_m*tau_m - k_e*tau_e| + w(v) * (F1 + |l_m*tau_m - l_e*tau_e| + Q)
//! Q     = q_e*tau_e^2 where |tau_m| > |tau_e|,  q_m*tau_m^2 where |tau_m| < |tau_e|;  0 where the signs are one
//! ```
//!
//! tau_m is the motor's torque, tau_e the external torque on the joint, both on the output side in one
//! sense: a motor that holds a load has tau_m = -tau_e. w(v) is the Stribeck weight, 1 at standstill and 0
//! in fast sliding: whatever curve the sliding model has, such as exp(-|v/vs|^delta). The factors k, l have
//! no unit, q (1/(N m)), levels (N m). The friction torque is this level times a normalised force (sign of
//! v, or presliding), plus a viscous part.
//!
//! The models m3 to m6 of Duclusaud et al. are cases of it:
//!
//! | | F1 | k_m, k_e | l_m, l_e | q |
//! | --- | --- | --- | --- | --- |
//! | m3 | 0 | equal | 0 | 0 |
//! | m4 | any | equal | equal | 0 |
//! | m5 | any | any | any | 0 |
//! | m6 | any | any | any | any |
//!
//! Memoryless: there is nothing to discretise. The level is never negative, so that a model that loses work
//! at a fixed level still does at v's sign; how a level may vary while presliding stores work is in
//! [`super::joint_friction`].
//!
//! Known weakness: the factors are identified one gear, one temperature and one lubricant at a time; Q
//! jumps where |tau_m| = |tau_e| and where a torque changes its sign, which no gear does.
//!
//! M. Duclusaud, G. Passault, V. Padois, O. Ly, "Extended friction models for the physics simulation of
//! servo actuators", IEEE International Conference on Robotics and Automation, 2025.

use super::{LIMIT, require_level};
use crate::constants::constants;
use crate::error::{Error, require};
use crate::real::Real;

/// Greatest factor of a torque.
const GREATEST_FACTOR: f64 = 10.0;

/// A level that grows with the torques.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoadedLevel<R> {
    /// F without load (N m); 0..=1e6.
    pub unloaded: R,
    /// Factor of the motor's torque; 0..=10.
    pub motor: R,
    /// Factor of the external torque; 0..=10.
    pub external: R,
}

impl<R: Real> LoadedLevel<R> {
    fn check(&self, names: [&'static str; 3]) -> Result<(), Error> {
        require_level(self.unloaded, names[0])?;
        require_factor(self.motor, names[1])?;
        require_factor(self.external, names[2])
    }

    #[inline(always)]
    fn at(&self, motor: R, external: R) -> R {
        self.unloaded + (self.motor * motor - self.external * external).abs()
    }
}

fn require_factor<R: Real>(factor: R, name: &'static str) -> Result<(), Error> {
    require((R::ZERO..=R::lit(GREATEST_FACTOR)).contains(&factor), name)
}

/// Load factors of the gear's friction: on the torque through the gear, at its own side.
///
/// A joint at constant speed has tau_e = -tau_m up to its friction, so that m3 to m5 add (k_m + k_e)*|tau|
/// to the level in both directions, and Q the difference between driving and driven.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoadFactors<R> {
    /// Level over torque while the motor drives the load; 0..=10.
    pub driving: R,
    /// While the load drives the motor; 0..=10.
    pub driven: R,
}

impl<R: Real> LoadFactors<R> {
    /// For motion forwards and backwards.
    pub(super) fn build(&self) -> Result<[DirectedLoad<R>; 2], Error> {
        require_factor(self.driving, "load.driving")?;
        require_factor(self.driven, "load.driven")?;
        let half = |value: R| R::lit(0.5) * value;
        let even = half(self.driving + self.driven);
        let odd = half(self.driving - self.driven);
        Ok([odd, -odd].map(|odd| DirectedLoad { even, odd }))
    }
}

/// [`LoadFactors`] in one direction of motion, without a comparison: half their sum, and half their difference.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DirectedLoad<R> {
    even: R,
    odd: R,
}

impl<R: Real> DirectedLoad<R> {
    /// No load adds to the level.
    pub(super) fn is_none(&self) -> bool {
        self.even == R::ZERO && self.odd == R::ZERO
    }

    /// Level by `load` (N m), added to the unloaded one (N m).
    #[inline(always)]
    pub(super) fn level(&self, load: R) -> R {
        self.even * load.abs() + self.odd * load
    }
}

/// Levels and factors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoadDependenceParams<R> {
    /// F0, k_m, k_e: at every speed.
    pub sliding: LoadedLevel<R>,
    /// F1, l_m, l_e: added at standstill.
    pub stribeck: LoadedLevel<R>,
    /// q_m (1/(N m)); 0..=10.
    pub motor_squared: R,
    /// q_e (1/(N m)); 0..=10.
    pub external_squared: R,
}

impl<R: Real> LoadDependenceParams<R> {
    /// Checks.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the name of the field.
    pub fn build(&self) -> Result<LoadDependence<R>, Error> {
        self.sliding.check(["sliding.unloaded", "sliding.motor", "sliding.external"])?;
        self.stribeck.check(["stribeck.unloaded", "stribeck.motor", "stribeck.external"])?;
        require_factor(self.motor_squared, "motor_squared")?;
        require_factor(self.external_squared, "external_squared")?;
        Ok(LoadDependence { params: *self })
    }
}

/// Built model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadDependence<R> {
    params: LoadDependenceParams<R>,
}

impl<R: Real> LoadDependence<R> {
    /// Level (N m) at the motor's and the external torque (N m) and a Stribeck weight w(v), 0..=1. A torque
    /// that is not finite counts as none.
    #[inline]
    pub fn level(&self, motor: R, external: R, weight: R) -> R {
        let limit = R::lit(LIMIT);
        let (motor, external) =
            (motor.finite_or(R::ZERO).limit(limit), external.finite_or(R::ZERO).limit(limit));
        let stribeck = self.params.stribeck.at(motor, external) + self.squared(motor, external);
        self.params.sliding.at(motor, external) + weight.max(R::ZERO).min(R::ONE) * stribeck
    }

    /// Q: of the torque that is overcome.
    #[inline(always)]
    fn squared(&self, motor: R, external: R) -> R {
        if motor.sign() == external.sign() {
            R::ZERO
        } else if motor.abs() > external.abs() {
            self.params.external_squared * external * external
        } else if motor.abs() < external.abs() {
            self.params.motor_squared * motor * motor
        } else {
            R::ZERO
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const PARAMS: LoadDependenceParams<f64> = LoadDependenceParams {
        sliding: LoadedLevel { unloaded: 1.0, motor: 0.1, external: 0.2 },
        stribeck: LoadedLevel { unloaded: 0.5, motor: 0.01, external: 0.02 },
        motor_squared: 1e-3,
        external_squared: 2e-3,
    };

    #[test]
    fn the_level_depends_on_load_direction_and_speed() {
        let model = PARAMS.build().unwrap();
        let level = |motor, external, weight| model.level(motor, external, weight);
        assert_eq!(level(0.0, 0.0, 0.0), 1.0);
        assert_eq!(level(0.0, 0.0, 1.0), 1.5);
        // The motor lifts the load, holds it, is driven by it.
        assert!((level(30.0, -20.0, 1.0) - (1.0 + 7.0 + 0.5 + 0.7 + 0.8)).abs() < 1e-14);
        assert!((level(20.0, -20.0, 1.0) - (1.0 + 6.0 + 0.5 + 0.6)).abs() < 1e-14);
        assert!((level(10.0, -20.0, 1.0) - (1.0 + 5.0 + 0.5 + 0.5 + 0.1)).abs() < 1e-14);
        assert!((level(10.0, 20.0, 1.0) - (1.0 + 3.0 + 0.5 + 0.3)).abs() < 1e-14);
        assert_eq!(level(f64::NAN, f64::INFINITY, f64::NAN), 1.0);
    }

    proptest! {
        #[test]
        fn any_bits_give_a_level_that_is_not_negative(motor: u32, external: u32, weight: u32) {
            let params = LoadDependenceParams {
                sliding: LoadedLevel { unloaded: 1e6, motor: 10.0, external: 10.0 },
                stribeck: LoadedLevel { unloaded: 1e6, motor: 10.0, external: 10.0 },
                motor_squared: 10.0f32,
                external_squared: 10.0,
            };
            let [motor, external, weight] = [motor, external, weight].map(f32::from_bits);
            let level = params.build().unwrap().level(motor, external, weight);
            prop_assert!(level.is_finite() && level >= 0.0);
        }
    }

    #[test]
    fn a_parameter_out_of_range_is_named() {
        let name = |change: fn(&mut LoadDependenceParams<f64>)| {
            let mut changed = PARAMS;
            change(&mut changed);
            changed.build().unwrap_err()
        };
        assert_eq!(name(|p| p.sliding.unloaded = -1.0), Error::OutOfRange("sliding.unloaded"));
        assert_eq!(name(|p| p.sliding.external = 11.0), Error::OutOfRange("sliding.external"));
        assert_eq!(name(|p| p.stribeck.motor = f64::NAN), Error::OutOfRange("stribeck.motor"));
        assert_eq!(name(|p| p.motor_squared = -1.0), Error::OutOfRange("motor_squared"));
        assert_eq!(name(|p| p.external_squared = -1.0), Error::OutOfRange("external_squared"));
    }
}
