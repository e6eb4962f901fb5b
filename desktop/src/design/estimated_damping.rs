//! How much of b, the damping by the estimate ([`strainwave::compensator::reference::output_feedback`]), a joint bears in motion and at
//! rest.
//!
//! Two things let b swing a joint about its place:
//!
//! - The observer knows the motor's torque no better than the torque constant and the rotor's inertia. What is off it takes for a motion
//!   of the load; b answers with a torque of the motor, of which as much is off: a loop besides that through the gear, and the lighter the
//!   load is beside the rotor at the output, the larger its gain. An output encoder that reads once a round corrects the estimate too
//!   late where that loop is faster.
//! - At rest friction that does not slide is a spring. Until the observer has detected that the motor stands it corrects with the gains of
//!   one that moves, and takes for a motion of the load what that spring does: the slower the torsion mode is beside the cascade, the
//!   more of it, and the sooner b excites it; the stiffer the spring, too. An output encoder that reads once a round does not prevent it.
//!
//! b is as much as is stable in every corner of `stable_level.rs`, or whole: in motion with friction that slides, which damps and is left
//! out, and without k, whose own growth would hide that of b and which gets its level after it; at rest with all of k, with friction that is a spring
//! of the shortest presliding distance of the box, with the P and D of rest, and no more than in motion. There is no margin
//! for a shorter one, as of static friction without any: what swings then, the supervisor ends.

use super::corners::PRESLIDING;
use super::parts::Parts;
use super::stable_level::{Corners, resting};
use crate::io::gear_file::{GearFile, SensorSet};

/// Fractions, 0..=1, of the damping b, without and with an output encoder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Levels {
    /// In motion.
    pub in_motion: [f64; 2],
    /// At rest.
    pub at_rest: [f64; 2],
}

impl Levels {
    /// All of it.
    pub const FULL: Self = Self { in_motion: [1.0; 2], at_rest: [1.0; 2] };

    /// As much as a joint bears of that which `parts` have whole.
    pub fn of(file: &GearFile, parts: &Parts) -> Self {
        if parts.output_feedback[0].damping == 0.0 {
            return Self::FULL;
        }
        let [slides, springs] = [None, Some(PRESLIDING[0])].map(|presliding| Corners::of(file, presliding));
        let borne = |corners: &Corners, set, parts: &Parts, most| {
            corners.level(set, most, |factor| scaled(parts, factor))
        };
        let alone = without_integral(parts);
        let in_motion = SensorSet::ALL.map(|set| borne(&slides, set, &alone, 1.0));
        let resting = resting(parts);
        let at_rest = SensorSet::ALL.map(|set| borne(&springs, set, &resting, in_motion[set as usize]));
        Self { in_motion, at_rest }
    }
}

/// Without k, whose level follows ([`super::integral_level`]).
fn without_integral(parts: &Parts) -> Parts {
    let mut alone = *parts;
    for gains in &mut alone.output_feedback {
        gains.integral = 0.0;
    }
    alone
}

/// With this part of b.
fn scaled(parts: &Parts, level: f64) -> Parts {
    let mut scaled = *parts;
    for gains in &mut scaled.output_feedback {
        gains.damping *= level;
    }
    scaled
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::Model;
    use crate::catalogue::load::with_load;
    use crate::design::rules::whole;
    use crate::design::stable_level::NONE;

    /// The default gear with `factor` of its load.
    fn loaded(factor: f64) -> GearFile {
        let file = GearFile::default_gear();
        with_load(&file, factor * file.inertia.flexspline)
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
        let check = |file: &GearFile, parts: &Parts, set, presliding, level: f64| {
            assert!((0.1..0.9).contains(&level), "{level}");
            let corners = Corners::of(file, presliding);
            let growth = |level| corners.growth(set, &scaled(parts, level));
            let [below, above] = [level, level + 0.0625].map(growth);
            assert!(below <= NONE && above > NONE, "{level}: {below} {above}");
        };
        let file = loaded(0.3);
        let parts = whole(&file).unwrap();
        check(&file, &parts, SensorSet::Motor, None, of(&file).in_motion[0]);
        let file = GearFile::default_gear();
        let resting = resting(&whole(&file).unwrap());
        for (set, level) in SensorSet::ALL.into_iter().zip(of(&file).at_rest) {
            check(&file, &resting, set, Some(PRESLIDING[0]), level);
        }
    }

    #[test]
    fn the_default_gear_bears_all_of_it_in_motion() {
        assert_eq!(of(&GearFile::default_gear()).in_motion, [1.0; 2]);
    }

    /// What the motor is known for exactly closes no loop of its own.
    #[test]
    fn the_better_the_motor_is_known_the_more() {
        let mut file = loaded(0.3);
        let before = of(&file).in_motion[0];
        (file.drive.torque_constant, file.tolerances.rotor_inertia) = (0.01, 0.01);
        let after = of(&file).in_motion[0];
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
        assert!(levels.iter().all(|levels| levels.in_motion == [1.0; 2]), "{levels:?}");
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
