//! Bounds of `strainwave faults` and `verify faults`.

use super::Bound;

pub(super) const ROWS: &[Bound] = &[
    Bound {
        name: "faults.overspeed",
        value: 0.0,
        unit: "run",
        why: "injected faults after which the output is beyond its speed limit: no fault becomes a hazardous speed",
    },
    Bound {
        name: "faults.motion",
        value: 0.0,
        unit: "run",
        why: "injected faults after which the output moves by more than 20 mrad without a command: no fault becomes a hazardous motion",
    },
    Bound {
        name: "faults.full_torque",
        value: 0.0,
        unit: "run",
        why: "injected faults after which the motor gives its full torque for more than 5 ms: no fault drives the joint with full force",
    },
    Bound {
        name: "faults.gear",
        value: 0.0,
        unit: "run",
        why: "injected faults after which the torque through the gear exceeds its peak rating: no fault damages the gear",
    },
    Bound {
        name: "faults.named.frozen",
        value: 0.005,
        unit: "s",
        why: "time to the detection of a frozen or stuck motor encoder, from torque beyond friction or the end of its noise on: \
              before the joint has moved far",
    },
    Bound {
        name: "faults.named.jump",
        value: 0.005,
        unit: "s",
        why: "time to the detection of a jump of the motor encoder: before the joint has moved far",
    },
    Bound {
        name: "faults.named.loss",
        value: 0.005,
        unit: "s",
        why: "time to the detection of a lost motor encoder: before the joint has moved far",
    },
    Bound {
        name: "faults.false_alarms",
        value: 0.0,
        unit: "run",
        why: "runs without a fault in which one is reported: a healthy joint is never stopped",
    },
];
