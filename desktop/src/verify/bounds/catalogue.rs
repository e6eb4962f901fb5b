//! Bounds of `verify catalogue`.

use super::Bound;

pub(super) const ROWS: &[Bound] = &[
    Bound {
        name: "catalogue.refused",
        value: 0.0,
        unit: "joint",
        why: "joints of the catalogue that no compensator can be built for: their gear files are within every range",
    },
    Bound {
        name: "catalogue.shakes",
        value: 0.0,
        unit: "run",
        why: "runs of S1-S5 on joints of the catalogue that diverge or keep oscillating at rest: stability on every \
              gear",
    },
    Bound {
        name: "catalogue.worse",
        value: 0.0,
        unit: "run",
        why: "runs of which a metric is worse than the best baseline's by more than 5 % and 12 urad: compensation \
              never degrades a run",
    },
    Bound {
        name: "catalogue.stopped",
        value: 0.0,
        unit: "run",
        why: "runs of S1-S5 on joints of the catalogue that end with the drive switched off: nothing in them is broken",
    },
    Bound {
        name: "catalogue.error.median",
        value: 0.35,
        unit: "1",
        why: "output error over that of the best baseline, median of the runs of S1-S5 on joints of the catalogue: the \
              design rules fit any gear",
    },
    Bound {
        name: "catalogue.error.p95",
        value: 0.8,
        unit: "1",
        why: "the same, 95th percentile: nearly every run gains",
    },
    Bound {
        name: "catalogue.unknown.refused",
        value: 0.0,
        unit: "joint",
        why: "joints of the catalogue that no compensator can be built for: what is unknown of a plant is not in its gear file",
    },
    Bound {
        name: "catalogue.unknown.shakes",
        value: 0.0,
        unit: "run",
        why: "runs of S1-S5 on joints of the catalogue whose plants differ by every unknown at once, that diverge or keep \
              oscillating at rest: stability on every joint",
    },
    Bound {
        name: "catalogue.unknown.worse",
        value: 0.0,
        unit: "run",
        why: "such runs of which a metric is worse than the best baseline's by more than 5 % and 12 urad: compensation \
              never degrades a run",
    },
    Bound {
        name: "catalogue.unknown.stopped",
        value: 0.0,
        unit: "run",
        why: "such runs that end with the drive switched off: nothing in them is broken",
    },
];
