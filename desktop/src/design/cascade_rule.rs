//! The rule for the cascade's gains: the stiffest cascade that has its margins over the box.
//!
//! ```text
//! k_v = omega_c*J_wg              crossover omega_c: above the torsion mode the motor's own inertia is left
//! k_p = omega_c/a, T_i = a/omega_c
//! omega_f = 2*pi*(largest bandwidth of the current loop)
//! ```
//!
//! Position loop and integral have the same lag at the crossover: of all fractions of one lag that gives the largest k_p/T_i.
//! omega_c and a are those with the largest k_v*k_p/T_i = J_wg*omega_c^3/a^2, whose inverse is the integral of the motor's
//! position error after a step of torque, among all on a grid that have their margins in every corner. omega_c is at most
//! where the lags of hold, difference quotient, filter, current loop and delay alone take up all but the phase margin. Faster
//! content of the speed than omega_f makes no torque in any drive of the box.
//!
//! Most candidates fail in the first corner that is looked at, the one in which the last has failed. The corners are those of
//! the slowest drive; the candidate that holds there is looked at in all of them, by margins and by poles. Units: rad, s, N m.
//!
//! K. Astrom, H. Panagopoulos, T. Hagglund, "Design of PI controllers based on non-convex optimization", Automatica 34 (1998).

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::Complex;
use strainwave::compensator::actuate::cascade::FeedbackParams;

use super::cascade;
use super::corners::Corner;
use super::loops::frequencies;
use super::margins::{Margins, margins};
use super::mode::Mode;
use super::plant::Plant;
use crate::design::required;
use crate::io::gear_file::GearFile;
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Steps an octave of omega_c and of a.
const STEPS: f64 = 12.0;
/// Octaves of omega_c below its largest, and of a, that are looked at; a begins at 2.
const OCTAVES: [f64; 2] = [6.0, 4.0];
const LEAST_RATIO: f64 = 2.0;
/// Frequencies that are looked at first (rad/s).
const NARROW: [f64; 2] = [10.0, 3000.0];

/// Margins that a loop must have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Required {
    /// (dB)
    pub gain: f64,
    /// (degrees)
    pub phase: f64,
    /// Beyond the box (control periods).
    pub delay: f64,
}

impl Required {
    /// The bounds of `strainwave design`.
    pub const BOUNDS: Self = Self { gain: required::GAIN, phase: required::PHASE, delay: required::DELAY };

    fn holds(&self, found: &Margins) -> bool {
        found.gain >= self.gain
            && found.phase.to_degrees() >= self.phase
            && found.delay / CONTROL_PERIOD >= self.delay
    }
}

/// Gains by the rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CascadeGains {
    /// omega_c (rad/s).
    pub crossover: f64,
    /// a.
    pub ratio: f64,
    /// omega_f (rad/s).
    pub filter_corner: f64,
}

impl CascadeGains {
    /// For the motor of a gear file.
    pub fn params(&self, file: &GearFile) -> FeedbackParams<f64> {
        FeedbackParams {
            position_gain: self.crossover / self.ratio,
            velocity_gain: self.crossover * file.inertia.wave_generator,
            integral_time: self.ratio / self.crossover,
            filter_corner: self.filter_corner,
            torque_limit: file.motor.peak_torque,
        }
    }

    /// Proportional to k_v*k_p/T_i.
    fn stiffness(&self) -> f64 {
        self.crossover.powi(3) / (self.ratio * self.ratio)
    }
}

/// Corners as answers of the plant to the torque command.
struct Corners {
    omegas: Vec<f64>,
    angles: Vec<Vec<Complex<f64>>>,
    /// That which the last candidate has failed in.
    first: usize,
}

impl Corners {
    fn new(file: &GearFile, corners: &[Corner], omegas: Vec<f64>) -> Self {
        let angle = |corner| {
            let plant = Plant::new(file, corner);
            omegas.iter().map(|w| plant.at(*w)[0]).collect()
        };
        Self { angles: corners.iter().map(angle).collect(), omegas, first: 0 }
    }

    fn hold(&mut self, cascade: &FeedbackParams<f64>, required: &Required) -> bool {
        let answers: Vec<_> = self.omegas.iter().map(|w| cascade::answer(cascade, *w)).collect();
        let holds = |angles: &Vec<Complex<f64>>| {
            let open = angles.iter().zip(&answers).map(|(p, c)| c * p);
            required.holds(&margins(&self.omegas.iter().copied().zip(open).collect::<Vec<_>>()))
        };
        if !holds(&self.angles[self.first]) {
            return false;
        }
        match self.angles.iter().position(|angles| !holds(angles)) {
            Some(failed) => {
                self.first = failed;
                false
            }
            None => true,
        }
    }
}

/// Largest omega_c (rad/s).
fn fastest(file: &GearFile, required: &Required) -> f64 {
    let drive = &file.drive;
    let corners = [drive.least_current_loop, drive.largest_current_loop].map(|hertz| 1.0 / (TAU * hertz));
    let delay = (1.0 + f64::from(drive.delay)) * CONTROL_PERIOD;
    (FRAC_PI_2 - required.phase.to_radians()) / (corners[0] + corners[1] + delay)
}

/// Every candidate, the stiffest first.
fn candidates(file: &GearFile, required: &Required) -> Vec<CascadeGains> {
    let fastest = fastest(file, required);
    let steps = |octaves: f64| (0..=(octaves * STEPS) as u32).map(|k| 2f64.powf(f64::from(k) / STEPS));
    let mut all: Vec<_> = steps(OCTAVES[0])
        .flat_map(|slower| {
            steps(OCTAVES[1]).map(move |ratio| CascadeGains {
                crossover: fastest / slower,
                ratio: LEAST_RATIO * ratio,
                filter_corner: TAU * file.drive.largest_current_loop,
            })
        })
        .collect();
    all.sort_by(|a, b| b.stiffness().total_cmp(&a.stiffness()));
    all
}

/// The stiffest cascade that has these margins over the box of a gear file; `None` where none on the grid has them.
pub fn cascade(file: &GearFile, required: &Required) -> Option<CascadeGains> {
    let corners: Vec<_> = Mode::ALL.into_iter().flat_map(|mode| Corner::all(file, mode)).collect();
    let slowest =
        |c: &&Corner| c.delay == file.drive.delay as usize && c.bandwidth == file.drive.least_current_loop;
    let slow: Vec<_> = corners.iter().filter(slowest).copied().collect();
    let narrow = frequencies().into_iter().filter(|w| (NARROW[0]..NARROW[1]).contains(w)).collect();
    let mut slow = Corners::new(file, &slow, narrow);
    let mut every = Corners::new(file, &corners, frequencies());
    let stable = |gains: &FeedbackParams<f64>| {
        corners.iter().all(|corner| cascade::is_stable(gains, &Plant::new(file, corner)))
    };
    candidates(file, required).into_iter().find(|candidate| {
        let gains = candidate.params(file);
        slow.hold(&gains, required) && every.hold(&gains, required) && stable(&gains)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::corners::Point;
    use crate::design::levels::Levels;
    use crate::design::loops::torque_loop;
    use crate::design::rules;
    use crate::design::variant::Variant;
    use crate::io::gear_file::SensorSet;

    /// The closed formula is the multi-rate controller's with all other functions off.
    #[test]
    fn the_formula_is_that_of_the_controller() {
        let file = GearFile::default_gear();
        let parts = Levels::NONE.apply(&rules::parts(&file).unwrap());
        let variant = Variant { set: SensorSet::Motor, mode: Mode::Moving, point: Point::K1, passes: false };
        let corner = Corner::nominal(Mode::Moving);
        let omegas = [3.0, 30.0, 160.0, 1000.0, 10_000.0];
        let linear = torque_loop(&file, &parts, variant, &corner, &omegas);
        for (omega, linear) in omegas.into_iter().zip(linear) {
            let closed = cascade::answer(&parts.feedback, omega) * Plant::new(&file, &corner).at(omega)[0];
            assert!((closed - linear).norm() < 1e-9 * linear.norm(), "{omega}: {closed} {linear}");
        }
    }

    #[test]
    fn a_wider_box_gives_a_softer_cascade() {
        let narrow = GearFile::default_gear();
        let mut wide = narrow.clone();
        (wide.drive.delay, wide.tolerances.load_inertia) = (4, 0.5);
        let stiffness = |file| cascade(file, &Required::BOUNDS).unwrap().stiffness();
        assert!(stiffness(&wide) < stiffness(&narrow));
    }

    /// Without margins over the box there are no gains.
    #[test]
    fn what_has_no_margins_has_no_gains() {
        let required = Required { gain: 80.0, ..Required::BOUNDS };
        assert_eq!(cascade(&GearFile::default_gear(), &required), None);
    }
}
