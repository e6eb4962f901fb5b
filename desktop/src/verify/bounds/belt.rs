//! Bounds of `verify belt`: closed forms, energy, reduction, precision.

use super::Bound;

pub(super) const ROWS: &[Bound] = &[
    Bound { name: "belt.stiffness", value: 1e-9, unit: "1", why: "TODO; target 1e-9" },
    Bound { name: "belt.stiffness.slack", value: 1e-9, unit: "1", why: "TODO; target 1e-9" },
    Bound { name: "belt.span_forces", value: 1e-9, unit: "1", why: "TODO; target 1e-9" },
    Bound { name: "belt.chain.fixed", value: 1e-9, unit: "1", why: "TODO; target 1e-9" },
    Bound { name: "belt.chain.pulley", value: 1e-9, unit: "1", why: "TODO; target 1e-9" },
    Bound { name: "belt.energy", value: 1e-6, unit: "1", why: "TODO; target 1e-6" },
    Bound { name: "belt.energy.every_mode", value: 1e-6, unit: "1", why: "TODO; target 1e-6" },
    Bound { name: "belt.reduction.torsion", value: 1e-2, unit: "1", why: "TODO" },
    Bound { name: "belt.reduction.forces", value: 1e-2, unit: "1", why: "TODO" },
    Bound { name: "belt.reduction.forces.slack", value: 0.2, unit: "1", why: "TODO" },
    Bound { name: "belt.f32", value: 1e-4, unit: "1", why: "TODO" },
];
