//! How much of b, the damping by the estimate ([`strainwave::compensator::reference::output_feedback`]), a joint with a motor encoder alone
//! bears, in motion and at rest.
//!
//! Two things let b swing a joint about its place:
//!
//! - The observer knows the motor's torque no better than the torque constant and the rotor's inertia. What is off it takes for a motion
//!   of the load; b answers with a torque of the motor, of which as much is off: a loop besides that through the gear, and the lighter the
//!   load is beside the rotor at the output, the larger its gain.
//! - At rest friction that does not slide is a spring. Until the observer has detected that the motor stands it corrects with the gains of
//!   one that moves, and takes for a motion of the load what that spring does: the slower the torsion mode is beside the cascade, the
//!   sooner b excites it.
//!
//! b is as much as is stable in every corner of the box, or whole. The corners count in which the motor's acceleration by a torque is the
//! farthest from the file's, with the slowest drive, by the poles of the whole loop ([`poles`]) with the observer's gains of a motor that
//! moves; at rest with friction that slides, which damps and is left out, and with friction that is a spring of the file's presliding
//! distance. A shorter one is a stiffer spring, for which there is no margin. The disturbance path's dead zone passes nothing.
//! With an output encoder the estimate is corrected by what it tells, and the damping is D's, which less of b would leave to swing.

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

/// Fractions, 0..=1, in motion and at rest, of the damping b without an output encoder, of which `parts` have all.
pub fn levels(file: &GearFile, parts: &Parts) -> [f64; 2] {
    if parts.output_feedback[0].damping == 0.0 {
        return [1.0; 2];
    }
    let plants: Vec<_> = corners(file).map(|corner| (corner, Plant::new(file, &corner))).collect();
    let (slides, springs) =
        plants.into_iter().partition::<Vec<_>, _>(|(corner, _)| corner.presliding.is_none());
    let in_motion = level(file, parts, &slides, 1.0);
    [in_motion, level(file, parts, &springs, in_motion)]
}

/// Fraction of b, at most `most`, which is stable in these corners.
fn level(file: &GearFile, parts: &Parts, corners: &[(Corner, Plant)], most: f64) -> f64 {
    let growth = |level: f64| {
        let scaled = scaled(parts, level);
        let of = |(corner, plant): &(Corner, Plant)| growth(file, &scaled, corner, plant);
        corners.iter().map(of).fold(f64::NEG_INFINITY, f64::max)
    };
    let without = growth(0.0).max(0.0) + NONE;
    let bears = |level: f64| growth(level) <= without;
    if bears(most) {
        return most;
    }
    let [mut least, mut most] = [0.0, most];
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
/// flange; each with friction that slides, and that does not.
fn corners(file: &GearFile) -> impl Iterator<Item = Corner> {
    let (delay, bandwidth) = (file.drive.delay as usize, file.drive.least_current_loop);
    let farthest = Corner::all(file, Mode::Moving).into_iter().filter(move |corner| {
        corner.link.is_none()
            && (corner.rotor - 1.0) * (corner.constant - 1.0) <= 0.0
            && (corner.delay, corner.bandwidth) == (delay, bandwidth)
    });
    farthest.flat_map(|corner| [None, Some(1.0)].map(|presliding| Corner { presliding, ..corner }))
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
    use crate::catalogue::Model;
    use crate::catalogue::load::with_load;
    use crate::design::rules::whole;

    /// The default gear with `factor` of its load.
    fn loaded(factor: f64) -> GearFile {
        let file = GearFile::default_gear();
        with_load(&file, factor * file.inertia.flexspline)
    }

    fn worst(file: &GearFile, parts: &Parts, springs: bool) -> f64 {
        let of = |corner: Corner| growth(file, parts, &corner, &Plant::new(file, &corner));
        let corners = corners(file).filter(|corner| springs == corner.presliding.is_some());
        corners.map(of).fold(f64::NEG_INFINITY, f64::max)
    }

    fn of(file: &GearFile) -> [f64; 2] {
        levels(file, &whole(file).unwrap())
    }

    /// A gear of a high ratio, whose torsion mode is far slower than the cascade.
    fn slow() -> GearFile {
        let gear = Model { size: 45, ratio: 160 }.gear(None);
        let rotor = gear.inertia.wave_generator * f64::from(gear.gear.ratio).powi(2);
        with_load(&gear, 3.0 * rotor)
    }

    /// The level is stable in every corner, a little more is not.
    #[test]
    fn the_level_is_as_much_as_is_stable() {
        for (file, springs) in [(loaded(0.3), false), (slow(), true)] {
            let parts = whole(&file).unwrap();
            let level = levels(&file, &parts)[usize::from(springs)];
            assert!((0.1..0.9).contains(&level), "{level}");
            let growth = |level| worst(&file, &scaled(&parts, level), springs);
            let [below, above] = [level, level + 0.0625].map(growth);
            assert!(below <= NONE && above > NONE, "{level}: {below} {above}");
        }
    }

    #[test]
    fn the_default_gear_bears_all_of_it() {
        assert_eq!(of(&GearFile::default_gear()), [1.0; 2]);
    }

    /// What the motor is known for exactly closes no loop of its own.
    #[test]
    fn the_better_the_motor_is_known_the_more() {
        let mut file = loaded(0.3);
        let before = of(&file)[0];
        (file.drive.torque_constant, file.tolerances.rotor_inertia) = (0.01, 0.01);
        let after = of(&file)[0];
        assert!(after > before, "{before} {after}");
    }

    /// The stiffer the spring of a friction that does not slide, the less of it at rest, and as much as ever in motion.
    #[test]
    fn friction_that_does_not_slide_takes_of_it_at_rest() {
        let levels = [0.5, 1.0, 4.0].map(|presliding: f64| {
            let mut file = slow();
            for side in [&mut file.friction.input, &mut file.friction.output] {
                side.presliding = side.presliding.map(|distance| presliding * distance);
            }
            of(&file)
        });
        assert!(levels.iter().all(|[in_motion, _]| *in_motion == 1.0), "{levels:?}");
        assert!(
            levels.is_sorted_by(|[_, stiff], [_, soft]| stiff < soft) && levels[1][1] < 0.5,
            "{levels:?}"
        );
    }

    #[test]
    fn a_joint_without_the_damping_has_nothing_to_lose() {
        let file = loaded(0.001);
        let parts = whole(&file).unwrap();
        assert_eq!((parts.output_feedback[0].damping, levels(&file, &parts)), (0.0, [1.0; 2]));
    }
}
