//! What `strainwave faults` and `verify faults` measure.

use super::Bound;

pub(super) const ROWS: &[Bound] = &[
    Bound {
        name: "faults.overspeed",
        value: 0.0,
        unit: "run",
        why: "injected faults after which the output is beyond its speed limit; as asked",
    },
    Bound {
        name: "faults.motion",
        value: 0.0,
        unit: "run",
        why: "injected faults after which the output moves by more than 20 mrad that nobody commanded; as asked",
    },
    Bound {
        name: "faults.full_torque",
        value: 0.0,
        unit: "run",
        why: "injected faults after which the motor gives its full torque for more than 5 ms; as asked",
    },
    Bound {
        name: "faults.gear",
        value: 0.0,
        unit: "run",
        why: "injected faults after which the gear carries more than its peak rating; as asked",
    },
    Bound {
        name: "faults.named.frozen",
        value: 0.005,
        unit: "s",
        why: "until a frozen or stuck motor encoder is named, from torque beyond friction on; as asked",
    },
    Bound {
        name: "faults.named.jump",
        value: 0.005,
        unit: "s",
        why: "until a jump of the motor encoder is named; as asked",
    },
    Bound {
        name: "faults.named.loss",
        value: 0.005,
        unit: "s",
        why: "until the loss of the motor encoder is named; as asked",
    },
    Bound {
        name: "faults.false_alarms",
        value: 0.0,
        unit: "run",
        why: "healthy runs with a fault named; as asked",
    },
];
