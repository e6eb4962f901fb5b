//! Bounds of `verify constants`.

use super::Bound;

pub(super) const ROWS: &[Bound] = &[
    Bound {
        name: "constants.count",
        value: 35.0,
        unit: "1",
        why: "tuned constants of the control step, 23, and of the design rules, 12: each is one more that may not fit a joint",
    },
    Bound {
        name: "constants.stops",
        value: 0.0,
        unit: "run",
        why: "runs of S1-S5 on training joints that diverge, or end with the drive off, where a tuned constant is halved or doubled, \
              and do not where none is: no joint depends on the value of one constant",
    },
];
