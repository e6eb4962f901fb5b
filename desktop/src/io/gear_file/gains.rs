//! Gains of a baseline: what there are, their keys and ranges, and as the gear file stores them.

use serde::{Deserialize, Serialize};

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
    pub friction_gain: f64,
    /// P of the output's error.
    pub output_proportional: f64,
    /// I of the output's error (1/s).
    pub output_integral: f64,
    /// D of the output's error (s).
    pub output_derivative: f64,
    /// f_l, corner of its low pass (Hz).
    pub output_low_pass: f64,
}

macro_rules! stored {
    ($($(#[$doc:meta])* $field:ident $key:literal,)*) => {
        /// Gains of one baseline; what is left out is as if it had not been tuned.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct StoredGains {
            $($(#[$doc])* #[serde(rename = $key, default, skip_serializing_if = "Option::is_none")] pub $field: Option<f64>,)*
        }

        impl StoredGains {
            /// These gains, and `rule` for what is left out.
            pub fn over(&self, rule: &BaselineGains) -> BaselineGains {
                BaselineGains { $($field: self.$field.unwrap_or(rule.$field),)* }
            }
        }
    };
}

stored! {
    /// Bandwidth of the position loop (Hz).
    position_bandwidth "position_bandwidth_hz",
    /// Bandwidth of the velocity loop (Hz).
    velocity_bandwidth "velocity_bandwidth_hz",
    /// Integral time of the velocity loop (s).
    integral_time "integral_time_s",
    /// Corner of the speed's low pass in multiples of the velocity bandwidth.
    speed_filter_factor "speed_filter_factor",
    /// Fraction of the friction that is fed forward.
    friction_gain "friction_gain",
    /// P of the output's error.
    output_proportional "output_proportional",
    /// I of the output's error (1/s).
    output_integral "output_integral_per_s",
    /// D of the output's error (s).
    output_derivative "output_derivative_s",
    /// Corner of its low pass (Hz).
    output_low_pass "output_low_pass_hz",
}

impl StoredGains {
    /// The gains that a baseline of this kind has.
    pub fn new(kind: Kind, gains: &BaselineGains) -> Self {
        let mut stored = Self::default();
        for gain in kind.gains() {
            *(gain.stored)(&mut stored) = Some((gain.get)(gains));
        }
        stored
    }
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
    gain!(B1 friction_gain "friction_gain" [0.0, 1.0], "1"),
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
