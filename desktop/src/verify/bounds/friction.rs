//! Bounds of `verify friction`: closed forms, work, load, ripple, precision and cost.

use super::Bound;

pub(super) const ROWS: &[Bound] = &[
    Bound {
        name: "friction.closed_form",
        value: 1e-14,
        unit: "1",
        why: "steps are exact in the path length, whatever their size: rounding is left; target 1e-12",
    },
    Bound {
        name: "friction.closed_form.shape",
        value: 5e-14,
        unit: "1",
        why: "level, initial slope, place and height of the peak, the worst relative error; target 1e-12",
    },
    Bound {
        name: "friction.order_p.scipy",
        value: 5e-14,
        unit: "1",
        why: "orders 1 to 4 with general A, B, C, as a fraction of the kinetic level: rounding is left; target 1e-9",
    },
    Bound {
        name: "friction.rate_independence",
        value: 1e-14,
        unit: "1",
        why: "relative to the level: the rounding of speed times time",
    },
    Bound {
        name: "friction.lugre.period",
        value: 1e-5,
        unit: "1",
        why: "stick-slip of a mass stepped by 10 us against a tight solution of the equation; target 5e-3",
    },
    Bound {
        name: "friction.lugre.peak",
        value: 1e-5,
        unit: "1",
        why: "the same, the larger error of the peaks of friction and spring",
    },
    Bound {
        name: "friction.work.f64",
        value: 0.0,
        unit: "1",
        why: "largest work, over level times path, by a closed random motion: none of 10^6 generates any",
    },
    Bound {
        name: "friction.work.f32",
        value: 5e-8,
        unit: "1",
        why: "the same in single precision: rounding of a path that does not quite close",
    },
    Bound {
        name: "friction.f32",
        value: 1e-5,
        unit: "1",
        why: "error of f32, relative to the Coulomb level, over 10^7 steps of random motion, load and angle; target 1e-4",
    },
    Bound {
        name: "friction.target.cycles",
        value: 220.0,
        unit: "cycle",
        why: "worst-case path of one side, order 2, with load, direction and ripple: three exponentials, a division and \
              26 numbers to load; target 150",
    },
    Bound {
        name: "friction.load.erob80",
        value: 1e-6,
        unit: "N m",
        why: "the values compared with have 6 decimals; target 1e-5",
    },
    Bound {
        name: "friction.ripple.zxf17",
        value: 1e-6,
        unit: "1",
        why: "mean and orders 1 to 4 of the map, both directions, sampled from the f32 model; target 1e-2",
    },
    Bound {
        name: "friction.ripple.zxf17.published",
        value: 5e-3,
        unit: "1",
        why: "mean and orders 1 and 2 that came with the map have 3 digits; target 1e-2",
    },
];
