//! Bounds of `verify piezo`: constitutive law, deflection, loop.

use super::Bound;

pub(super) const ROWS: &[Bound] = &[
    Bound {
        name: "piezo.couple",
        value: 2e-15,
        unit: "1",
        why: "couple against the moment of the constitutive law's stress; target 1e-9",
    },
    Bound {
        name: "piezo.charge",
        value: 5e-15,
        unit: "1",
        why: "charge against the displacement through the electrodes, from the strain of the bent link; target 1e-9",
    },
    Bound {
        name: "piezo.deflection",
        value: 5e-12,
        unit: "1",
        why: "tip by a steady voltage against the closed form; target 1e-9",
    },
    Bound {
        name: "piezo.loop_width",
        value: 5e-3,
        unit: "1",
        why: "largest error of the major loop's width, anywhere along it, of the stated one: 24 levels round the branches off; target 1e-2",
    },
];
