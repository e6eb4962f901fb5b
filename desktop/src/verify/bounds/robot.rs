//! Bounds of `verify robot`.

use super::Bound;

pub(super) const ROWS: &[Bound] = &[
    Bound {
        name: "robot.rigid.energy",
        value: 2e-11,
        unit: "1",
        why: "change of the energy of the rigid two-joint arm that swings 10 s without loss, over its largest kinetic energy: below what a sensor shows, 1e-6",
    },
    Bound {
        name: "robot.rigid.swing",
        value: 1e-12,
        unit: "rad",
        why: "angles of the rigid two-joint arm against MuJoCo's, 2 s of its swing: below what a sensor shows, 1e-6",
    },
    Bound {
        name: "robot.rigid.torques",
        value: 5e-15,
        unit: "1",
        why: "torques of a spatial arm's inverse dynamics against MuJoCo's, over the largest torque: below what a sensor shows, 1e-6",
    },
    Bound {
        name: "robot.s7.motor.to_b1",
        value: 0.25,
        unit: "1",
        why: "tip error of S7 with the motor encoders alone over that of B1 at both joints, the worst of 20 robots: gears wound up in advance for an arm that nobody told",
    },
    Bound {
        name: "robot.s7.both.to_b1",
        value: 0.05,
        unit: "1",
        why: "tip error of S7 with output encoders too over that of B1 at both joints, the worst of 20 robots: 0.25 asked, the output is measured",
    },
];
