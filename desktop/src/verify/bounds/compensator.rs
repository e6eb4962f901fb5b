//! Bounds of `verify compensator`: ratios to the baselines, with the motor's sensors alone and with an output encoder too.

use super::Bound;

/// Claims by name, unit and metric: with either set of sensors the bound and its reason.
macro_rules! claims {
    ($($name:literal, $unit:literal, $what:literal:
        motor $motor:literal, $why_motor:literal; both $both:literal, $why_both:literal;)*) => {
        &[$(
            Bound {
                name: concat!("compensator.motor.", $name),
                value: $motor,
                unit: $unit,
                why: concat!($what, "; ", $why_motor),
            },
            Bound {
                name: concat!("compensator.both.", $name),
                value: $both,
                unit: $unit,
                why: concat!($what, "; ", $why_both),
            },
        )*]
    };
}

pub(super) const ROWS: &[Bound] = claims! {
    "s1.vibration_to_b0", "1",
        "torsion's vibration after the steps of S1 over that of the cascade alone, worst of 20 plant samples":
        motor 0.19, "limit of feedback with margins; target 0.1";
        both 0.16, "limit of feedback with margins; target 0.05";
    "s2.rms_to_b0", "1", "output error of S2 over that of the cascade alone, worst of 20 plant samples":
        motor 0.15, "friction and hysteresis at reversals compensated to a seventh";
        both 0.05, "with the output measured to a twentieth";
    "s2.rms_to_b1", "1",
        "output error of S2 over that of the cascade with a rigid joint's feed-forward, worst of 20 plant samples":
        motor 0.35, "a third of the feed-forward that practitioners use";
        both 0.08, "with the output measured a twelfth";
    "s3.vibration_to_b0", "1",
        "torsion's vibration after the move of S3 over that of the cascade alone, worst of 20 plant samples":
        motor 0.25, "what the adaptation leaves of a move's vibration, without a measured output";
        both 0.25, "limit of feedback with margins; target 0.2";
    "s3.settling_to_b0", "1",
        "time until the output stays within 20 urad after S3, over that of the cascade alone, worst of 20 plant samples":
        motor 0.25, "a fast move is finished when its profile is";
        both 0.2, "a fast move is finished when its profile is";
    "s4.ripple_to_b0", "1",
        "output error at the orders of the kinematic error in S4 over that of the cascade alone, worst of 20 plant samples":
        motor 0.02, "-34 dB: kinematic-error ripple at crawling speed";
        both 0.11, "what P and D of the measured angle leave, and a ripple that is learnt at a steady speed, no faster than a joint of any load bears; target 0.05, -26 dB";
    "s5.peak_to_b0", "1",
        "largest deviation under the load step of S5 over that of the cascade alone, worst of 20 plant samples":
        motor 0.95, "the gear is wound up at once for half of a load, a gain margin of 2; target 0.6";
        both 0.95, "the gear is wound up at once for half of a load, a gain margin of 2; target 0.55";
    "s5.steady_to_b0", "1",
        "steady deviation under the load step of S5 over that of the cascade alone, worst of 20 plant samples":
        motor 0.45, "a load within static friction is not compensated; target 0.2";
        both 0.02, "a measured output returns to its setpoint under a constant load";
    "external_torque", "1",
        "estimated external torque over S1-S5, rms, as a fraction of rated torque, worst of 20 plant samples":
        motor 0.03, "joint torque without a torque sensor, to a few percent";
        both 0.02, "the same with the torsion measured";
    "outside_three_deviations", "1",
        "fraction of S1-S5 in which an estimate's error exceeds three of its declared standard deviations, worst of seven, \
         worst of 20 plant samples":
        motor 0.01, "declared standard deviations hold in 99 % of the time";
        both 0.01, "declared standard deviations hold in 99 % of the time";
    "box.unstable", "run",
        "runs of S1-S5 on 1000 plant samples with doubled sensor noise that diverge, stay at the torque limit or keep ringing":
        motor 0.0, "stability on every plant of the box";
        both 0.0, "stability on every plant of the box";
    "box.worse_than_b0", "run",
        "runs of S1-S5 on 1000 plant samples with doubled sensor noise whose output error is more than 1 % larger than that of \
         the cascade alone":
        motor 0.0, "compensation never degrades a run";
        both 0.0, "compensation never degrades a run";
    "box_sample.unstable", "run",
        "runs that diverge, stay at the torque limit or keep ringing on the first 100 of these 1000 plant samples, which \
         `strainwave verify` of all parts goes through":
        motor 0.0, "stability on every plant of the box";
        both 0.0, "stability on every plant of the box";
    "box_sample.worse_than_b0", "run",
        "runs whose output error is more than 1 % larger than that of the cascade alone on the first 100 of these 1000 plant \
         samples, which `strainwave verify` of all parts goes through":
        motor 0.0, "compensation never degrades a run";
        both 0.0, "compensation never degrades a run";
};
