//! Untuned gains of a baseline.
//!
//! | gain | unit | of | unless the gear file's `[baselines]` says otherwise |
//! | --- | --- | --- | --- |
//! | position_bandwidth f_p | Hz | all | `[feedback]` |
//! | velocity_bandwidth f_v | Hz | all | `[feedback]` |
//! | integral_time T_i | s | all | `[feedback]` |
//! | speed_filter_factor | 1 | all | 10: the speed is filtered at so many times f_v |
//! | friction_gain | 1 | B1, B2, B3 | B1: 1; B2, B3: `[compensation]` |
//! | output_proportional P | 1 | B3 | 0.4 |
//! | output_integral I | 1/s | B3 | omega_t/5 |
//! | output_derivative D | s | B3 | 2/omega_t |
//! | output_low_pass f_l | Hz | B3 | 6 omega_t/(2 pi) |
//!
//! omega_t = sqrt(K2/J_fs) is the torsion's mode with the motor held: a shift of the motor by D*de/dt damps it by
//! D*omega_t/2.

use std::f64::consts::TAU;

use crate::io::gear_file::{BaselineGains, GearFile, Kind};

impl BaselineGains {
    /// Gains of this baseline in the gear file, else by the rule of the table above.
    pub fn of(file: &GearFile, kind: Kind) -> Self {
        let stored = file.baselines.as_ref().and_then(|stored| stored.of(kind));
        stored.map_or_else(|| Self::untuned(file, kind), |stored| stored.over(&Self::untuned(file, kind)))
    }

    /// The rule of the table above.
    pub fn untuned(file: &GearFile, kind: Kind) -> Self {
        let mode = torsion_mode(file);
        Self {
            position_bandwidth: file.feedback.position_bandwidth,
            velocity_bandwidth: file.feedback.velocity_bandwidth,
            integral_time: file.feedback.integral_time,
            speed_filter_factor: 10.0,
            friction_gain: if kind <= Kind::B1 { 1.0 } else { file.compensation.friction_gain },
            output_proportional: 0.4,
            output_integral: 0.2 * mode,
            output_derivative: 2.0 / mode,
            output_low_pass: 6.0 * mode / TAU,
        }
    }
}

/// omega_t (rad/s).
pub(crate) fn torsion_mode(file: &GearFile) -> f64 {
    (file.stiffness.k2 / file.inertia.flexspline).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without a section of its own a baseline is what `[feedback]` makes of it.
    #[test]
    fn the_rule_is_that_of_the_feedback() {
        let mut file = GearFile::default_gear();
        file.baselines = None;
        for kind in Kind::ALL {
            let gains = BaselineGains::of(&file, kind);
            assert_eq!(gains, BaselineGains::untuned(&file, kind));
            assert_eq!((gains.position_bandwidth, gains.velocity_bandwidth), (22.5, 60.0));
        }
        let fraction = |kind| BaselineGains::of(&file, kind).friction_gain;
        assert_eq!([Kind::B1, Kind::B2, Kind::B3].map(fraction), [1.0, 0.8, 0.8]);
    }

    #[test]
    fn the_rule_lies_within_every_range() {
        let file = GearFile::default_gear();
        for kind in Kind::ALL {
            let mut gains = BaselineGains::untuned(&file, kind);
            for gain in kind.gains() {
                let value = (gain.get)(&gains);
                assert!(gain.range[0] <= value && value <= gain.range[1], "{}: {value}", gain.key);
                assert_eq!(*(gain.place)(&mut gains), value);
            }
        }
        assert_eq!(Kind::ALL.map(|kind| kind.gains().count()), [4, 5, 5, 9]);
    }
}
