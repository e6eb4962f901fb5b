//! Robots of several joints: the rigid arm against its laws and MuJoCo, and scenario S7 on a robot that claims are judged on.

use strainwave_desktop::verify::bounds;
use strainwave_desktop::verify::robot::{self, FIRST};

#[test]
fn the_rigid_arm_keeps_its_energy_and_moves_as_mujocos() {
    let measured = robot::rigid().unwrap();
    assert_eq!(measured.figures.len(), 3);
    for figure in measured.figures {
        assert!(figure.holds && figure.value < 1e-6, "{figure:?}");
    }
}

#[test]
fn compensated_arms_draw_within_their_bounds() {
    let [b1, motor, both] = robot::s7(FIRST).unwrap();
    for (name, error) in [("robot.s7.motor.to_b1", motor), ("robot.s7.both.to_b1", both)] {
        let figure = bounds::figure(name, error / b1);
        assert!(figure.holds, "{figure:?}");
    }
}
