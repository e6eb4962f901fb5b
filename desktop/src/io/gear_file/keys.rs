//! Every key of a gear file, with what it may hold.

use std::f64::consts::PI;
use std::fmt;
use std::ops::{Bound, RangeBounds};

use strainwave::compensator::adapt::ripple::RIPPLE_ORDERS as RIPPLE_MAP;
use strainwave::compensator::estimate::observer::LONGEST_PERIOD;
use strainwave::compensator::estimate::observer::past::LONGEST_DELAY;
use strainwave::flexspline::shell::link_law::VALID_STRAIN;
use strainwave::friction::data::MOST_STATES;
use strainwave::friction::{ModelName, RIPPLE_ORDERS};
use strainwave::hysteresis::table::TABLE_LEVELS;

/// Allowed values of a key.
#[derive(Clone, Copy, Debug)]
pub enum Allowed {
    /// 1 to 80 characters without control characters.
    Text,
    /// `true` or `false`.
    Flag,
    /// One of these words.
    Word(&'static [&'static str]),
    /// A whole number from the first to the second.
    Whole(i64, i64),
    /// A finite number between two ends, and its unit.
    Number(Bound<f64>, Bound<f64>, &'static str),
    /// Rows of 1, 2, 3, ... numbers, 2 to [`TABLE_LEVELS`] of them, each number from 0 to the first, and its unit.
    Triangle(f64, &'static str),
    /// One to so many numbers between plus and minus an end, and their unit.
    Numbers(usize, f64, &'static str),
}

/// Longest name of a gear.
pub const LONGEST_TEXT: usize = 80;
/// Most entries of one list of kinematic-error orders.
pub const MOST_ORDERS: usize = 8;

/// One key: its path in the file (`[]` marks a list of tables) and what it may hold.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Dotted path, such as `friction.input.coulomb_nm`.
    pub path: &'static str,
    /// Its allowed values.
    pub allowed: Allowed,
    /// The file need not have it.
    pub optional: bool,
}

pub(crate) const fn key(path: &'static str, allowed: Allowed) -> Key {
    Key { path, allowed, optional: false }
}

pub(crate) const fn optional(path: &'static str, allowed: Allowed) -> Key {
    Key { path, allowed, optional: true }
}

/// From `least` to `most`, both allowed.
pub(crate) const fn within(least: f64, most: f64, unit: &'static str) -> Allowed {
    Allowed::Number(Bound::Included(least), Bound::Included(most), unit)
}

/// More than 0, up to `most`.
pub(crate) const fn positive(most: f64, unit: &'static str) -> Allowed {
    Allowed::Number(Bound::Excluded(0.0), Bound::Included(most), unit)
}

/// Words of `gear.arrangement`.
const ARRANGEMENTS: &[&str] = &["circular_spline_fixed", "flexspline_fixed"];
/// The keys in the order of the file. The ranges hold any strain-wave gear from a finger joint to a
/// turntable with room to spare; they keep slips of unit (mm for m, degrees for rad) and nonsense out.
pub const KEYS: &[Key] = &joined::<
    { GEAR.len() + INPUT.len() + OUTPUT.len() + CONTROL.len() + BASELINES.len() },
>(&[GEAR, INPUT, OUTPUT, CONTROL, BASELINES]);

/// The parts one after the other, `N` keys in all.
const fn joined<const N: usize>(parts: &[&[Key]]) -> [Key; N] {
    let mut all = [parts[0][0]; N];
    let (mut at, mut part) = (0, 0);
    while part < parts.len() {
        let mut index = 0;
        while index < parts[part].len() {
            all[at] = parts[part][index];
            (at, index) = (at + 1, index + 1);
        }
        part += 1;
    }
    all
}

const GEAR: &[Key] = &[
    key("gear.name", Allowed::Text),
    key("gear.ratio", Allowed::Whole(30, 320)),
    key("gear.arrangement", Allowed::Word(ARRANGEMENTS)),
    key("gear.rated_torque_nm", within(0.01, 1e5, "N m")),
    key("gear.peak_torque_nm", within(0.01, 1e5, "N m")),
    key("stiffness.k1_nm_per_rad", within(1.0, 1e8, "N m/rad")),
    key("stiffness.k2_nm_per_rad", within(1.0, 1e8, "N m/rad")),
    key("stiffness.k3_nm_per_rad", within(1.0, 1e8, "N m/rad")),
    key("stiffness.t1_nm", within(1e-3, 1e5, "N m")),
    key("stiffness.t2_nm", within(1e-3, 1e5, "N m")),
    key("hysteresis.width_arcmin", within(0.0, 60.0, "arcmin")),
    optional("hysteresis.half_range_rad", within(1e-6, 0.1, "rad")),
    optional("hysteresis.weights_nm", Allowed::Triangle(1e4, "N m")),
    key("kinematic_error.wave_generator[].order", Allowed::Whole(1, 20)),
    key("kinematic_error.wave_generator[].amplitude_rad", within(0.0, 0.01, "rad")),
    key("kinematic_error.wave_generator[].phase_rad", within(-PI, PI, "rad")),
    key("kinematic_error.flexspline[].order", Allowed::Whole(1, 20)),
    key("kinematic_error.flexspline[].amplitude_rad", within(0.0, 0.01, "rad")),
    key("kinematic_error.flexspline[].phase_rad", within(-PI, PI, "rad")),
    key("flexspline.radius_m", within(0.002, 1.0, "m")),
    key("flexspline.length_m", within(0.002, 1.0, "m")),
    key("flexspline.wall_m", within(1e-5, 0.01, "m")),
    key("flexspline.ellipse_m", within(1e-5, 0.01, "m")),
    key("flexspline.youngs_modulus_pa", within(1e8, 1e12, "Pa")),
    key("flexspline.poisson_ratio", within(0.0, 0.49, "1")),
    key("flexspline.density_kg_per_m3", within(100.0, 3e4, "kg/m^3")),
    optional("flexspline.bend_hardening", within(0.0, 1e6, "1")),
    optional("flexspline.bend_saturation", within(0.0, VALID_STRAIN, "1")),
    key("inertia.wave_generator_kg_m2", within(1e-9, 10.0, "kg m^2")),
    key("inertia.flexspline_kg_m2", within(1e-6, 1e5, "kg m^2")),
    key("damping.torsion_mode_ratio", Allowed::Number(Bound::Included(0.0), Bound::Excluded(1.0), "1")),
];

/// The keys of one side's friction: greatest level (N m), Stribeck speed (rad/s), viscous friction (N m s/rad) and
/// presliding distance (rad). All but the model are optional; [`ModelName::needs`] says which a model needs.
macro_rules! friction {
    ($side:literal, $level:literal, $speed:literal, $viscous:literal, $presliding:literal) => {
        keys_of! { $side:
            key "model" Allowed::Word(ModelName::WORDS),
            optional "coulomb_nm" within(0.0, $level, "N m"),
            optional "static_nm" within(0.0, $level, "N m"),
            optional "stribeck_rad_per_s" within(1e-9, $speed, "rad/s"),
            optional "stribeck_exponent" Allowed::Whole(1, 2),
            optional "viscous_nm_s_per_rad" within(0.0, $viscous, "N m s/rad"),
            optional "presliding_rad" within(1e-9, $presliding, "rad"),
            optional "presliding_ratio" within(0.01, 0.99, "1"),
            optional "dead_band_rad_per_s" within(1e-9, $speed, "rad/s"),
            optional "frictional_memory_s" within(1e-9, 1e3, "s"),
            optional "dwell_s" within(1e-9, 1e6, "s"),
            optional "dahl_exponent" Allowed::Whole(0, 2),
            optional "micro_damping_nm_s_per_rad" within(0.0, $viscous, "N m s/rad"),
            optional "load_driving" within(0.0, 10.0, "1"),
            optional "load_driven" within(0.0, 10.0, "1"),
            optional "ripple_cosines" Allowed::Numbers(RIPPLE_ORDERS, 0.99, "1"),
            optional "ripple_sines" Allowed::Numbers(RIPPLE_ORDERS, 0.99, "1"),
            optional "backward.coulomb_nm" within(0.0, $level, "N m"),
            optional "backward.static_nm" within(0.0, $level, "N m"),
            optional "backward.stribeck_rad_per_s" within(1e-9, $speed, "rad/s"),
            optional "backward.viscous_nm_s_per_rad" within(0.0, $viscous, "N m s/rad"),
            optional "backward.ripple_cosines" Allowed::Numbers(RIPPLE_ORDERS, 0.99, "1"),
            optional "backward.ripple_sines" Allowed::Numbers(RIPPLE_ORDERS, 0.99, "1"),
            key "state_space[].a_per_rad" Allowed::Numbers(MOST_STATES, 1e12, "1/rad"),
            key "state_space[].b_per_rad" within(-1e12, 1e12, "1/rad"),
            key "state_space[].c_nm" within(-1e6, 1e6, "N m"),
        }
    };
}

macro_rules! keys_of {
    ($side:literal: $($kind:ident $name:literal $allowed:expr,)*) => {
        &[$($kind(concat!("friction.", $side, ".", $name), $allowed)),*]
    };
}

const INPUT: &[Key] = friction!("input", 1e3, 1e4, 1e3, 10.0);
const OUTPUT: &[Key] = friction!("output", 1e4, 1e3, 1e5, 1.0);

const CONTROL: &[Key] = &[
    key("motor.peak_torque_nm", positive(1e4, "N m")),
    key("motor.rotor_speed_limit_rad_per_s", positive(1e4, "rad/s")),
    optional("drive.delay_periods", Allowed::Whole(0, 20)),
    optional("drive.current_loop_least_hz", within(10.0, 1e5, "Hz")),
    optional("drive.current_loop_largest_hz", within(10.0, 1e5, "Hz")),
    optional("drive.torque_constant_tolerance", within(0.0, 0.5, "1")),
    optional("tolerances.rotor_inertia", within(0.0, 0.5, "1")),
    optional("tolerances.load_inertia", within(0.0, 0.7, "1")),
    optional("tolerances.stiffness", within(0.0, 0.5, "1")),
    optional("tolerances.friction", within(0.0, 0.7, "1")),
    key("sensors.motor_encoder_bits", Allowed::Whole(10, 32)),
    optional("sensors.motor_encoder_noise_rad", within(0.0, 0.01, "rad")),
    optional("sensors.output_encoder_bits", Allowed::Whole(10, 32)),
    optional("sensors.output_encoder_noise_rad", within(0.0, 0.01, "rad")),
    optional("sensors.output_encoder_zero_rad", within(-PI, PI, "rad")),
    optional("sensors.output_encoder_delay_periods", Allowed::Whole(0, LONGEST_DELAY as i64)),
    optional("sensors.output_encoder_period_periods", Allowed::Whole(1, LONGEST_PERIOD as i64)),
    key("sensors.output_torque", Allowed::Flag),
    key("sensors.motor_torque_noise_nm", within(0.0, 1e3, "N m")),
    key("sensors.output_torque_noise_nm", within(0.0, 1e4, "N m")),
    key("sensors.output_encoder_error[].order", Allowed::Whole(1, 20)),
    key("sensors.output_encoder_error[].amplitude_rad", within(0.0, 0.01, "rad")),
    key("sensors.output_encoder_error[].phase_rad", within(-PI, PI, "rad")),
    key("feedback.position_bandwidth_hz", positive(1e3, "Hz")),
    key("feedback.velocity_bandwidth_hz", positive(1e3, "Hz")),
    key("feedback.integral_time_s", positive(1e3, "s")),
    key("compensation.friction_gain", within(0.0, 1.0, "1")),
    optional("compensation.external_torque_wander_nm_per_sqrt_s", positive(1e5, "N m/s^0.5")),
    optional("learnt.inertia", within(0.1, 1.9, "1")),
    optional("learnt.input_friction", within(0.1, 1.9, "1")),
    optional("learnt.output_friction", within(0.1, 1.9, "1")),
    optional("learnt.compliance", within(0.1, 1.9, "1")),
    optional("learnt.presliding", within(0.1, 1.9, "1")),
    optional("learnt.presliding_stiffness", within(0.1, 1.9, "1")),
    optional("learnt.ripple_position_cosines_rad", Allowed::Numbers(RIPPLE_MAP, 0.01, "rad")),
    optional("learnt.ripple_position_sines_rad", Allowed::Numbers(RIPPLE_MAP, 0.01, "rad")),
    optional("learnt.ripple_torque_cosines_nm", Allowed::Numbers(RIPPLE_MAP, 1e3, "N m")),
    optional("learnt.ripple_torque_sines_nm", Allowed::Numbers(RIPPLE_MAP, 1e3, "N m")),
];

/// The keys of `[baselines.b0]` and so on: those of the cascade, then its own.
macro_rules! baselines {
    ($($section:literal: $($name:literal $allowed:expr),*;)*) => {
        &[$($(optional(concat!("baselines.", $section, ".", $name), $allowed)),*),*]
    };
    ($($section:literal + $($name:literal $allowed:expr),*;)*) => {
        baselines! { $($section:
            "position_bandwidth_hz" within(1.0, 100.0, "Hz"),
            "velocity_bandwidth_hz" within(5.0, 300.0, "Hz"),
            "integral_time_s" within(0.003, 1.0, "s"),
            "speed_filter_factor" within(2.0, 40.0, "1")
            $(, $name $allowed)*;
        )* }
    };
}

const BASELINES: &[Key] = baselines! {
    "b0" +;
    "b1" + "friction_gain" within(0.0, 1.0, "1");
    "b2" + "friction_gain" within(0.0, 1.0, "1");
    "b3" +
        "friction_gain" within(0.0, 1.0, "1"),
        "output_proportional" within(0.01, 10.0, "1"),
        "output_integral_per_s" within(0.1, 300.0, "1/s"),
        "output_derivative_s" within(1e-5, 0.1, "s"),
        "output_low_pass_hz" within(5.0, 2000.0, "Hz");
};

/// Relation between two numbers of the same file.
#[derive(Clone, Copy, Debug)]
pub struct Relation {
    /// The key that is refused.
    pub path: &'static str,
    /// Whether it may equal the limit.
    pub or_equal: bool,
    /// The limit in multiples of `than`.
    pub times: f64,
    /// The key that it is compared with.
    pub than: &'static str,
}

const fn at_least(path: &'static str, than: &'static str) -> Relation {
    Relation { path, or_equal: true, times: 1.0, than }
}

const fn more_than(path: &'static str, times: f64, than: &'static str) -> Relation {
    Relation { path, or_equal: false, times, than }
}

/// Relations beyond the ranges of single keys: the torsion curve hardens, breakaway is the higher
/// friction level, the cup is thin and the inner loop is the faster one.
pub const RELATIONS: &[Relation] = &[
    at_least("gear.peak_torque_nm", "gear.rated_torque_nm"),
    at_least("stiffness.k2_nm_per_rad", "stiffness.k1_nm_per_rad"),
    at_least("stiffness.k3_nm_per_rad", "stiffness.k2_nm_per_rad"),
    more_than("stiffness.t2_nm", 1.0, "stiffness.t1_nm"),
    more_than("flexspline.radius_m", 10.0, "flexspline.wall_m"),
    more_than("flexspline.radius_m", 10.0, "flexspline.ellipse_m"),
    at_least("friction.input.static_nm", "friction.input.coulomb_nm"),
    at_least("friction.output.static_nm", "friction.output.coulomb_nm"),
    at_least("feedback.velocity_bandwidth_hz", "feedback.position_bandwidth_hz"),
];

impl Relation {
    /// `value` stands rightly to the compared key's `other`.
    pub fn holds(&self, value: f64, other: f64) -> bool {
        let limit = self.times * other;
        value > limit || (self.or_equal && value == limit)
    }
}

impl fmt::Display for Relation {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(if self.or_equal { "at least " } else { "more than " })?;
        if self.times != 1.0 {
            write!(formatter, "{} times ", self.times)?;
        }
        formatter.write_str(self.than)
    }
}

/// The controller's f32 has the number, to its precision: it neither vanishes nor overflows.
pub(super) fn in_single_precision(number: f64) -> bool {
    number == 0.0 || (number as f32).is_normal()
}

impl Allowed {
    /// A number that [`Allowed::Number`] or [`Allowed::Whole`] holds, or that may be one of [`Allowed::Numbers`]; NaN and
    /// infinities never, nor what vanishes in the controller's f32.
    pub fn holds(self, number: f64) -> bool {
        match self {
            Self::Number(least, most, _) => (least, most).contains(&number) && in_single_precision(number),
            Self::Numbers(_, end, _) => number.abs() <= end && in_single_precision(number),
            Self::Whole(least, most) => {
                number.fract() == 0.0 && number >= least as f64 && number <= most as f64
            }
            _ => false,
        }
    }

    /// Unit of a number; none of what is no number or has no unit.
    pub fn unit(self) -> Option<&'static str> {
        match self {
            Self::Number(.., unit) | Self::Triangle(_, unit) | Self::Numbers(.., unit) => {
                Some(unit).filter(|unit| *unit != "1")
            }
            _ => None,
        }
    }
}

impl fmt::Display for Allowed {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Text => write!(formatter, "text of 1 to {LONGEST_TEXT} characters"),
            Self::Flag => formatter.write_str("true or false"),
            Self::Word(words) => {
                let quoted: Vec<_> = words.iter().map(|word| format!("{word:?}")).collect();
                formatter.write_str(&quoted.join(" or "))
            }
            Self::Whole(least, most) => write!(formatter, "a whole number from {least} to {most}"),
            Self::Number(least, most, unit) => {
                write!(formatter, "a number {} {}{}", lower_end(least), upper_end(most), unit_after(unit))
            }
            Self::Numbers(most, end, unit) => {
                let (end, unit) = (plain(end), unit_after(unit));
                write!(formatter, "a list of 1 to {most} numbers from -{end} to {end}{unit}")
            }
            Self::Triangle(most, unit) => write!(
                formatter,
                "rows of 1, 2, 3, ... numbers from 0 to {} {unit}, 2 to {TABLE_LEVELS} rows",
                plain(most)
            ),
        }
    }
}

fn unit_after(unit: &str) -> String {
    if unit == "1" { String::new() } else { format!(" {unit}") }
}

fn lower_end(end: Bound<f64>) -> String {
    match end {
        Bound::Included(least) => format!("from {}", plain(least)),
        Bound::Excluded(least) => format!("above {}", plain(least)),
        Bound::Unbounded => String::new(),
    }
}

fn upper_end(end: Bound<f64>) -> String {
    match end {
        Bound::Included(most) => format!("to {}", plain(most)),
        Bound::Excluded(most) => format!("below {}", plain(most)),
        Bound::Unbounded => String::new(),
    }
}

/// Powers of ten for the large and the small, as a person would write them.
fn plain(number: f64) -> String {
    let size = number.abs();
    if size != 0.0 && !(1e-3..1e5).contains(&size) { format!("{number:e}") } else { number.to_string() }
}
