use super::*;
use embedded_can::StandardId;
use proptest::prelude::*;
use std::vec;
use std::vec::Vec;

const PARAMS: Params = Params { drive: 1, source: 0, peak_torque: 2.5, watchdog: 0.02, timeout: 10 };

/// The reply that `docs/protocol/can.md` explains byte by byte, and its mode.
const REPLY: [u8; 16] =
    [0x24, 0x04, 0x00, 0x0a, 0x00, 0x50, 0x00, 0x00, 0x01, 0x70, 0xff, 0x23, 0x0d, 0x18, 0x14, 0x00];

fn from(id: u16) -> Id {
    StandardId::new(id).unwrap().into()
}

/// What the drive answers to the query in this mode, with this fault.
fn reply(mode: u8, fault: u8) -> Vec<u8> {
    let [position, velocity, torque] = [-1.25_f32, 0.5, 0.75].map(f32::to_le_bytes);
    [&[0x21, 0x00, mode, 0x2f, 0x01], &position[..], &velocity, &torque, &[0x21, 0x0f, fault]].concat()
}

/// A subframe that writes or reads: first register, and for each the bytes that are written.
#[derive(Debug, PartialEq)]
enum Asked {
    Write(u8, Vec<Vec<u8>>),
    Read(u8, u8),
}

/// Takes a command apart, with numbers and registers below 128.
fn asked(data: &[u8]) -> Vec<Asked> {
    let mut bytes = data.iter().copied();
    let mut all = vec![];
    while let Some(kind) = bytes.next() {
        if kind == NOP {
            continue;
        }
        let number = if kind & 3 == 0 { bytes.next().unwrap() } else { kind & 3 };
        let first = bytes.next().unwrap();
        let size = [1, 2, 4, 4][usize::from(kind >> 2 & 3)];
        all.push(match kind {
            0x00..=0x0f => {
                let mut value = |_| bytes.by_ref().take(size).collect();
                Asked::Write(first, (0..number).map(&mut value).collect())
            }
            0x10..=0x1f => Asked::Read(first, number),
            _ => panic!("{kind:#04x} in {data:02x?}"),
        });
    }
    all
}

fn query() -> Vec<Asked> {
    vec![Asked::Read(0x00, 1), Asked::Read(0x01, 3), Asked::Read(0x0f, 1)]
}

fn bytes(value: f32) -> Vec<u8> {
    value.to_le_bytes().to_vec()
}

/// The torque of a command, `None` of the safe frame; there is no third.
fn torque_of(frame: Frame) -> Option<f32> {
    assert_eq!(frame.id, ExtendedId::new(0x8001).unwrap());
    let asked = asked(&frame.data);
    if asked[0] == Asked::Write(0x00, vec![vec![0]]) {
        assert_eq!(asked[1..], query());
        return None;
    }
    let Asked::Write(0x22, torque) = &asked[2] else { panic!("{asked:02x?}") };
    let torque = f32::from_le_bytes(torque[0][..].try_into().unwrap());
    let mut expected = vec![
        Asked::Write(0x00, vec![vec![10]]),
        Asked::Write(0x20, vec![vec![0x80]]),
        Asked::Write(0x22, vec![bytes(torque)]),
        Asked::Write(0x23, vec![vec![0], vec![0]]),
        Asked::Write(0x25, vec![bytes(2.5)]),
        Asked::Write(0x27, vec![bytes(0.02)]),
        Asked::Write(0x2b, vec![vec![0]]),
    ];
    expected.extend(query());
    assert_eq!(asked, expected);
    Some(torque)
}

/// One period in which the drive has this mode: the torque that is sent.
fn period(drive: &mut Drive, mode: u8, torque: f32) -> Option<f32> {
    drive.receive(from(0x100), &reply(mode, 0));
    torque_of(drive.step(torque))
}

fn enabled() -> Drive {
    let mut drive = PARAMS.build().unwrap();
    drive.reset();
    for mode in [0, 2, 3, 4, 10] {
        period(&mut drive, mode, 1.0);
    }
    assert_eq!((drive.mode(), drive.cause()), (Mode::Position, None));
    drive
}

#[test]
fn the_documented_commands_are_read_as_they_are_explained() {
    // docs/protocol/can.md: 01000a07206000200150ff140400130d, to id 8001.
    let command =
        [0x01, 0x00, 0x0a, 0x07, 0x20, 0x60, 0x00, 0x20, 0x01, 0x50, 0xff, 0x14, 0x04, 0x00, 0x13, 0x0d];
    let values = vec![vec![0x60, 0x00], vec![0x20, 0x01], vec![0x50, 0xff]];
    let expected = [
        Asked::Write(0x00, vec![vec![10]]),
        Asked::Write(0x20, values),
        Asked::Read(0x00, 4),
        Asked::Read(0x0d, 3),
    ];
    assert_eq!(asked(&command), expected);
    // docs/integration/can-fd.md: position 1, velocity 2.
    let command = [
        0x01, 0x00, 0x0a, 0x0e, 0x20, 0x00, 0x00, 0x80, 0x3f, 0x00, 0x00, 0x00, 0x40, 0x11, 0x00, 0x1f, 0x01,
        0x13, 0x0d,
    ];
    let expected = [
        Asked::Write(0x00, vec![vec![10]]),
        Asked::Write(0x20, vec![bytes(1.0), bytes(2.0)]),
        Asked::Read(0x00, 1),
        Asked::Read(0x01, 3),
        Asked::Read(0x0d, 3),
    ];
    assert_eq!(asked(&command), expected);
}

#[test]
fn the_documented_replies_are_read_as_they_are_explained() {
    let reply = Reply::parse(&REPLY);
    assert_eq!((reply.mode, reply.fault, reply.refused), (Some(10), Some(0), false));
    let close = |value: Option<f32>, expected: f32| (value.unwrap() - expected).abs() < 1e-6;
    // 2.88 degrees, 23.04 degrees/s, -1.44 N m.
    assert!(close(reply.position, 2.88 / 360.0));
    assert!(close(reply.velocity, 23.04 / 360.0));
    assert!(close(reply.torque, -1.44));
    // docs/integration/can-fd.md: stopped, no fault.
    let stopped = Reply { mode: Some(0), fault: Some(0), ..Reply::default() };
    assert_eq!(Reply::parse(&[0x21, 0x00, 0x00, 0x21, 0x0f, 0x00]), stopped);
}

#[test]
fn every_type_of_value_is_scaled() {
    let close = |data: &[u8], position: f32| {
        let read = Reply::parse(data).position.unwrap();
        assert!((read - position).abs() <= position.abs() * 1e-6, "{data:02x?}: {read}");
    };
    close(&[0x21, 0x01, 0x81], -1.27);
    close(&[0x25, 0x01, 0xff, 0x7f], 3.2767);
    close(&[0x29, 0x01, 0x40, 0x42, 0x0f, 0x00], 10.0);
    close(&[0x2d, 0x01, 0x00, 0x00, 0xa0, 0xbf], -1.25);
    for lowest in [&[0x21, 0x01, 0x80][..], &[0x25, 0x01, 0, 0x80], &[0x29, 0x01, 0, 0, 0, 0x80]] {
        assert_eq!(Reply::parse(lowest), Reply::default());
    }
}

#[test]
fn a_reply_is_read_up_to_where_it_ends() {
    let good = reply(10, 0);
    let whole = Reply::parse(&good);
    assert_eq!(Reply::parse(&[&[NOP, NOP], &good[..], &[NOP]].concat()), whole);
    assert_eq!(Reply::parse(&[&good[..], &[0x41, 0x00]].concat()), whole);
    for length in 0..good.len() {
        assert_ne!(Reply::parse(&good[..length]), whole);
    }
    // As many registers as a number of 5 bytes can tell; a number of 6 bytes.
    assert_eq!(Reply::parse(&[0x20, 0xff, 0xff, 0xff, 0xff, 0x0f, 0x00, 0x0a]).mode, Some(10));
    assert_eq!(Reply::parse(&[0x20, 0x81, 0x80, 0x80, 0x80, 0x80, 0x00, 0x00, 0x0a]), Reply::default());
    // Register 1 in two bytes; the one behind the last, which is not 0.
    assert_eq!(Reply::parse(&[0x21, 0x81, 0x00, 0x32]).position, Some(0.5));
    assert_eq!(Reply::parse(&[0x22, 0xff, 0xff, 0xff, 0xff, 0x0f, 0x00, 0x0a]), Reply::default());
}

#[test]
fn it_is_enabled_step_by_step_and_only_then_driven() {
    let mut drive = PARAMS.build().unwrap();
    assert_eq!(period(&mut drive, 0, 1.0), None);
    assert_eq!(drive.cause(), Some(Cause::NotStarted));
    drive.reset();
    for mode in [0, 2, 3, 4] {
        assert_eq!(period(&mut drive, mode, 1.0), Some(0.0));
    }
    assert_eq!(period(&mut drive, 10, 1.0), Some(1.0));
    assert_eq!(period(&mut drive, 10, -9.0), Some(-2.5));
    assert_eq!(period(&mut drive, 10, f32::INFINITY), Some(2.5));
    assert_eq!(period(&mut drive, 10, f32::NAN), Some(0.0));
}

#[test]
fn a_mode_that_was_left_behind_is_stopped_first() {
    for mode in [1, 5, 9, 11, 12, 15, 99] {
        let mut drive = PARAMS.build().unwrap();
        drive.reset();
        assert_eq!(torque_of(drive.step(1.0)), None);
        assert_eq!(period(&mut drive, mode, 1.0), None);
        assert_eq!(period(&mut drive, 0, 1.0), Some(0.0));
        assert_eq!(drive.cause(), None);
    }
}

#[test]
fn what_the_drive_does_by_itself_makes_safe_until_a_reset() {
    for (mode, cause) in [
        (1, Cause::DriveFault),
        (11, Cause::WatchdogExpired),
        (0, Cause::Disabled),
        (3, Cause::Disabled),
        (9, Cause::Disabled),
    ] {
        let mut drive = enabled();
        assert_eq!(period(&mut drive, mode, 1.0), None);
        assert_eq!(period(&mut drive, 10, 1.0), None);
        assert_eq!(drive.cause(), Some(cause), "{mode}");
        drive.reset();
        assert_eq!(torque_of(drive.step(1.0)), Some(0.0));
        assert_eq!(period(&mut drive, 10, 1.0), Some(1.0));
    }
}

#[test]
fn a_fault_that_stays_is_named_with_its_code() {
    let mut drive = PARAMS.build().unwrap();
    drive.reset();
    for _ in 0..=PARAMS.timeout {
        assert_eq!(drive.cause(), None);
        drive.receive(from(0x100), &reply(1, 40));
        assert_eq!(torque_of(drive.step(1.0)), None);
    }
    assert_eq!((drive.cause(), drive.fault_code()), (Some(Cause::DriveFault), 40));
    period(&mut drive, 0, 1.0);
    assert_eq!(drive.fault_code(), 40);
    drive.reset();
    assert_eq!(drive.fault_code(), 0);
}

#[test]
fn what_limits_the_torque_is_no_fault() {
    let mut drive = enabled();
    drive.receive(from(0x100), &reply(10, 102));
    assert_eq!(torque_of(drive.step(1.0)), Some(1.0));
    assert_eq!((drive.cause(), drive.fault_code()), (None, 102));
}

#[test]
fn a_refused_register_makes_safe() {
    let mut drive = enabled();
    drive.receive(from(0x100), &[&[0x30, 0x2b, 0x01][..], &reply(10, 0)].concat());
    assert_eq!(torque_of(drive.step(1.0)), None);
    assert_eq!((drive.mode(), drive.cause()), (Mode::Position, Some(Cause::Refused)));
}

#[test]
fn silence_is_noticed_after_the_timeout_and_not_before() {
    for (id, data) in [(0x101, reply(10, 0)), (0x200, reply(10, 0)), (0x100, vec![0x21, 0x0f, 0x00])] {
        let mut drive = enabled();
        for _ in 1..PARAMS.timeout {
            drive.receive(from(id), &data);
            assert_eq!(torque_of(drive.step(1.0)), Some(1.0));
        }
        drive.receive(from(id), &data);
        assert_eq!(torque_of(drive.step(1.0)), None);
        assert_eq!(drive.cause(), Some(Cause::StatusLost));
    }
}

#[test]
fn what_it_measures_is_told_when_all_of_it_has_come() {
    let mut drive = PARAMS.build().unwrap();
    let feedback = Feedback { position: -1.25, velocity: 0.5, torque: 0.75 };
    assert_eq!(drive.receive(from(0x100), &reply(10, 0)), Some(feedback));
    let extended = ExtendedId::new(0x100).unwrap().into();
    assert_eq!(drive.receive(extended, &reply(10, 0)), Some(feedback));
    assert_eq!(drive.receive(from(0x100), &[0x21, 0x00, 0x0a]), None);
    assert_eq!(drive.receive(from(0x101), &reply(10, 0)), None);
    let no_number = [&[0x21, 0x00, 0x0a, 0x2f, 0x01][..], &[0xff; 12]].concat();
    assert_eq!(drive.receive(from(0x100), &no_number), None);
}

#[test]
fn addresses_are_in_the_identifiers() {
    let mut drive = Params { drive: 0x12, source: 0x34, ..PARAMS }.build().unwrap();
    assert_eq!(drive.step(0.0).id, ExtendedId::new(0xb412).unwrap());
    let reply_id = ExtendedId::new(0x1234).unwrap().into();
    assert!(drive.receive(reply_id, &reply(0, 0)).is_some());
}

#[test]
fn parameters_out_of_range_build_no_drive() {
    let bad = [
        Params { drive: 0, ..PARAMS },
        Params { drive: 127, ..PARAMS },
        Params { source: 127, ..PARAMS },
        Params { source: 1, ..PARAMS },
        Params { peak_torque: 0.0, ..PARAMS },
        Params { watchdog: 0.0, ..PARAMS },
        Params { watchdog: f32::NAN, ..PARAMS },
        Params { watchdog: f32::INFINITY, ..PARAMS },
        Params { timeout: 0, ..PARAMS },
    ];
    assert!(bad.iter().all(|params| params.build().is_none()));
}

/// Any bytes, or replies that are in order.
fn any_reply() -> impl Strategy<Value = Vec<u8>> {
    prop_oneof![
        prop::collection::vec(any::<u8>(), 0..65),
        (0_u8..16, any::<u8>()).prop_map(|(mode, fault)| reply(mode, fault)),
        Just(reply(10, 0)),
    ]
}

proptest! {
    #[test]
    fn any_replies_leave_the_torque_bounded_and_safe_latched(
        replies in prop::collection::vec((prop::bool::weighted(0.8), any_reply()), 0..60),
        torque in prop::num::f32::ANY,
    ) {
        let mut drive = PARAMS.build().unwrap();
        drive.reset();
        let mut latched = None;
        for (ours, data) in replies {
            drive.receive(from(if ours { 0x100 } else { 0x200 }), &data);
            let sent = torque_of(drive.step(torque));
            prop_assert!(sent.is_none_or(|sent| sent.abs() <= 2.5));
            prop_assert!(sent.is_none_or(|sent| sent == 0.0 || drive.mode() == Mode::Position));
            latched = latched.or(drive.cause());
            prop_assert_eq!(drive.cause(), latched);
            prop_assert!(latched.is_none() || sent.is_none());
        }
    }

    #[test]
    fn any_bytes_are_read(data in prop::collection::vec(any::<u8>(), 0..65)) {
        Reply::parse(&data);
    }

    #[test]
    fn any_subframes_are_read(kind in 0x20_u8..0x30, data in prop::collection::vec(any::<u8>(), 0..64)) {
        Reply::parse(&[&[kind][..], &data].concat());
    }
}
