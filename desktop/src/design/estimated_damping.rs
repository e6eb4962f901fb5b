//! How much of b, the damping by the estimate ([`strainwave::compensator::reference::output_feedback`]), a joint bears: in motion with a
//! motor encoder alone, and at rest.
//!
//! Two things let b swing a joint about its place:
//!
//! - The observer knows the motor's torque no better than the torque constant and the rotor's inertia. What is off it takes for a motion
//!   of the load; b answers with a torque of the motor, of which as much is off: a loop besides that through the gear, and the lighter the
//!   load is beside the rotor at the output, the larger its gain. With an output encoder the estimate is corrected by what it tells, and
//!   b is whole in motion.
//! - At rest friction that does not slide is a spring. Until the observer has detected that the motor stands it corrects with the gains of
//!   one that moves, and takes for a motion of the load what that spring does: the slower the torsion mode is beside the cascade, the
//!   more of it, and the sooner b excites it; the stiffer the spring, too. An output encoder that reads once a round does not prevent it.
//!
//! b is as much as is stable in every corner of the box, or whole. The corners count in which the motor's acceleration by a torque is the
//! farthest from the file's, with the slowest drive, by the poles of the whole loop ([`poles`]) with the observer's gains of a motor that
//! moves; at rest with friction that slides, which damps and is left out, and with friction that is a spring of the shortest presliding
//! distance of the box, with the P and D of rest. There is no margin for a shorter one, as of static friction without any: what swings
//! then, the supervisor ends. The disturbance path's dead zone passes nothing.

use super::corners::{Corner, PRESLIDING};
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

/// Fractions, 0..=1, of the damping b.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Levels {
    /// In motion, without an output encoder.
    pub in_motion: f64,
    /// At rest, without and with one.
    pub at_rest: [f64; 2],
}

impl Levels {
    /// All of it.
    pub const FULL: Self = Self { in_motion: 1.0, at_rest: [1.0; 2] };

    /// As much as a joint bears of that which `parts` have whole.
    pub fn of(file: &GearFile, parts: &Parts) -> Self {
        if parts.output_feedback[0].damping == 0.0 {
            return Self::FULL;
        }
        let plants: Vec<_> = corners(file).map(|corner| (corner, Plant::new(file, &corner))).collect();
        let (slides, springs) =
            plants.into_iter().partition::<Vec<_>, _>(|(corner, _)| corner.presliding.is_none());
        let in_motion = level(file, parts, SensorSet::Motor, &slides, 1.0);
        let resting = resting(parts);
        let at_rest = |set, most| level(file, &resting, set, &springs, most);
        Self { in_motion, at_rest: [at_rest(SensorSet::Motor, in_motion), at_rest(SensorSet::Both, 1.0)] }
    }
}

/// Fraction of b with a set of sensors, at most `most`, which is stable in these corners.
fn level(file: &GearFile, parts: &Parts, set: SensorSet, corners: &[(Corner, Plant)], most: f64) -> f64 {
    let growth = |level: f64| {
        let scaled = scaled(parts, level);
        let of = |(corner, plant): &(Corner, Plant)| growth(file, &scaled, set, corner, plant);
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

/// With the feedback of the measured angle of a joint at rest, whose motor the observer takes for one that moves.
fn resting(parts: &Parts) -> Parts {
    let mut resting = *parts;
    let gains = &mut resting.measured_feedback;
    (gains.proportional, gains.derivative) = (gains.proportional_at_rest, gains.derivative_at_rest);
    resting
}

/// With this part of b.
fn scaled(parts: &Parts, level: f64) -> Parts {
    let mut scaled = *parts;
    for gains in &mut scaled.output_feedback {
        gains.damping *= level;
    }
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
    farthest.flat_map(|corner| [None, Some(PRESLIDING[0])].map(|presliding| Corner { presliding, ..corner }))
}

/// Growth of the closed loop's fastest mode (1/s).
fn growth(file: &GearFile, parts: &Parts, set: SensorSet, corner: &Corner, plant: &Plant) -> f64 {
    let variant = Variant { set, mode: Mode::Moving, point: corner.point, passes: false };
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

    fn worst(file: &GearFile, parts: &Parts, set: SensorSet, springs: bool) -> f64 {
        let of = |corner: Corner| growth(file, parts, set, &corner, &Plant::new(file, &corner));
        let corners = corners(file).filter(|corner| springs == corner.presliding.is_some());
        corners.map(of).fold(f64::NEG_INFINITY, f64::max)
    }

    fn of(file: &GearFile) -> Levels {
        Levels::of(file, &whole(file).unwrap())
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
        let check = |file: &GearFile, parts: &Parts, set, springs, level: f64| {
            assert!((0.1..0.9).contains(&level), "{level}");
            let growth = |level| worst(file, &scaled(parts, level), set, springs);
            let [below, above] = [level, level + 0.0625].map(growth);
            assert!(below <= NONE && above > NONE, "{level}: {below} {above}");
        };
        let file = loaded(0.3);
        let parts = whole(&file).unwrap();
        check(&file, &parts, SensorSet::Motor, false, of(&file).in_motion);
        let file = GearFile::default_gear();
        let resting = resting(&whole(&file).unwrap());
        for (set, level) in SensorSet::ALL.into_iter().zip(of(&file).at_rest) {
            check(&file, &resting, set, true, level);
        }
    }

    #[test]
    fn the_default_gear_bears_all_of_it_in_motion() {
        assert_eq!(of(&GearFile::default_gear()).in_motion, 1.0);
    }

    /// What the motor is known for exactly closes no loop of its own.
    #[test]
    fn the_better_the_motor_is_known_the_more() {
        let mut file = loaded(0.3);
        let before = of(&file).in_motion;
        (file.drive.torque_constant, file.tolerances.rotor_inertia) = (0.01, 0.01);
        let after = of(&file).in_motion;
        assert!(after > before, "{before} {after}");
    }

    /// The stiffer the spring of a friction that does not slide, the less of it at rest, and as much as ever in motion.
    #[test]
    fn friction_that_does_not_slide_takes_of_it_at_rest() {
        let levels = [1.0, 2.0, 8.0].map(|presliding: f64| {
            let mut file = slow();
            for side in [&mut file.friction.input, &mut file.friction.output] {
                side.presliding = side.presliding.map(|distance| presliding * distance);
            }
            of(&file)
        });
        assert!(levels.iter().all(|levels| levels.in_motion == 1.0), "{levels:?}");
        for set in SensorSet::ALL {
            let at_rest = levels.map(|levels| levels.at_rest[set as usize]);
            assert!(
                at_rest.is_sorted_by(|stiff, soft| stiff < soft) && at_rest[0] < 0.5 * at_rest[2],
                "{at_rest:?}"
            );
        }
    }

    #[test]
    fn a_joint_without_the_damping_has_nothing_to_lose() {
        let file = loaded(0.001);
        let parts = whole(&file).unwrap();
        assert_eq!((parts.output_feedback[0].damping, Levels::of(&file, &parts)), (0.0, Levels::FULL));
    }
}
