//! Levels of the compensator's functions: factors on the gains by the rules of [`crate::design::compensation`].

use crate::io::gear_file::SensorSet;

use super::parts::Parts;

/// A function that closes a loop in addition to the cascade, and the gain that its level scales.
#[derive(Clone, Copy, Debug)]
pub struct Function {
    /// For people.
    pub name: &'static str,
    /// Sets of sensors that have it.
    pub sets: &'static [SensorSet],
    /// Place in [`FUNCTIONS`] of the function without which it does nothing.
    pub needs: Option<usize>,
    scale: fn(&mut Parts, f64),
}

fn scale_damping(parts: &mut Parts, set: SensorSet, level: f64) {
    let gains = &mut parts.output_feedback[set as usize];
    gains.damping *= level;
    gains.damping_at_rest *= level;
}

/// Every function, in the order in which they are added to the cascade.
pub const FUNCTIONS: [Function; 7] = [
    Function {
        name: "output feedback: damping b (motor encoder)",
        sets: &[SensorSet::Motor],
        needs: None,
        scale: |parts, level| scale_damping(parts, SensorSet::Motor, level),
    },
    Function {
        name: "output feedback: damping b (both encoders)",
        sets: &[SensorSet::Both],
        needs: None,
        scale: |parts, level| scale_damping(parts, SensorSet::Both, level),
    },
    Function {
        name: "disturbance path: slow corner omega_l",
        sets: &SensorSet::ALL,
        needs: None,
        scale: |parts, level| parts.disturbance.slow_corner *= level,
    },
    Function {
        name: "disturbance path: fast corner omega_f",
        sets: &SensorSet::ALL,
        needs: None,
        scale: |parts, level| parts.disturbance.fast_corner *= level,
    },
    Function {
        name: "disturbance path: wind-up fraction s",
        sets: &SensorSet::ALL,
        needs: Some(3),
        scale: |parts, level| parts.disturbance.wind_up_fraction *= level,
    },
    Function {
        name: "output feedback: P and D of the measured angle (both encoders)",
        sets: &[SensorSet::Both],
        needs: None,
        scale: |parts, level| {
            let gains = &mut parts.measured_feedback;
            gains.proportional *= level;
            gains.proportional_at_rest *= level;
            gains.derivative *= level;
            gains.derivative_at_rest *= level;
        },
    },
    Function {
        name: "output feedback: integral k (both encoders)",
        sets: &[SensorSet::Both],
        needs: None,
        scale: |parts, level| {
            parts.output_feedback[1].integral *= level;
        },
    },
];

/// A level for each of [`FUNCTIONS`], 0..=1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Levels(pub [f64; FUNCTIONS.len()]);

impl Levels {
    /// As the rules have them.
    pub const FULL: Self = Self([1.0; FUNCTIONS.len()]);
    /// The cascade alone.
    pub const NONE: Self = Self([0.0; FUNCTIONS.len()]);

    /// The same parts at these levels.
    #[must_use]
    pub fn apply(&self, parts: &Parts) -> Parts {
        let mut scaled = *parts;
        for (function, level) in FUNCTIONS.iter().zip(self.0) {
            (function.scale)(&mut scaled, level);
        }
        scaled
    }

    /// Each function with its level.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, f64)> {
        FUNCTIONS.iter().map(|function| function.name).zip(self.0)
    }
}
