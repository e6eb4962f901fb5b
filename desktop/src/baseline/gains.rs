//! Gains of a baseline, and their untuned values.
//!
//! | gain | unit | of | unless the gear file's `[baselines]` says otherwise |
//! | --- | --- | --- | --- |
//! | position_bandwidth f_p | Hz | all | `[feedback]` |
//! | velocity_bandwidth f_v | Hz | all | `[feedback]` |
//! | integral_time T_i | s | all | `[feedback]` |
//! | speed_filter_factor | 1 | all | 10: the speed is filtered at so many times f_v |
//! | friction_share | 1 | B1, B2, B3 | B1: 1; B2, B3: `[compensation]` |
//! | output_proportional P | 1 | B3 | 0.4 |
//! | output_integral I | 1/s | B3 | omega_t/5 |
//! | output_derivative D | s | B3 | 2/omega_t |
//! | output_low_pass f_l | Hz | B3 | 6 omega_t/(2 pi) |
//!
//! omega_t = sqrt(K2/J_fs) is the torsion's mode with the motor held: a shift of the motor by D*de/dt damps it by
//! D*omega_t/2.

use std::f64::consts::TAU;

use crate::gear_file::{GearFile, StoredGains};

/// Which baseline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// The cascade alone.
    B0,
    /// With a rigid joint's feed-forward.
    B1,
    /// With kinematic error and wind-up put in advance.
    B2,
    /// With the output's error fed back too.
    B3,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::B0, Self::B1, Self::B2, Self::B3];

    /// The name, as in `b0`.
    pub fn name(self) -> &'static str {
        ["b0", "b1", "b2", "b3"][self as usize]
    }
}

/// The gains of one baseline; those that it does not have are not read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaselineGains {
    /// f_p, bandwidth of the position loop (Hz).
    pub position_bandwidth: f64,
    /// f_v, bandwidth of the velocity loop (Hz).
    pub velocity_bandwidth: f64,
    /// T_i, integral time of the velocity loop (s).
    pub integral_time: f64,
    /// Corner of the speed's low pass in multiples of f_v.
    pub speed_filter_factor: f64,
    /// Fraction of the friction that is fed forward.
    pub friction_share: f64,
    /// P of the output's error.
    pub output_proportional: f64,
    /// I of the output's error (1/s).
    pub output_integral: f64,
    /// D of the output's error (s).
    pub output_derivative: f64,
    /// f_l, corner of its low pass (Hz).
    pub output_low_pass: f64,
}

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
            friction_share: if kind <= Kind::B1 { 1.0 } else { file.compensation.friction_share },
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

/// One gain: its key in the gear file, what it may be, who has it, and where it stands.
pub struct Gain {
    /// In `[baselines.b3]`.
    pub key: &'static str,
    /// Smallest and greatest value.
    pub range: [f64; 2],
    /// Unit, "1" for none.
    pub unit: &'static str,
    /// The first baseline that has it; all after it have it too.
    pub first: Kind,
    /// Its value.
    pub get: fn(&BaselineGains) -> f64,
    /// The place of its value.
    pub place: fn(&mut BaselineGains) -> &mut f64,
    /// The place of its value in the gear file's section.
    pub stored: fn(&mut StoredGains) -> &mut Option<f64>,
}

macro_rules! gain {
    ($first:ident $field:ident $key:literal $range:expr, $unit:literal) => {
        Gain {
            key: $key,
            range: $range,
            unit: $unit,
            first: Kind::$first,
            get: |gains| gains.$field,
            place: |gains| &mut gains.$field,
            stored: |stored| &mut stored.$field,
        }
    };
}

/// Every gain, in the order of [`BaselineGains`]. Those of a range that starts above 0 are searched by their logarithm.
pub const GAINS: &[Gain] = &[
    gain!(B0 position_bandwidth "position_bandwidth_hz" [1.0, 100.0], "Hz"),
    gain!(B0 velocity_bandwidth "velocity_bandwidth_hz" [5.0, 300.0], "Hz"),
    gain!(B0 integral_time "integral_time_s" [0.003, 1.0], "s"),
    gain!(B0 speed_filter_factor "speed_filter_factor" [2.0, 40.0], "1"),
    gain!(B1 friction_share "friction_share" [0.0, 1.0], "1"),
    gain!(B3 output_proportional "output_proportional" [0.01, 10.0], "1"),
    gain!(B3 output_integral "output_integral_per_s" [0.1, 300.0], "1/s"),
    gain!(B3 output_derivative "output_derivative_s" [1e-5, 0.1], "s"),
    gain!(B3 output_low_pass "output_low_pass_hz" [5.0, 2000.0], "Hz"),
];

impl Kind {
    /// The gains that this baseline has.
    pub fn gains(self) -> impl Iterator<Item = &'static Gain> {
        GAINS.iter().filter(move |gain| gain.first <= self)
    }
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
            assert_eq!((gains.position_bandwidth, gains.velocity_bandwidth), (15.0, 60.0));
        }
        let share = |kind| BaselineGains::of(&file, kind).friction_share;
        assert_eq!([Kind::B1, Kind::B2, Kind::B3].map(share), [1.0, 0.8, 0.8]);
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
