//! What `verify compensator` measures against the baselines, with the motor's sensors alone and with an output encoder too.

use super::Bound;

/// Claims by name, unit and what is judged: with either set of sensors the bound, and why it is that.
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
        "torsion's vibration after the steps of S1 over that of the cascade alone, worst of 20 draws":
        motor 0.18, "what feedback with margins reaches; 0.1 is asked";
        both 0.18, "what feedback with margins reaches; 0.05 is asked";
    "s2.rms_to_b0", "1", "output error of S2 over that of the cascade alone, worst of 20 draws":
        motor 0.15, "as asked";
        both 0.05, "as asked";
    "s2.rms_to_b1", "1",
        "output error of S2 over that of the cascade with a rigid joint's feed-forward, worst of 20 draws":
        motor 0.35, "as asked";
        both 0.08, "as asked";
    "s3.vibration_to_b0", "1",
        "torsion's vibration after the move of S3 over that of the cascade alone, worst of 20 draws":
        motor 0.35, "what feedback with margins reaches; 0.25 is asked";
        both 0.30, "what feedback with margins reaches; 0.2 is asked";
    "s3.settling_to_b0", "1",
        "time until the output stays within 20 urad after S3, over that of the cascade alone, worst of 20 draws":
        motor 1.0, "what feedback with margins reaches, a load within static friction is not compensated; 0.25 is asked";
        both 0.2, "as asked";
    "s4.ripple_to_b0", "1",
        "output error at the orders of the kinematic error in S4 over that of the cascade alone, worst of 20 draws":
        motor 0.2, "-14 dB, as asked";
        both 0.06, "what P and D of the measured angle leave; -26 dB is asked";
    "s5.peak_to_b0", "1",
        "largest deviation under the load step of S5 over that of the cascade alone, worst of 20 draws":
        motor 0.95, "the gear is wound up at once for half of a load, a gain margin of 2; 0.6 is asked";
        both 0.95, "the gear is wound up at once for half of a load, a gain margin of 2; 0.55 is asked";
    "s5.steady_to_b0", "1",
        "what remains of the deviation under the load step of S5, over that of the cascade alone, worst of 20 draws":
        motor 0.45, "what static friction may hide is not compensated; 0.2 is asked";
        both 0.02, "as asked";
    "external_torque", "1",
        "estimated external torque over S1-S5, rms, as a share of rated torque, worst of 20 draws":
        motor 0.03, "as asked";
        both 0.02, "as asked";
    "outside_three_deviations", "1",
        "share of S1-S5 in which an estimate is off by more than three deviations that it states, the worst of seven, \
         worst of 20 draws":
        motor 0.01, "as asked";
        both 0.01, "as asked";
    "box.unstable", "run",
        "runs of S1-S5 on 1000 draws with doubled sensor noise that diverge, stay at the torque limit or keep ringing":
        motor 0.0, "as asked";
        both 0.0, "as asked";
    "box.worse_than_b0", "run",
        "runs of S1-S5 on 1000 draws with doubled sensor noise whose output error is more than 1 % larger than that of \
         the cascade alone":
        motor 0.0, "as asked";
        both 0.0, "as asked";
};
