//! Bounds of `verify compensator` in three states of the stored kinematic error: told, learnt, absent.
//!
//! Plants are those of the row `kinematic.stored`: the stored error is off by up to 30 % in amplitude and 0.3 rad in phase.

use super::Bound;

/// Claims by metric: with either set of sensors and in each state of the map the bound and its reason.
macro_rules! claims {
    ($($name:literal, $what:literal: $($sensors:ident $map:ident $value:literal, $why:literal;)*)*) => {
        &[$($(
            Bound {
                name: concat!("compensator.", stringify!($sensors), ".map_", stringify!($map), ".", $name),
                value: $value,
                unit: "1",
                why: concat!($what, "; ", $why),
            },
        )*)*]
    };
}

pub(super) const ROWS: &[Bound] = claims! {
    "s2.rms_to_b0",
        "output error of S2 over that of the cascade alone, worst of 20 plants and their noises":
        motor told 1.0, "to be measured";
        motor learnt 1.0, "to be measured";
        motor absent 1.0, "to be measured";
        both told 1.0, "to be measured";
        both learnt 1.0, "to be measured";
        both absent 1.0, "to be measured";
    "s2.rms_to_best",
        "output error of S2 over that of the best baseline with the same map, median of 20 plants and their noises":
        motor told 1.0, "to be measured";
        motor learnt 1.0, "to be measured";
        motor absent 1.0, "to be measured";
        both told 1.0, "to be measured";
        both learnt 1.0, "to be measured";
        both absent 1.0, "to be measured";
    "s3.vibration_to_b0",
        "torsion's vibration after the move of S3 over that of the cascade alone, worst of 20 plants and their noises":
        motor told 1.0, "to be measured";
        motor learnt 1.0, "to be measured";
        motor absent 1.0, "to be measured";
        both told 1.0, "to be measured";
        both learnt 1.0, "to be measured";
        both absent 1.0, "to be measured";
    "s3.vibration_to_best",
        "torsion's vibration after the move of S3 over that of the best baseline with the same map, median of 20 plants and their noises":
        motor told 1.0, "to be measured";
        motor learnt 1.0, "to be measured";
        motor absent 1.0, "to be measured";
        both told 1.0, "to be measured";
        both learnt 1.0, "to be measured";
        both absent 1.0, "to be measured";
    "s4.ripple_to_b0",
        "output error at the orders of the kinematic error in S4 over that of the cascade alone, worst of 20 plants and their noises":
        motor told 1.0, "to be measured";
        motor learnt 1.0, "to be measured";
        motor absent 1.0, "to be measured";
        both told 1.0, "to be measured";
        both learnt 1.0, "to be measured";
        both absent 1.0, "to be measured";
    "s4.ripple_to_best",
        "output error at the orders of the kinematic error in S4 over that of the best baseline with the same map, median of 20 plants and their noises":
        motor told 1.0, "to be measured";
        motor learnt 1.0, "to be measured";
        motor absent 1.0, "to be measured";
        both told 1.0, "to be measured";
        both learnt 1.0, "to be measured";
        both absent 1.0, "to be measured";
};
