//! Every key of a gear file, with what it may hold.

use std::f64::consts::PI;
use std::ops::Bound;

use strainwave::compensator::adapt::ripple::RIPPLE_ORDERS as RIPPLE_MAP;
use strainwave::compensator::estimate::observer::LONGEST_PERIOD;
use strainwave::compensator::estimate::observer::past::LONGEST_DELAY;
use strainwave::flexspline::shell::link_law::VALID_STRAIN;
use strainwave::friction::data::MOST_STATES;
use strainwave::friction::{ModelName, RIPPLE_ORDERS};

use crate::io::gear_file::friction_keys::{friction, keys_of};
use crate::io::keyed_file::key::{
    Allowed, Key, Relation, Schema, at_least, joined, key, more_than, optional, positive, within,
};

/// Words of `gear.arrangement`.
const ARRANGEMENTS: &[&str] = &["circular_spline_fixed", "flexspline_fixed"];
/// Words of `flexspline.hardening`.
const HARDENINGS: &[&str] = &["contact", "bends"];
/// The keys in the order of the file. The ranges hold any strain-wave gear from a finger joint to a
/// turntable with room to spare; they keep slips of unit (mm for m, degrees for rad) and nonsense out.
pub const KEYS: &[Key] = &joined::<
    { GEAR.len() + BELT.len() + INPUT.len() + OUTPUT.len() + CONTROL.len() + BASELINES.len() },
>(&[GEAR, BELT, INPUT, OUTPUT, CONTROL, BASELINES]);

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
    optional("hysteresis.weights_nm", Allowed::Triangle(0.0, 1e4, "N m")),
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
    optional("flexspline.hardening", Allowed::Word(HARDENINGS)),
    optional("flexspline.bend_hardening", within(0.0, 1e6, "1")),
    optional("flexspline.bend_saturation", within(0.0, VALID_STRAIN, "1")),
    key("inertia.wave_generator_kg_m2", within(1e-9, 10.0, "kg m^2")),
    key("inertia.flexspline_kg_m2", within(1e-6, 1e5, "kg m^2")),
    key("damping.torsion_mode_ratio", Allowed::Number(Bound::Included(0.0), Bound::Excluded(1.0), "1")),
];

/// The belt between motor and wave generator, with the ranges of a belt file.
const BELT: &[Key] = &[
    key("belt.pitch_m", within(5e-4, 0.1, "m")),
    key("belt.teeth", Allowed::Whole(10, 10_000)),
    key("belt.stiffness_n", within(100.0, 1e9, "N")),
    key("belt.mass_kg_per_m", within(1e-4, 100.0, "kg/m")),
    key("belt.pretension_n", within(0.0, 1e6, "N")),
    key("belt.motor_pulley_teeth", Allowed::Whole(1, 2000)),
    key("belt.wave_generator_pulley_teeth", Allowed::Whole(1, 2000)),
    key("belt.rotor_inertia_kg_m2", within(1e-9, 10.0, "kg m^2")),
    key("belt.mode_damping_ratio", Allowed::Number(Bound::Included(0.0), Bound::Excluded(1.0), "1")),
];

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
    optional("sensors.motor_encoder_still_periods", Allowed::Whole(32, 1000)),
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

/// All of it.
pub(super) const SCHEMA: Schema = Schema {
    relations: RELATIONS,
    sides: &["input", "output"],
    optional_sections: &["belt"],
    ..Schema::of(KEYS)
};
