//! Bounds of `verify gauges`: torque by strain gauges on the flexspline.

use super::Bound;

/// Smallest allowed values.
pub(super) const FLOORS: [Bound; 1] = [Bound {
    name: "gauges.s8.raw.median",
    value: 0.2,
    unit: "1",
    why: "error of the same four gauges as a full bridge, balanced at rest, with the mesh's strain per torque, as a fraction of the rated \
          torque, the median seed's: what is left of the ellipse by gains and places that differ",
}];

pub(super) const ROWS: &[Bound] = &[
    Bound {
        name: "gauges.s8.error",
        value: 0.015,
        unit: "1",
        why: "error of four gauges in S8, rms as a fraction of the rated torque, the worst of 100 seeds: the zero that they learn from the \
              motor's torque",
    },
    Bound {
        name: "gauges.observer.external_torque",
        value: 1.0,
        unit: "1",
        why: "error of the observer's external torque in S8 with four gauges over that with the motor's encoder and torque alone, the \
              worst of 20 seeds: better with them on each",
    },
    Bound {
        name: "gauges.target.cycles",
        value: 400.0,
        unit: "cycle",
        why: "a step of four gauges in S8 on a Cortex-M4F, modelled at the pessimistic end",
    },
];
