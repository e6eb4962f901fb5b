//! Gains of the compensation functions that are tried over the link.
//!
//! A tried gain takes the place of the board's own where that is not 0: what the board keeps off stays off. It goes into the step's input, and so
//! through the compensator's ramp of 1 per 20 ms. When nothing has been heard for [`super::link::SILENCE`] the board's own gains come back.

use serde::{Deserialize, Serialize};
use strainwave::compensator::{CompensationGains, Directions};

/// A compensation function that has a gain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Function {
    /// The cascaded feedback.
    Feedback,
    /// Inertia of motor and load.
    Inertia,
    /// Friction of both sides.
    Friction,
    /// Wind-up: torsion, with hysteresis.
    WindUp,
    /// Kinematic error.
    KinematicError,
    /// Output feedback: damping of the torsional vibration.
    OutputFeedback,
    /// Learnt factors.
    Adaptation,
    /// Learnt ripple.
    Ripple,
}

impl Function {
    /// Every function, by its number.
    pub const ALL: [Self; 8] = [
        Self::Feedback,
        Self::Inertia,
        Self::Friction,
        Self::WindUp,
        Self::KinematicError,
        Self::OutputFeedback,
        Self::Adaptation,
        Self::Ripple,
    ];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Feedback => "feedback",
            Self::Inertia => "inertia",
            Self::Friction => "friction",
            Self::WindUp => "wind-up",
            Self::KinematicError => "kinematic-error",
            Self::OutputFeedback => "output-feedback",
            Self::Adaptation => "adaptation",
            Self::Ripple => "ripple",
        }
    }

    /// Its gain among those of a direction.
    fn gain(self, gains: &mut CompensationGains<f32>) -> &mut f32 {
        match self {
            Self::Feedback => &mut gains.feedback,
            Self::Inertia => &mut gains.inertia,
            Self::Friction => &mut gains.friction,
            Self::WindUp => &mut gains.wind_up,
            Self::KinematicError => &mut gains.kinematic_error,
            Self::OutputFeedback => &mut gains.output_feedback,
            Self::Adaptation => &mut gains.adaptation,
            Self::Ripple => &mut gains.ripple,
        }
    }
}

/// Gains that are tried, by the number of their function: forward and backward.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Trial([Option<[f32; 2]>; Function::ALL.len()]);

impl Trial {
    /// The board's own gains.
    pub const NONE: Self = Self([None; Function::ALL.len()]);

    /// Gains may be tried: they are 0..=1.
    pub fn allows(gains: [f32; 2]) -> bool {
        gains.iter().all(|gain| (0.0..=1.0).contains(gain))
    }

    /// The same with these gains of a function; `None` when they are out of range.
    pub fn with(mut self, function: Function, gains: [f32; 2]) -> Option<Self> {
        *self.0.get_mut(function as usize)? = Some(gains);
        Self::allows(gains).then_some(self)
    }

    /// Gains of a function, if any are tried.
    pub fn of(&self, function: Function) -> Option<[f32; 2]> {
        *self.0.get(function as usize)?
    }

    /// The gains of the step's input in the place of the board's own.
    pub fn in_place_of(&self, mut own: Directions<f32>) -> Directions<f32> {
        for (function, tried) in Function::ALL.into_iter().zip(self.0) {
            let Some([forward, backward]) = tried else { continue };
            for (direction, tried) in [(&mut own.forward, forward), (&mut own.backward, backward)] {
                let gain = function.gain(direction);
                if *gain != 0.0 {
                    *gain = tried;
                }
            }
        }
        own
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tried_gain_takes_the_place_of_one_that_is_not_off() {
        let own = CompensationGains { friction: 0.8, ripple: 0.0, ..CompensationGains::ALL };
        let mut trial = Trial::NONE;
        assert_eq!(trial.in_place_of(own.into()), own.into());
        for function in [Function::Friction, Function::Ripple] {
            trial = trial.with(function, [0.25, 0.5]).unwrap();
        }
        let Directions { forward, backward } = trial.in_place_of(own.into());
        assert_eq!(forward, CompensationGains { friction: 0.25, ..own });
        assert_eq!(backward, CompensationGains { friction: 0.5, ..own });
    }

    #[test]
    fn every_function_has_a_gain_and_a_name_of_its_own() {
        for (number, function) in Function::ALL.into_iter().enumerate() {
            assert_eq!(function as usize, number);
            let mut gains = CompensationGains::ALL;
            *function.gain(&mut gains) = 0.5;
            let mut others = Function::ALL.into_iter().filter(|other| *other != function);
            assert!(others.all(|other| *other.gain(&mut gains) == 1.0));
            assert!(Function::ALL[..number].iter().all(|other| other.name() != function.name()));
        }
    }

    #[test]
    fn a_gain_out_of_range_is_not_tried() {
        for gain in [-0.01, 1.01, f32::NAN, f32::INFINITY, -f32::MIN_POSITIVE] {
            for gains in [[gain, 0.5], [0.5, gain]] {
                assert_eq!(Trial::NONE.with(Function::Inertia, gains), None, "{gain}");
            }
        }
        let kept = Trial::NONE.with(Function::Inertia, [0.0, 1.0]).unwrap();
        assert_eq!(kept.of(Function::Inertia), Some([0.0, 1.0]));
    }
}
