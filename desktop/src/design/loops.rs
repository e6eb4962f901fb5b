//! The loops that are judged, as open loops L over frequency.
//!
//! ```text
//! torque loop        broken at the motor's torque command:  L = -C_u P            u = C_u y,  y = P u
//! disturbance loop   broken at the observer's d:            L = -(C_dy P*S*C_ud + C_dd),  S = 1/(1 - C_uy P)
//! ```
//!
//! P is the joint ([`super::plant`]), C the controller's fundamental ([`super::response`]). Where the plant is the model the
//! observer sees nothing of what the motor does, and the second L is 0; what is left of it is T*Delta, T what the path makes
//! of a load and Delta the part of it that returns by the uncertainty. |T| < 1/|Delta| is |L| < 1.
//!
//! K. Zhou, J. Doyle, K. Glover, "Robust and optimal control" (1996), chapter 9 (small gain).

use nalgebra::Complex;

use super::corners::Corner;
use super::parts::Parts;
use super::plant::{self, Plant};
use super::response::{Answer, Response};
use super::variant::Variant;
use crate::io::gear_file::GearFile;
use crate::io::gear_file::SensorSet;
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Point at which a loop is broken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Break {
    /// At the motor's torque command.
    Torque,
    /// At the observer's d, where the disturbance path reads it.
    Disturbance,
}

/// A loop of one set of sensors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Loop {
    /// Sensors.
    pub set: SensorSet,
    /// Point at which it is broken.
    pub broken: Break,
    /// The disturbance path passes everything, or nothing.
    pub passes: bool,
}

impl Loop {
    /// Those of a set.
    pub fn all(set: SensorSet) -> [Self; 3] {
        [(Break::Torque, false), (Break::Torque, true), (Break::Disturbance, true)]
            .map(|(broken, passes)| Self { set, broken, passes })
    }

    /// As in a figure's name.
    pub fn name(&self) -> String {
        let (set, path) = (self.set.name(), if self.passes { "path_on" } else { "path_off" });
        match self.broken {
            Break::Torque => format!("{set}.torque.{path}"),
            Break::Disturbance => format!("{set}.disturbance"),
        }
    }

    /// L, from what controller and plant answer.
    pub fn open(&self, c: &Answer, p: &[Complex<f64>; plant::OUTPUTS]) -> Complex<f64> {
        let torque = -(0..plant::OUTPUTS).map(|k| c[0][k] * p[k]).sum::<Complex<f64>>();
        match self.broken {
            Break::Torque => torque,
            Break::Disturbance => {
                let commanded = c[0][4] / (1.0 + torque);
                let seen = (0..plant::OUTPUTS).map(|k| c[1][k] * p[k]).sum::<Complex<f64>>();
                -(c[1][4] + commanded * seen)
            }
        }
    }
}

/// Frequencies (rad/s): 200 a decade where the modes of joint and load are, fewer elsewhere.
pub fn frequencies() -> Vec<f64> {
    let decades = |from: f64, to: f64, each: f64| {
        let count = ((to / from).log10() * each).round();
        (0..count as usize).map(move |k| from * (to / from).powf(k as f64 / count))
    };
    let nyquist = std::f64::consts::PI / CONTROL_PERIOD;
    decades(0.1, 10.0, 20.0)
        .chain(decades(10.0, 3000.0, 200.0))
        .chain(decades(3000.0, nyquist, 40.0))
        .collect()
}

/// L of the torque loop of one variant in one corner at w (rad/s).
pub fn torque_loop(
    file: &GearFile,
    parts: &Parts,
    variant: Variant,
    corner: &Corner,
    omegas: &[f64],
) -> Vec<Complex<f64>> {
    let response = Response::new(&variant.controller(file, parts), false);
    let plant = Plant::new(file, corner);
    let broken = Loop { set: variant.set, broken: Break::Torque, passes: variant.passes };
    omegas.iter().map(|w| broken.open(&response.at(*w), &plant.at(*w))).collect()
}
