//! How much of b, the damping by the estimate ([`strainwave::compensator::reference::output_feedback`]), a joint with a motor encoder alone
//! bears.
//!
//! The observer knows the motor's torque no better than the torque constant and the rotor's inertia. What is off it takes for a motion of the
//! load; b answers with a torque of the motor, of which as much is off: a loop besides that through the gear, and the lighter the load is
//! beside the rotor at the output, the larger its gain. There a joint at rest would swing about its place, the estimate more than the
//! load.
//!
//! b is as much as is stable in every corner of the box, or whole. The corners count in which the motor's acceleration by a torque is the
//! farthest from the file's, with the slowest drive, by the poles of the whole loop ([`poles`]) with the observer's gains of a motor that
//! moves. Friction, which damps, is left out, and the disturbance path's dead zone passes nothing.
//! With an output encoder the estimate is corrected by what it tells, and the damping is D's.

use super::corners::Corner;
use super::mode::Mode;
use super::parts::Parts;
use super::plant::Plant;
use super::poles;
use super::variant::Variant;
use crate::io::gear_file::{GearFile, SensorSet};

/// Growth of the error (1/s) that counts as none: an integrator of the observer that drifts, and rounding.
const NONE: f64 = 1.0;
/// Halvings of the range in which the level lies.
const HALVINGS: u32 = 5;

/// Fraction, 0..=1, of the damping b without an output encoder, of which `parts` have all.
pub fn level(file: &GearFile, parts: &Parts) -> f64 {
    if parts.output_feedback[0].damping == 0.0 {
        return 1.0;
    }
    let plants: Vec<_> = corners(file).map(|corner| (corner, Plant::new(file, &corner))).collect();
    let growth = |level: f64| {
        let scaled = scaled(parts, level);
        let of = |(corner, plant): &(Corner, Plant)| growth(file, &scaled, corner, plant);
        plants.iter().map(of).fold(f64::NEG_INFINITY, f64::max)
    };
    let without = growth(0.0).max(0.0) + NONE;
    let bears = |level: f64| growth(level) <= without;
    if bears(1.0) {
        return 1.0;
    }
    let [mut least, mut most] = [0.0, 1.0];
    for _ in 0..HALVINGS {
        let middle = 0.5 * (least + most);
        *(if bears(middle) { &mut least } else { &mut most }) = middle;
    }
    least
}

/// With this part of b.
fn scaled(parts: &Parts, level: f64) -> Parts {
    let mut scaled = *parts;
    scaled.output_feedback[0].damping *= level;
    scaled
}

/// Those in which the motor's acceleration by a torque is the farthest from the file's, the slowest drive, without a mode behind the
/// flange.
fn corners(file: &GearFile) -> impl Iterator<Item = Corner> {
    let (delay, bandwidth) = (file.drive.delay as usize, file.drive.least_current_loop);
    Corner::all(file, Mode::Moving).into_iter().filter(move |corner| {
        corner.link.is_none()
            && (corner.rotor - 1.0) * (corner.constant - 1.0) <= 0.0
            && (corner.delay, corner.bandwidth) == (delay, bandwidth)
    })
}

/// Growth of the closed loop's fastest mode (1/s).
fn growth(file: &GearFile, parts: &Parts, corner: &Corner, plant: &Plant) -> f64 {
    let variant = Variant { set: SensorSet::Motor, mode: Mode::Moving, point: corner.point, passes: false };
    let found = poles::eigenvalues(&variant.controller(file, parts), plant);
    found.map_or(f64::INFINITY, |all| poles::growth(&all))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::load::with_load;
    use crate::design::rules::whole;

    /// The default gear with `factor` of its load.
    fn loaded(factor: f64) -> GearFile {
        let file = GearFile::default_gear();
        with_load(&file, factor * file.inertia.flexspline)
    }

    fn worst(file: &GearFile, parts: &Parts) -> f64 {
        let of = |corner: Corner| growth(file, parts, &corner, &Plant::new(file, &corner));
        corners(file).map(of).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The level is stable in every corner, a little more is not.
    #[test]
    fn the_level_is_as_much_as_is_stable() {
        let file = loaded(0.3);
        let parts = whole(&file).unwrap();
        let level = level(&file, &parts);
        assert!((0.1..0.9).contains(&level), "{level}");
        let [below, above] = [level, level + 0.0625].map(|level| worst(&file, &scaled(&parts, level)));
        assert!(below <= NONE && above > NONE, "{level}: {below} {above}");
    }

    #[test]
    fn the_default_gear_bears_all_of_it() {
        let file = GearFile::default_gear();
        assert_eq!(level(&file, &whole(&file).unwrap()), 1.0);
    }

    /// What the motor is known for exactly closes no loop of its own.
    #[test]
    fn the_better_the_motor_is_known_the_more() {
        let mut file = loaded(0.3);
        let before = level(&file, &whole(&file).unwrap());
        (file.drive.torque_constant, file.tolerances.rotor_inertia) = (0.01, 0.01);
        let after = level(&file, &whole(&file).unwrap());
        assert!(after > before, "{before} {after}");
    }

    #[test]
    fn a_joint_without_the_damping_has_nothing_to_lose() {
        let file = loaded(0.001);
        let parts = whole(&file).unwrap();
        assert_eq!((parts.output_feedback[0].damping, level(&file, &parts)), (0.0, 1.0));
    }
}
