//! PDOs, network management, heartbeats, loss of the bus.

use super::*;
use embedded_can::ExtendedId;

#[test]
fn pdos_carry_the_joint_for_every_sync_in_operational() {
    let mut node = started();
    node.receive(&sync());
    assert_eq!(sent(&mut node), []);
    node.read(&MOVES, true);
    let tpdo1 = [0x50, 0x02, 0, 0x40, 0x42, 0x0f, 0x00].to_vec();
    let tpdo2 = [0x30, 0xf8, 0xff, 0xff, 0xfa, 0x00].to_vec();
    assert_eq!(sent(&mut node), [(0x185, tpdo1), (0x285, tpdo2)]);
    node.read(&MOVES, true);
    assert_eq!(sent(&mut node), []);
}

#[test]
fn torques_are_bounded_and_numbers() {
    let mut node = started();
    for (torque, expected) in
        [(f32::NAN, 0), (f32::INFINITY, i16::MAX), (f32::NEG_INFINITY, i16::MIN), (-50.0, -1000)]
    {
        node.receive(&sync());
        node.read(&Actual { torque, ..MOVES }, true);
        let data = sent_as(&mut node, 0x285).unwrap();
        assert_eq!(i16::from_le_bytes([data[4], data[5]]), expected, "{torque}");
    }
    let mut node = enabled();
    for (torque, expected) in [(1000, 50.0), (i16::MAX, 32.767 * 50.0), (i16::MIN, -32.767 * 50.0), (0, 0.0)]
    {
        cycle(&mut node, &[rpdo1(0x0f, TORQUE, 0), rpdo2(0, torque)], &MOVES);
        let Some(Target::Torque(target)) = node.target() else { panic!("{torque}") };
        assert!((target - expected).abs() < 1e-3, "{target} {expected}");
    }
}

#[test]
fn each_mode_has_its_target_and_another_one_is_refused() {
    let mut node = enabled();
    let mut target = |mode, frames: &[Sent]| {
        let frames = [&[rpdo1(0x0f, mode, -3)], frames].concat();
        // One cycle without data is no silence yet.
        ticks(&mut node, PERIOD - 1);
        frames.iter().for_each(|frame| node.receive(frame));
        node.receive(&sync());
        node.read(&MOVES, true);
        let display = sent_as(&mut node, 0x185).unwrap()[2];
        (display.cast_signed(), node.target())
    };
    assert_eq!(target(POSITION, &[]), (8, Some(Target::Position(-3))));
    assert_eq!(target(VELOCITY, &[rpdo2(-4, 0)]), (9, Some(Target::Velocity(-4))));
    assert_eq!(target(VELOCITY, &[]), (9, None));
    assert_eq!(target(TORQUE, &[rpdo2(-4, -100)]), (10, Some(Target::Torque(-5.0))));
    assert_eq!(target(1, &[rpdo2(-4, 100)]), (10, Some(Target::Torque(5.0))));
    assert_eq!(target(0, &[]), (10, None));
    assert_eq!(target(POSITION, &[]), (8, Some(Target::Position(-3))));
}

#[test]
fn without_a_mode_there_is_no_target() {
    let mut node = started();
    for controlword in [0x06, 0x07, 0x0f, 0x0f] {
        cycle(&mut node, &[rpdo1(controlword, 0, 9), rpdo2(9, 9)], &MOVES);
    }
    assert_eq!((node.wanted(), node.target()), (Wanted::On, None));
}

#[test]
fn an_old_target_never_moves_the_joint() {
    let mut node = enabled();
    command(&mut node, 0x0f);
    command(&mut node, 0x07);
    command(&mut node, 0x0f);
    assert_eq!((node.wanted(), node.target()), (Wanted::On, None));
    // A SYNC without data gives none either, and says so.
    assert_eq!(cycle(&mut node, &[], &MOVES), 0x0237);
    assert_eq!(node.target(), None);
    assert_eq!(command(&mut node, 0x0f), 0x1237);
    node.read(&Actual { fault: 1, ..MOVES }, true);
    assert_eq!(node.target(), None);
}

#[test]
fn data_take_effect_with_the_sync_and_in_operational_only() {
    let mut node = started();
    node.receive(&rpdo1(0x06, POSITION, 0));
    assert_eq!(node.state(), State::SwitchOnDisabled);
    node.receive(&sync());
    assert_eq!(node.state(), State::ReadyToSwitchOn);
    for frame in [nmt(0x80), rpdo1(0x06, POSITION, 0), sync(), nmt(1), sync()] {
        node.receive(&frame);
    }
    assert_eq!(node.state(), State::SwitchOnDisabled);
    // Nor does what came before operational was left.
    for frame in [rpdo1(0x06, POSITION, 0), sync(), rpdo1(0x06, POSITION, 0), nmt(2), nmt(1), sync()] {
        node.receive(&frame);
    }
    assert_eq!(node.state(), State::SwitchOnDisabled);
}

#[test]
fn what_the_master_prepared_is_forgotten_outside_of_operational() {
    for words in [&[0x06][..], &[0x06, 0x07]] {
        let mut node = started();
        for &word in words {
            command(&mut node, word);
        }
        for _ in 0..2 {
            node.read(&MOVES, true);
            node.receive(&sync());
        }
        node.receive(&nmt(0x80));
        assert_eq!((node.state(), node.reading_wanted()), (State::SwitchOnDisabled, false));
        // Neither PDOs nor, for a joint without power, an error.
        assert_eq!(sent(&mut node), []);
    }
}

#[test]
fn silence_of_the_data_stops_and_then_faults() {
    let mut node = enabled();
    ticks(&mut node, PARAMS.timeout - 1);
    assert_eq!(node.wanted(), Wanted::On);
    command(&mut node, 0x0f);
    // SYNCs alone are silence, too.
    ticks(&mut node, PERIOD);
    cycle(&mut node, &[], &MOVES);
    ticks(&mut node, PARAMS.timeout - PERIOD - 1);
    cycle(&mut node, &[], &MOVES);
    assert_eq!(node.wanted(), Wanted::On);
    node.tick();
    assert_eq!(node.wanted(), Wanted::Brake);
    assert_eq!(sent_as(&mut node, 0x085).unwrap(), [0x50, 0x82, 0x11, 0, 0, 0, 0, 0]);
    ticks(&mut node, PARAMS.longest_stop - 1);
    assert_eq!((node.wanted(), node.target()), (Wanted::Brake, None));
    node.tick();
    assert_eq!((node.wanted(), node.state()), (Wanted::Off, State::Fault));
    assert_eq!(command(&mut node, 0x0f), 0x0218);
    assert_eq!(command(&mut node, 0x80), 0x0250);
}

#[test]
fn the_time_out_begins_when_the_joint_is_enabled() {
    let mut node = started();
    for controlword in [0x06, 0x07] {
        command(&mut node, controlword);
    }
    ticks(&mut node, 2 * PARAMS.timeout);
    cycle(&mut node, &[rpdo1(0x0f, VELOCITY, 0)], &MOVES);
    ticks(&mut node, PARAMS.timeout - 1);
    assert_eq!(node.wanted(), Wanted::On);
    node.tick();
    assert_eq!(node.wanted(), Wanted::Brake);
}

#[test]
fn velocity_without_its_data_is_silence() {
    let mut node = enabled();
    for _ in 0..2 {
        assert_eq!(node.wanted(), Wanted::On);
        cycle(&mut node, &[rpdo1(0x0f, VELOCITY, 0)], &MOVES);
        ticks(&mut node, PARAMS.timeout / 2);
    }
    assert_eq!(node.wanted(), Wanted::Brake);
}

#[test]
fn leaving_operational_stops_the_joint() {
    for (command, wanted) in [(2, Wanted::Brake), (0x80, Wanted::Brake), (1, Wanted::On)] {
        let mut node = enabled();
        node.receive(&frame(0x000, &[command, 6]));
        assert_eq!(node.wanted(), Wanted::On);
        node.receive(&frame(0x000, &[command, 0]));
        assert_eq!(node.wanted(), wanted, "{command:#x}");
    }
    let mut node = enabled();
    node.receive(&nmt(2));
    // Nothing but heartbeats in NMT stopped; the emergency message waits.
    assert_eq!(sent(&mut node), []);
    node.receive(&nmt(0x80));
    assert_eq!(sent(&mut node), [(0x085, [0x00, 0x81, 0x11, 0, 0, 0, 0, 0].to_vec())]);
    ticks(&mut node, PARAMS.longest_stop);
    assert_eq!(node.state(), State::Fault);
}

#[test]
fn a_reset_by_nmt_starts_again() {
    for reset in [0x81, 0x82] {
        let mut node = enabled();
        node.receive(&nmt(reset));
        assert_eq!(node.wanted(), Wanted::Brake);
        assert_eq!(sent(&mut node), [(0x705, [0].to_vec())]);
        ticks(&mut node, PARAMS.longest_stop / 2);
        node.receive(&nmt(reset));
        ticks(&mut node, PARAMS.longest_stop / 2);
        assert_eq!(node.state(), State::SwitchOnDisabled);

        let mut node = started();
        node.read(&Actual { fault: 0x4210, ..MOVES }, true);
        node.receive(&nmt(reset));
        assert_eq!(node.state(), State::Fault);
        assert_eq!(sent_as(&mut node, 0x085).unwrap()[..2], [0x10, 0x42]);

        let mut node = enabled();
        ticks(&mut node, PARAMS.timeout + PARAMS.longest_stop);
        assert_eq!(node.state(), State::Fault);
        node.receive(&nmt(reset));
        assert_eq!(node.state(), State::SwitchOnDisabled);
        assert_eq!(sent_as(&mut node, 0x085), None);
    }
}

/// The next heartbeat: how many periods until then, and what it says.
fn heartbeat(node: &mut Node) -> (u32, Vec<u8>) {
    for periods in 1..10_000 {
        node.tick();
        if let Some(data) = sent_as(node, 0x705) {
            return (periods, data);
        }
    }
    panic!("no heartbeat");
}

#[test]
fn heartbeats_tell_the_state_in_their_period() {
    let mut node = PARAMS.build().unwrap();
    sent(&mut node);
    assert_eq!(heartbeat(&mut node), (2000, [0x7f].to_vec()));
    node.receive(&nmt(1));
    assert_eq!(heartbeat(&mut node), (2000, [5].to_vec()));
    node.receive(&nmt(2));
    assert_eq!(heartbeat(&mut node), (2000, [4].to_vec()));
    node.receive(&nmt(1));
    node.receive(&frame(0x605, &[0x2b, 0x17, 0x10, 0, 7, 0, 0, 0]));
    assert_eq!(heartbeat(&mut node), (140, [5].to_vec()));
    node.receive(&frame(0x605, &[0x2b, 0x17, 0x10, 0, 0, 0, 0, 0]));
    sent(&mut node);
    ticks(&mut node, 10_000);
    assert_eq!(sent_as(&mut node, 0x705), None);
}

#[test]
fn silence_of_the_master_stops_and_then_faults() {
    let mut node = enabled();
    // Time or node 0: off.
    for off in [[1, 0, 0, 0], [0, 0, 127, 0]] {
        node.receive(&frame(0x605, &[&[0x23, 0x16, 0x10, 1][..], &off].concat()));
        ticks(&mut node, 30);
        command(&mut node, 0x0f);
        assert_eq!(node.wanted(), Wanted::On);
    }
    // Node 127, 1 ms, of 20 control periods.
    node.receive(&frame(0x605, &[0x23, 0x16, 0x10, 1, 1, 0, 127, 0]));
    for _ in 0..3 {
        ticks(&mut node, 19);
        assert_eq!(node.wanted(), Wanted::On);
        node.receive(&frame(0x77f, &[5]));
        command(&mut node, 0x0f);
    }
    ticks(&mut node, 19);
    node.receive(&frame(0x77e, &[5]));
    assert_eq!(node.wanted(), Wanted::On);
    node.tick();
    assert_eq!(node.wanted(), Wanted::Brake);
    assert_eq!(sent_as(&mut node, 0x085).unwrap(), [0x30, 0x81, 0x11, 0, 0, 0, 0, 0]);
}

#[test]
fn a_counter_of_the_sync_does_not_count() {
    let mut node = started();
    node.receive(&rpdo1(0x06, POSITION, 0));
    node.receive(&frame(SYNC, &[77]));
    assert_eq!((node.state(), node.reading_wanted()), (State::ReadyToSwitchOn, true));
}

#[test]
fn malformed_frames_are_ignored() {
    let mut node = started();
    let extended = |id: u32, data: &[u8]| Sent::new(ExtendedId::new(id).unwrap(), data).unwrap();
    for frame in [
        frame(0x000, &[2]),
        frame(0x000, &[2, 5, 0]),
        frame(0x080, &[1, 2]),
        frame(0x205, &[0x06, 0x00]),
        frame(0x205, &[0x06, 0, 8, 0, 0, 0, 0, 0]),
        frame(0x605, &[0x40, 0x00, 0x10, 0]),
        extended(0x080, &[]),
        extended(0x205, &[0x06, 0, 8, 0, 0, 0, 0]),
        extended(0x605, &[0x40, 0x00, 0x10, 0, 0, 0, 0, 0]),
    ] {
        node.receive(&frame);
    }
    let id = embedded_can::StandardId::new(SYNC).unwrap();
    node.receive(&Remote::new_remote(id, 0).unwrap());
    assert!(!node.reading_wanted());
    assert_eq!(sent(&mut node), []);
    assert_eq!(cycle(&mut node, &[], &MOVES), 0x0250);
}
