use super::*;
use crate::testing::{Sent, frame};
use embedded_can::Id;
use proptest::prelude::*;

const PARAMS: Params = Params { node: 5, peak_torque: 2.5, timeout: 10, enabling: 20 };
/// The first identifier of node 5.
const NODE: u16 = 0xa0;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Command {
    Clear,
    Mode,
    Request,
    Idle,
    Torque(f32),
}

fn heartbeat(active: u32, state: u8) -> Sent {
    frame(NODE + 0x01, &[&active.to_le_bytes()[..], &[state, 0, 0, 0]].concat())
}

fn pair(command: u16, first: f32, second: f32) -> Sent {
    frame(NODE + command, &[first.to_le_bytes(), second.to_le_bytes()].concat())
}

fn sent<const MESSAGES: usize>(drive: &mut Drive<MESSAGES>, torque: f32) -> Command {
    let Sent(id, data) = drive.step(torque).unwrap();
    let Id::Standard(id) = id else { panic!("{id:?}") };
    match (id.as_raw() - NODE, &data[..]) {
        (0x18, [0]) => Command::Clear,
        (0x0b, [1, 0, 0, 0, 1, 0, 0, 0]) => Command::Mode,
        (0x07, [8, 0, 0, 0]) => Command::Request,
        (0x07, [1, 0, 0, 0]) => Command::Idle,
        (0x0e, &[t0, t1, t2, t3]) => Command::Torque(f32::from_le_bytes([t0, t1, t2, t3])),
        other => panic!("{other:02x?}"),
    }
}

fn measures(drive: &mut Drive) {
    drive.receive(&pair(0x09, -1.25, 0.5));
    drive.receive(&pair(0x1c, 0.0, 0.75));
}

/// One period in which the drive has this state, without errors: what is sent.
fn period(drive: &mut Drive, state: u8, torque: f32) -> Command {
    measures(drive);
    drive.receive(&heartbeat(0, state));
    sent(drive, torque)
}

fn reset() -> Drive {
    let mut drive = PARAMS.build().unwrap();
    drive.reset();
    drive
}

fn enabled() -> Drive {
    let mut drive = reset();
    for state in [1, 1, 1, 1, 8] {
        period(&mut drive, state, 1.0);
    }
    assert_eq!((drive.state(), drive.cause()), (Some(State::ClosedLoopControl), None));
    drive
}

/// The next two frames are the safe ones.
fn is_safe(drive: &mut Drive) -> bool {
    [sent(drive, 1.0), sent(drive, 1.0)] == [Command::Idle, Command::Torque(0.0)]
}

#[test]
fn identifiers_are_those_of_the_documentation() {
    // "An Axis ID of 0x01 with a command of 0x0C would result in 0x2C": docs/can-protocol.rst of odriverobotics/ODrive.
    let drive = Params { node: 1, ..PARAMS }.build().unwrap();
    assert_eq!(drive.frame(0x0c, &[]), Some(frame(0x2c, &[])));
    // Closed-loop control is asked for with struct.pack('<I', 8): examples/can_simple.py of odriverobotics/ODriveResources.
    let request = drive.frame(SET_AXIS_STATE, &CLOSED_LOOP_CONTROL.to_le_bytes());
    assert_eq!(request, Some(frame(0x27, &[8, 0, 0, 0])));
}

#[test]
fn it_is_enabled_step_by_step_and_only_then_driven() {
    let mut drive = PARAMS.build().unwrap();
    assert_eq!(period(&mut drive, 1, 1.0), Command::Idle);
    assert_eq!(period(&mut drive, 1, 1.0), Command::Torque(0.0));
    assert_eq!(drive.cause(), Some(Cause::NotStarted));
    drive.reset();
    assert_eq!(sent(&mut drive, 1.0), Command::Idle);
    for command in [Command::Clear, Command::Mode, Command::Torque(0.0), Command::Request] {
        assert_eq!(period(&mut drive, 1, 1.0), command);
    }
    // The request is not repeated: it may be under way.
    assert_eq!(period(&mut drive, 1, 1.0), Command::Torque(0.0));
    assert_eq!(period(&mut drive, 8, 1.0), Command::Torque(1.0));
    assert_eq!(period(&mut drive, 8, -9.0), Command::Torque(-2.5));
    assert_eq!(period(&mut drive, 8, f32::INFINITY), Command::Torque(2.5));
    assert_eq!(period(&mut drive, 8, f32::NAN), Command::Torque(0.0));
}

#[test]
fn a_state_that_was_left_behind_is_left_first() {
    for state in [3, 8, 11, 99] {
        let mut drive = reset();
        assert_eq!(period(&mut drive, state, 1.0), Command::Idle);
        assert_eq!(period(&mut drive, state, 1.0), Command::Torque(0.0));
        assert_eq!(period(&mut drive, 1, 1.0), Command::Clear);
        // Not the closed loop that was asked for.
        for command in [Command::Mode, Command::Torque(0.0), Command::Request] {
            assert_eq!(period(&mut drive, 8, 1.0), command);
        }
        assert_eq!(period(&mut drive, 8, 1.0), Command::Torque(1.0));
        assert_eq!(drive.cause(), None);
    }
}

#[test]
fn errors_are_cleared_once_and_named_when_they_stay() {
    for (active, cause) in [(0, Cause::Refused), (0x0400_0000, Cause::DriveFault)] {
        let mut drive = reset();
        for cycle in 0..=PARAMS.enabling {
            assert_eq!(drive.cause(), None);
            measures(&mut drive);
            drive.receive(&heartbeat(active, 1));
            let command = sent(&mut drive, 1.0);
            assert_eq!(command == Command::Clear, cycle == 0);
            assert_eq!(command == Command::Request, cycle == 3);
        }
        assert_eq!(drive.cause(), Some(cause));
        assert_eq!(period(&mut drive, 8, 1.0), Command::Torque(0.0));
    }
}

#[test]
fn what_the_drive_does_by_itself_makes_safe_until_a_reset() {
    for (active, state, cause) in [
        (0, 1, Cause::Disabled),
        (0, 3, Cause::Disabled),
        (0x0100_0000, 1, Cause::DriveFault),
        (0x0000_0200, 8, Cause::DriveFault),
    ] {
        let mut drive = enabled();
        drive.receive(&heartbeat(active, state));
        assert_eq!(drive.errors(), Errors { active, disarm_reason: 0 });
        assert_eq!(sent(&mut drive, 1.0), Command::Idle);
        assert_eq!(period(&mut drive, 8, 1.0), Command::Torque(0.0));
        assert_eq!(period(&mut drive, 8, 1.0), Command::Idle);
        assert_eq!(drive.cause(), Some(cause), "{active:#x} {state}");
    }
}

#[test]
fn why_it_was_disarmed_is_told() {
    let mut drive = enabled();
    drive.receive(&frame(NODE + 0x03, &[0, 0, 0, 0, 0, 0, 0, 0x04]));
    assert_eq!(drive.errors(), Errors { active: 0, disarm_reason: 0x0400_0000 });
    assert_eq!(period(&mut drive, 1, 1.0), Command::Idle);
    assert_eq!(drive.cause(), Some(Cause::Disabled));
}

#[test]
fn silence_is_noticed_after_the_timeout_and_not_before() {
    let estimates = pair(0x09, -1.25, 0.5);
    let torques = pair(0x1c, 0.0, 0.75);
    let silent = |heard: &[&Sent], cause| {
        let mut drive = enabled();
        let hear = |drive: &mut Drive| {
            for frame in heard {
                drive.receive(*frame);
            }
        };
        for _ in 1..PARAMS.timeout {
            hear(&mut drive);
            assert_eq!(sent(&mut drive, 1.0), Command::Torque(1.0));
        }
        hear(&mut drive);
        assert_eq!(sent(&mut drive, 1.0), Command::Idle);
        assert_eq!(drive.cause(), Some(cause));
    };
    let alive = heartbeat(0, 8);
    silent(&[&estimates, &torques], Cause::HeartbeatLost);
    silent(&[&alive], Cause::StatusLost);
    silent(&[&alive, &estimates], Cause::StatusLost);
    silent(&[&alive, &torques], Cause::StatusLost);
    silent(&[&alive, &torques, &pair(0x09, f32::NAN, 0.0)], Cause::StatusLost);
    silent(&[&alive, &torques, &frame(0xc9, &[0; 8])], Cause::StatusLost);
}

#[test]
fn a_drive_of_heartbeats_alone_needs_no_estimates() {
    let mut drive = PARAMS.build_of_heartbeats().unwrap();
    drive.reset();
    for state in [1, 1, 1, 1, 8] {
        drive.receive(&heartbeat(0, state));
        sent(&mut drive, 1.0);
    }
    for _ in 0..3 * PARAMS.timeout {
        drive.receive(&heartbeat(0, 8));
        assert_eq!(
            [pair(0x09, 0.5, 0.5), pair(0x1c, 0.0, 0.5)].map(|frame| drive.receive(&frame)),
            [None; 2]
        );
        assert_eq!(sent(&mut drive, 1.0), Command::Torque(1.0));
    }
    (1..PARAMS.timeout).for_each(|_| _ = sent(&mut drive, 1.0));
    assert_eq!((drive.cause(), drive.lost()), (None, None));
    assert_eq!(sent(&mut drive, 1.0), Command::Idle);
    assert_eq!((drive.cause(), drive.lost()), (Some(Cause::HeartbeatLost), Some(Cause::HeartbeatLost)));
}

#[test]
fn it_is_disabled_without_a_fault_and_enabled_again() {
    let mut drive = enabled();
    assert!(drive.is_enabled());
    drive.disable();
    assert!(!drive.is_enabled() && is_safe(&mut drive) && is_safe(&mut drive));
    assert_eq!(drive.cause(), Some(Cause::NotStarted));
    drive.reset();
    // What was told before may be from before the last frames.
    assert_eq!(sent(&mut drive, 1.0), Command::Idle);
    for command in [Command::Clear, Command::Mode, Command::Torque(0.0), Command::Request] {
        assert_eq!(period(&mut drive, 1, 1.0), command);
    }
    assert_eq!(period(&mut drive, 8, 1.0), Command::Torque(1.0));
}

#[test]
fn errors_are_cleared_in_the_safe_state_when_that_is_asked_for() {
    let mut drive = PARAMS.build().unwrap();
    drive.receive(&heartbeat(0x40, 1));
    assert_eq!(drive.errors().active, 0x40);
    drive.clear();
    assert_eq!((drive.errors(), drive.state()), (Errors::default(), None));
    assert_eq!([sent(&mut drive, 1.0), sent(&mut drive, 1.0)], [Command::Idle, Command::Clear]);
    assert!(is_safe(&mut drive));
}

#[test]
fn what_it_measures_is_told_in_whole_pairs() {
    let mut drive = PARAMS.build().unwrap();
    let feedback = Feedback { position: -1.25, velocity: 0.5, torque: 0.75 };
    assert_eq!(drive.receive(&pair(0x09, -1.25, 0.5)), None);
    assert_eq!(drive.receive(&pair(0x1c, 9.0, 0.75)), Some(feedback));
    assert_eq!(drive.receive(&pair(0x1c, 9.0, 0.75)), None);
    assert_eq!(drive.receive(&frame(NODE + 0x09, &[0; 4])), None);
    assert_eq!(drive.receive(&frame(0x001, &[0; 8])), None);
    assert_eq!(drive.receive(&pair(0x09, -1.25, 0.5)), Some(feedback));
}

#[test]
fn parameters_out_of_range_build_no_drive() {
    let bad = [
        Params { node: 63, ..PARAMS },
        Params { peak_torque: f32::NAN, ..PARAMS },
        Params { timeout: 0, ..PARAMS },
        Params { enabling: 4, ..PARAMS },
    ];
    assert!(bad.iter().all(|params| params.build().is_none()));
    assert!(Params { node: 0, ..PARAMS }.build().is_some());
}

/// Any frame, or a heartbeat that is in order.
fn any_frame() -> impl Strategy<Value = Sent> {
    let data = prop::collection::vec(any::<u8>(), 0..9);
    prop_oneof![
        (0_u16..0x800, data.clone()).prop_map(|(id, data)| frame(id, &data)),
        (NODE..NODE + 32, data).prop_map(|(id, data)| frame(id, &data)),
        (0_u8..16).prop_map(|state| heartbeat(0, state)),
        Just(heartbeat(0, 1)),
        Just(heartbeat(0, 8)),
    ]
}

proptest! {
    #[test]
    fn any_frames_leave_the_torque_bounded_and_safe_latched(
        frames in prop::collection::vec(any_frame(), 0..60),
        torque in prop::num::f32::ANY,
    ) {
        let mut drive = reset();
        let mut latched = None;
        for frame in frames {
            drive.receive(&frame);
            let command = sent(&mut drive, torque);
            if let Command::Torque(sent) = command {
                prop_assert!(sent.abs() <= 2.5);
                prop_assert!(sent == 0.0 || drive.state() == Some(State::ClosedLoopControl));
            }
            latched = latched.or(drive.cause());
            prop_assert_eq!(drive.cause(), latched);
            prop_assert!(latched.is_none() || matches!(command, Command::Idle | Command::Torque(0.0)));
        }
    }
}
