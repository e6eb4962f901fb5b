//! Every key of a link file, with what it may hold.

use std::ops::Bound;

use strainwave::link::MOST_MODES;

use crate::io::keyed_file::key::{
    Allowed, Key, Relation, Schema, key, more_than, optional, positive, within,
};

/// Most gauges of a link.
const MOST_GAUGES: usize = 16;
/// Longest link (m).
const LONGEST: f64 = 100.0;

/// Keys of a link file in its order. The ranges hold finger links and cranes; slips of unit are outside of most.
pub const KEYS: &[Key] = &[
    key("link.name", Allowed::Text),
    optional("link.modes", Allowed::Whole(1, MOST_MODES as i64)),
    key("link.length_m", within(1e-3, LONGEST, "m")),
    key("link.bending_stiffness_nm2", within(1e-6, 1e10, "N m^2")),
    key("link.linear_density_kg_per_m", within(1e-5, 1e4, "kg/m")),
    key("link.thickness_m", within(1e-6, 10.0, "m")),
    key("link.payload_kg", within(0.0, 1e5, "kg")),
    optional("link.rated_payload_kg", within(0.0, 1e5, "kg")),
    key("link.payload_inertia_kg_m2", within(0.0, 1e6, "kg m^2")),
    key("link.damping_ratios", Allowed::Numbers(MOST_MODES, 0.99, "1")),
    key("link.gravity_m_per_s2", within(0.0, 100.0, "m/s^2")),
    optional("link.gauges_m", Allowed::Numbers(MOST_GAUGES, LONGEST, "m")),
    key("piezo.start_m", within(0.0, LONGEST, "m")),
    key("piezo.end_m", positive(LONGEST, "m")),
    key("piezo.width_m", within(1e-4, 10.0, "m")),
    key("piezo.thickness_m", within(1e-6, 0.1, "m")),
    key("piezo.youngs_modulus_pa", within(1e6, 1e12, "Pa")),
    key("piezo.charge_constant_m_per_v", within(-1e-8, 1e-8, "m/V")),
    key("piezo.permittivity_f_per_m", within(1e-12, 1e-6, "F/m")),
    key("piezo.voltage_limit_v", within(1e-3, 1e5, "V")),
    key("piezo.rate_limit_v_per_s", within(1e-3, 1e12, "V/s")),
    optional("piezo.hysteresis_width", Allowed::Number(Bound::Included(0.0), Bound::Excluded(0.5), "1")),
    optional("piezo.hysteresis_weights_v", Allowed::Triangle(-1e4, 1e4, "V")),
    optional("piezo.linear_share", within(-10.0, 10.0, "1")),
];

/// Relations beyond the ranges of single keys.
const RELATIONS: &[Relation] = &[more_than("piezo.end_m", 1.0, "piezo.start_m")];

/// All of it.
pub(super) const SCHEMA: Schema =
    Schema { relations: RELATIONS, optional_sections: &["piezo"], ..Schema::of(KEYS) };
