//! Bounds of `verify healthy`.

use super::Bound;

pub(super) const ROWS: &[Bound] = &[
    Bound {
        name: "healthy.alarms",
        value: 0.0,
        unit: "joint",
        why: "healthy joints of 500 on which a fault is named in ten hours of work: no false alarm",
    },
    Bound {
        name: "healthy.reduced",
        value: 0.0,
        unit: "joint",
        why: "healthy joints whose feedback the supervisor reduces meanwhile: it acts on a limit cycle alone",
    },
    Bound {
        name: "healthy.unknown.alarms",
        value: 0.0,
        unit: "joint",
        why: "such joints whose plants differ by every unknown at once, on which a fault is named: no false alarm on a sound \
              joint, however little is known of it",
    },
    Bound {
        name: "healthy.unknown.reduced",
        value: 0.0,
        unit: "joint",
        why: "such joints whose feedback the supervisor reduces meanwhile",
    },
];
