//! Bounds of `verify robustness`: the same for every row and either set of sensors.

use super::Bound;

pub(super) const ROWS: &[Bound] = &[
    Bound {
        name: "robustness.shakes",
        value: 0.0,
        unit: "run",
        why: "runs of S1-S5 on judged plants of one row that diverge or keep oscillating at rest: stability on every judged plant",
    },
    Bound {
        name: "robustness.limited",
        value: 0.0,
        unit: "run",
        why: "runs of S1-S5 on judged plants of one row that stay at the torque limit for more than 10 ms: no move or load requires it",
    },
    Bound {
        name: "robustness.worse",
        value: 0.0,
        unit: "run",
        why: "runs of S1-S5 on judged plants of one row, of which a metric is worse than the cascade's by more than 5 % and 12 urad: \
              compensation never degrades a run",
    },
    Bound {
        name: "robustness.stopped",
        value: 0.0,
        unit: "run",
        why: "runs of S1-S5 on judged plants of one row that end with the drive switched off: nothing in them is broken",
    },
    Bound {
        name: "robustness.s1.vibration",
        value: 0.7,
        unit: "1",
        why: "torsion's vibration after the steps of S1 over that of the best baseline, median of judged plants: a benefit that \
              is clear of the plants' scatter",
    },
    Bound {
        name: "robustness.s2.error",
        value: 0.7,
        unit: "1",
        why: "output error of S2 over that of the best baseline, median of judged plants: a benefit at reversals",
    },
    Bound {
        name: "robustness.s3.vibration",
        value: 0.7,
        unit: "1",
        why: "torsion's vibration after the move of S3 over that of the best baseline, median of judged plants: a benefit after \
              fast moves",
    },
    Bound {
        name: "robustness.s4.error",
        value: 0.7,
        unit: "1",
        why: "output error of S4 over that of the best baseline, median of judged plants: a benefit in slow motion",
    },
    Bound {
        name: "robustness.rest.torque",
        value: 2.0,
        unit: "1",
        why: "motor torque's oscillation at rest over that of the cascade alone, which counts as a ten-thousandth of the \
              rated torque at least, median of judged plants: a quiet and cool drive",
    },
];
