//! How much of k, the integral of the measured error ([`strainwave::compensator::reference::output_feedback`]), a joint bears.
//!
//! k integrates through two poles and the torsion mode and takes damping from that mode, which b, P and D give. Of these a joint has
//! less where its load is light beside the rotor, or a count of its output encoder is coarse: k is then less, too. The margin that
//! is left to it is the gain margin that every loop is asked for ([`super::required::GAIN`]), in every corner of `stable_level.rs`: with the
//! gains of slow motion and with those of rest.
//!
//! A part of the load that swings on a spring behind the flange, at omega_s below the torsion mode, is excited by k, which lags a quarter of
//! its period, and damped by b and D: k < (b + D)*omega_s^2 or so. In the corners with such a mode, half of the load at 20 Hz with a
//! damping ratio of 0.005 at worst, nothing grows with k where all are stable without it, and else nothing faster than the worst without it;
//! they are the ends of the box, and no margin is added.

use super::parts::Parts;
use super::required;
use super::stable_level::{Corners, resting};
use crate::io::gear_file::{GearFile, SensorSet};

/// Fraction, 0..=1, of the k that `parts` have whole, whose b is what the joint bears.
pub fn level(file: &GearFile, parts: &Parts) -> f64 {
    let margin = 10f64.powf(required::GAIN / 20.0);
    let [rigid, flexible] = [Corners::of(file, None), Corners::linked(file)];
    let borne = |parts: &Parts| {
        let most =
            |corners: &Corners, most| corners.level(SensorSet::Both, most, |factor| scaled(parts, factor));
        (most(&rigid, margin) / margin).min(most(&flexible, 1.0))
    };
    let mut at_rest = resting(parts);
    let gains = &mut at_rest.output_feedback[SensorSet::Both as usize];
    gains.damping = gains.damping_at_rest;
    borne(parts).min(borne(&at_rest))
}

/// With so much of k.
fn scaled(parts: &Parts, factor: f64) -> Parts {
    let mut scaled = *parts;
    scaled.output_feedback[SensorSet::Both as usize].integral *= factor;
    scaled
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::Model;
    use crate::catalogue::load::with_load;
    use crate::design::rules;
    use crate::design::stable_level::NONE;

    /// A gear of a high ratio with a light load, and this many bits of its output encoder.
    fn light(bits: u32) -> GearFile {
        let gear = Model { size: 45, ratio: 160 }.gear(None);
        let rotor = gear.inertia.wave_generator * f64::from(gear.gear.ratio).powi(2);
        let mut file = with_load(&gear, 0.57 * rotor);
        file.sensors.output_encoder_bits = Some(bits);
        file.sensors.output_encoder_zero = Some(0.0);
        file
    }

    /// The parts of a joint without this rule.
    fn whole(file: &GearFile) -> Parts {
        let mut parts = rules::parts(file).unwrap();
        parts.output_feedback[1].integral = rules::whole(file).unwrap().output_feedback[1].integral;
        parts
    }

    #[test]
    fn the_default_gear_bears_all_of_it() {
        let file = GearFile::default_gear();
        assert_eq!(level(&file, &whole(&file)), 1.0);
    }

    /// A coarse count leaves less of P and D in slow motion, and so of k.
    #[test]
    fn the_coarser_the_output_encoder_the_less() {
        let levels = [16, 18, 23].map(|bits| {
            let file = light(bits);
            level(&file, &whole(&file))
        });
        assert!(levels.is_sorted_by(|coarse, fine| coarse < fine), "{levels:?}");
        assert!((0.4..0.7).contains(&levels[0]), "{levels:?}");
    }

    /// Growth of a joint of little load on a gear of a low ratio with the mode behind its flange, with and without the rule.
    #[test]
    fn a_load_that_swings_behind_the_flange_is_not_excited() {
        let gear = Model { size: 25, ratio: 30 }.gear(None);
        let rotor = gear.inertia.wave_generator * f64::from(gear.gear.ratio).powi(2);
        let mut file = with_load(&gear, 1.7 * rotor);
        file.sensors.output_encoder_bits = Some(16);
        file.sensors.output_encoder_zero = Some(0.0);
        let corners = Corners::linked(&file);
        let [with, without] =
            [rules::parts(&file).unwrap(), whole(&file)].map(|parts| corners.growth(SensorSet::Both, &parts));
        assert!(with <= NONE && without > 3.0 * NONE, "{with} {without}");
    }

    /// Twice what is left of it is stable in every corner, a little more is not.
    #[test]
    fn the_margin_is_left() {
        let file = light(16);
        let parts = rules::parts(&file).unwrap();
        let corners = Corners::of(&file, None);
        let growth = |factor| corners.growth(SensorSet::Both, &scaled(&parts, factor));
        let [below, above] = [2.0, 2.4].map(growth);
        assert!(below <= NONE && above > NONE, "{below} {above}");
    }
}
