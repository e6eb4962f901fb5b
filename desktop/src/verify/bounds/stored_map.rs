//! Bounds of `verify compensator` in three states of the stored kinematic error: told, learnt, absent.
//!
//! Plants are those of the row `kinematic.stored`: the stored error is off by up to 30 % in amplitude and 0.3 rad in phase.
//!
//! After the move of S3 a joint with a map that is off vibrates by an urad or some; how fast that decays at rest is a question of the damping
//! by the estimate, of which friction that does not slide lets a joint have no more (`design/estimated_damping.rs`).

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
        motor told 0.46, "without a measured output what the map is off by stays; target 0.15";
        motor learnt 1.1, "a motor encoder alone cannot show the kinematic error, and nothing is learnt of it; target 0.15";
        motor absent 1.1, "the kinematic error is neither known nor seen; target 0.15";
        both told 0.05, "the measured output corrects what the map is off by";
        both learnt 0.095, "the ripple is learnt from the measured output, at a steady speed only; target 0.05";
        both absent 0.2, "the kinematic error is left to the feedback of the measured output; target 0.05";
    "s2.rms_to_best",
        "output error of S2 over that of the best baseline with the same map, median of 20 plants and their noises":
        motor told 1.1, "without a measured output what the map is off by stays; target 0.7";
        motor learnt 1.1, "a motor encoder alone cannot show the kinematic error, and nothing is learnt of it; target 0.7";
        motor absent 1.1, "the kinematic error is neither known nor seen; target 0.7";
        both told 0.7, "the measured output corrects what the map is off by";
        both learnt 0.7, "the ripple is learnt from the measured output, at a steady speed only";
        both absent 1.3, "the kinematic error is left to the feedback of the measured output; target 0.7";
    "s3.vibration_to_b0",
        "torsion's vibration after the move of S3 over that of the cascade alone, worst of 20 plants and their noises":
        motor told 1.1, "without a measured output what the map is off by stays; target 0.25";
        motor learnt 3.4, "a motor encoder alone cannot show the kinematic error, and nothing is learnt of it; target 0.25";
        motor absent 3.4, "the kinematic error is neither known nor seen; target 0.25";
        both told 0.95, "the measured output corrects what the map is off by; target 0.2";
        both learnt 3.1, "the ripple is learnt from the measured output, at a steady speed only; target 0.2";
        both absent 3.8, "the kinematic error is left to the feedback of the measured output; target 0.2";
    "s3.vibration_to_best",
        "torsion's vibration after the move of S3 over that of the best baseline with the same map, median of 20 plants and their noises":
        motor told 0.7, "without a measured output what the map is off by stays";
        motor learnt 1.1, "a motor encoder alone cannot show the kinematic error, and nothing is learnt of it; target 0.7";
        motor absent 1.1, "the kinematic error is neither known nor seen; target 0.7";
        both told 0.7, "the measured output corrects what the map is off by";
        both learnt 1.5, "the ripple is learnt from the measured output, at a steady speed only; target 0.7";
        both absent 1.8, "the kinematic error is left to the feedback of the measured output; target 0.7";
    "s4.ripple_to_b0",
        "output error at the orders of the kinematic error in S4 over that of the cascade alone, worst of 20 plants and their noises":
        motor told 0.51, "without a measured output what the map is off by stays; target 0.02";
        motor learnt 1.2, "a motor encoder alone cannot show the kinematic error, and nothing is learnt of it; target 0.02";
        motor absent 1.2, "the kinematic error is neither known nor seen; target 0.02";
        both told 0.05, "the measured output corrects what the map is off by";
        both learnt 0.16, "the ripple is learnt from the measured output, at a steady speed only; target 0.05";
        both absent 0.48, "the kinematic error is left to the feedback of the measured output; target 0.05";
    "s4.ripple_to_best",
        "output error at the orders of the kinematic error in S4 over that of the best baseline with the same map, median of 20 plants and their noises":
        motor told 1.2, "without a measured output what the map is off by stays; target 0.7";
        motor learnt 1.2, "a motor encoder alone cannot show the kinematic error, and nothing is learnt of it; target 0.7";
        motor absent 1.2, "the kinematic error is neither known nor seen; target 0.7";
        both told 0.7, "the measured output corrects what the map is off by";
        both learnt 0.7, "the ripple is learnt from the measured output, at a steady speed only";
        both absent 1.2, "the kinematic error is left to the feedback of the measured output; target 0.7";
};
