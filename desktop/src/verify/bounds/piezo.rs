//! Bounds of `verify piezo`: constitutive law, deflection, loop.

use super::Bound;

pub(super) const ROWS: &[Bound] = &[
    Bound {
        name: "piezo.couple",
        value: 1e-9,
        unit: "1",
        why: "couple against the moment of the constitutive law's stress; target 1e-9",
    },
    Bound {
        name: "piezo.charge",
        value: 1e-9,
        unit: "1",
        why: "charge against the displacement through the electrodes, from the strain of the bent link; target 1e-9",
    },
    Bound {
        name: "piezo.deflection",
        value: 1e-9,
        unit: "1",
        why: "tip by a steady voltage against the closed form; target 1e-9",
    },
    Bound {
        name: "piezo.loop_width",
        value: 1e-2,
        unit: "1",
        why: "relative error of the major loop's width at 0 V",
    },
];
