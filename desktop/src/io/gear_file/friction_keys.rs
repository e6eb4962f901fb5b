//! The keys of one side's friction.

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

pub(crate) use {friction, keys_of};
