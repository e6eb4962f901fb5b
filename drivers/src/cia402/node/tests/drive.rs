//! The master's side of this crate follows the node's statuswords.

use super::*;
use crate::cia402::{self, Drive};

/// One cycle of the bus: the master's controlword and torque go to the node, its statusword comes back in the mapping of the master.
fn exchange(drive: &mut Drive, node: &mut Node, torque: f32) {
    let Sent(_, data) = drive.step(torque).unwrap();
    let [c0, c1, t0, t1] = data[..] else { panic!("{data:?}") };
    let controlword = u16::from_le_bytes([c0, c1]);
    let torque = i16::from_le_bytes([t0, t1]);
    let status = cycle(node, &[rpdo1(controlword, TORQUE, 0), rpdo2(0, torque)], &MOVES);
    drive.receive(&frame(0x705, &[5]));
    drive.receive(&frame(0x185, &[&status.to_le_bytes()[..], &[0; 6]].concat()));
}

#[test]
fn the_master_enables_drives_and_resets_the_node() {
    let params = cia402::Params { node: 5, rated_torque: 50.0, peak_torque: 100.0, timeout: 10 };
    let mut drive = params.build().unwrap();
    let mut node = started();
    drive.reset();
    for _ in 0..6 {
        exchange(&mut drive, &mut node, 25.0);
        assert_eq!(drive.state(), node.state());
    }
    assert_eq!((drive.state(), drive.cause()), (State::OperationEnabled, None));
    assert_eq!(node.target(), Some(Target::Torque(25.0)));

    node.read(&Actual { fault: 0x4210, ..MOVES }, true);
    exchange(&mut drive, &mut node, 25.0);
    assert_eq!(drive.cause(), Some(cia402::Cause::DriveFault));
    exchange(&mut drive, &mut node, 25.0);
    drive.reset();
    exchange(&mut drive, &mut node, 25.0);
    assert!(node.reset_requested());
    for _ in 0..6 {
        exchange(&mut drive, &mut node, -25.0);
    }
    assert_eq!((drive.state(), drive.cause()), (State::OperationEnabled, None));
    assert_eq!(node.target(), Some(Target::Torque(-25.0)));
}
