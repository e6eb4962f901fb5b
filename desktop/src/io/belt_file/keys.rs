//! Every key of a belt file, with what it may hold.

use std::f64::consts::PI;
use std::ops::Bound;

use strainwave::friction::data::MOST_STATES;
use strainwave::friction::{ModelName, RIPPLE_ORDERS};

use crate::io::gear_file::friction_keys::{friction, keys_of};
use crate::io::keyed_file::key::{Allowed, Key, Relation, Schema, at_least, joined, key, optional, within};

/// The keys in the order of the file. The ranges hold any tooth belt from a printer to a conveyor with room to spare; they keep slips of unit
/// (mm for m, degrees for rad) and nonsense out.
pub const KEYS: &[Key] = &joined::<{ BELT.len() + MOTOR.len() + OUTPUT.len() }>(&[BELT, MOTOR, OUTPUT]);

const BELT: &[Key] = &[
    key("belt.name", Allowed::Text),
    key("belt.pitch_m", within(5e-4, 0.1, "m")),
    key("belt.teeth", Allowed::Whole(10, 10_000)),
    key("belt.stiffness_n", within(100.0, 1e9, "N")),
    key("belt.mass_kg_per_m", within(1e-4, 100.0, "kg/m")),
    key("belt.pretension_n", within(0.0, 1e6, "N")),
    key("motor_pulley.teeth", Allowed::Whole(1, 2000)),
    key("motor_pulley.inertia_kg_m2", within(1e-9, 10.0, "kg m^2")),
    key("output_pulley.teeth", Allowed::Whole(1, 2000)),
    key("output_pulley.inertia_kg_m2", within(1e-8, 1e5, "kg m^2")),
    key("damping.output_mode_ratio", Allowed::Number(Bound::Included(0.0), Bound::Excluded(1.0), "1")),
    key("pitch_error.motor[].order", Allowed::Whole(1, 1000)),
    key("pitch_error.motor[].amplitude_m", within(0.0, 0.01, "m")),
    key("pitch_error.motor[].phase_rad", within(-PI, PI, "rad")),
    key("pitch_error.output[].order", Allowed::Whole(1, 1000)),
    key("pitch_error.output[].amplitude_m", within(0.0, 0.01, "m")),
    key("pitch_error.output[].phase_rad", within(-PI, PI, "rad")),
    key("pitch_error.belt[].order", Allowed::Whole(1, 1000)),
    key("pitch_error.belt[].amplitude_m", within(0.0, 0.01, "m")),
    key("pitch_error.belt[].phase_rad", within(-PI, PI, "rad")),
];

const MOTOR: &[Key] = friction!("motor", 1e3, 1e4, 1e3, 10.0);
const OUTPUT: &[Key] = friction!("output", 1e4, 1e3, 1e5, 1.0);

/// Relations beyond the ranges of single keys: breakaway is the higher friction level.
const RELATIONS: &[Relation] = &[
    at_least("friction.motor.static_nm", "friction.motor.coulomb_nm"),
    at_least("friction.output.static_nm", "friction.output.coulomb_nm"),
];

/// All of it.
pub(super) const SCHEMA: Schema =
    Schema { relations: RELATIONS, sides: &["motor", "output"], ..Schema::of(KEYS) };
