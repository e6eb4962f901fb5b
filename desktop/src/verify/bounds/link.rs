//! Bounds of `verify link`: closed forms, finite elements, laws, precision.

use super::Bound;

pub(super) const ROWS: &[Bound] = &[
    Bound {
        name: "link.eigenvalues.cantilever",
        value: 2e-15,
        unit: "1",
        why: "first four, from the frequencies, against the textbook's digits: bisection goes to rounding; target 1e-6",
    },
    Bound {
        name: "link.eigenvalues.finite_elements",
        value: 5e-9,
        unit: "1",
        why: "first four of nine payloads against stored Hermite elements, extrapolated: what that leaves; target 1e-6",
    },
    Bound {
        name: "link.deflection.force",
        value: 5e-12,
        unit: "1",
        why: "tip at rest against F*L^3/(3*EI): the modes that are left out follow their loads; target 1e-6",
    },
    Bound {
        name: "link.deflection.weight",
        value: 5e-12,
        unit: "1",
        why: "the same against the closed form under the weight of beam and payload; target 1e-6",
    },
    Bound {
        name: "link.torque.finite_elements",
        value: 2e-5,
        unit: "1",
        why: "torque of the joint in a fast move and a pull, of the largest, against stored finite elements of 80 modes: what the two modes lack; target 1e-3",
    },
    Bound {
        name: "link.tip.finite_elements",
        value: 2e-8,
        unit: "1",
        why: "the same of the tip's deflection; target 1e-3",
    },
    Bound {
        name: "link.f32",
        value: 5e-6,
        unit: "1",
        why: "torque in single precision over 5 s, of the largest",
    },
    Bound {
        name: "link.energy.free",
        value: 2e-10,
        unit: "1",
        why: "energy of an undamped link over 10^6 steps: each is exact, rounding is left; target 1e-9",
    },
    Bound {
        name: "link.energy.ports",
        value: 2e-8,
        unit: "1",
        why: "work at joint and tip less the change of the energy, of all that went through: trapezoids of 0.1 ms",
    },
    Bound {
        name: "link.coupling",
        value: 5e-15,
        unit: "1",
        why: "torque of a swinging link against the moment at its clamp: one coefficient drives mode and reaction",
    },
];
