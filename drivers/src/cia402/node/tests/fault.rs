//! Faults and readiness of the joint: what is told, what resets, what waits.

use super::*;

const BROKEN: Actual = Actual { fault: 0x4210, ..MOVES };
const UNREADY: Actual = Actual { ready: false, ..MOVES };

/// Control periods that a reset may take.
const RESET_PERIODS: u32 = 2000;

/// The error codes that wait.
fn told(node: &mut Node) -> Vec<u16> {
    let emergencies = sent(node).into_iter().filter(|frame| frame.0 == 0x085);
    emergencies.map(|(_, data)| u16::from_le_bytes([data[0], data[1]])).collect()
}

/// An edge of the fault reset.
fn reset(node: &mut Node) {
    for word in [0x00, 0x80] {
        node.receive(&rpdo1(word, POSITION, 0));
        node.receive(&sync());
    }
}

/// A node in fault, its joint's, and the joint told to reset.
fn resetting() -> Node {
    let mut node = started();
    node.read(&BROKEN, true);
    assert_eq!(told(&mut node), [0x4210]);
    reset(&mut node);
    assert!(node.reset_requested());
    node
}

#[test]
fn a_joint_is_not_ready_until_it_says_so() {
    let mut node = PARAMS.build().unwrap();
    node.receive(&nmt(1));
    for word in [0x06, 0x07, 0x0f] {
        assert_eq!(cycle(&mut node, &[rpdo1(word, POSITION, 0)], &UNREADY), 0x0200);
    }
    assert_eq!(node.state(), State::NotReady);
    assert_eq!(cycle(&mut node, &[], &MOVES), 0x0250);
    assert_eq!(command(&mut node, 0x06), 0x0231);
}

#[test]
fn a_joint_that_is_not_ready_is_not_switched_on() {
    for prepared in [&[][..], &[0x06], &[0x06, 0x07]] {
        let mut node = started();
        for &word in prepared {
            command(&mut node, word);
        }
        node.read(&UNREADY, false);
        assert_eq!(node.state(), State::SwitchOnDisabled, "{prepared:?}");
        for word in [0x06, 0x07, 0x0f] {
            node.receive(&rpdo1(word, POSITION, 0));
            node.receive(&sync());
            assert_eq!(node.state(), State::SwitchOnDisabled, "{prepared:?}");
        }
        node.read(&MOVES, false);
        assert_eq!(command(&mut node, 0x06), 0x0231);
    }
    // In operation its own faults tell; once off it stays so.
    let mut node = enabled();
    node.read(&UNREADY, false);
    assert_eq!(node.wanted(), Wanted::On);
    node.receive(&rpdo1(0x07, POSITION, 0));
    node.receive(&sync());
    assert_eq!(node.state(), State::SwitchOnDisabled);
}

#[test]
fn a_reset_waits_until_the_joint_is_ready_without_a_fault() {
    let mut node = resetting();
    for actual in [BROKEN, UNREADY, Actual { ready: false, ..BROKEN }] {
        ticks(&mut node, RESET_PERIODS / 4);
        node.read(&actual, false);
        assert_eq!((node.state(), told(&mut node)), (State::Fault, Vec::new()));
    }
    ticks(&mut node, RESET_PERIODS / 4);
    node.read(&MOVES, false);
    assert_eq!((node.state(), told(&mut node)), (State::SwitchOnDisabled, [0].to_vec()));
}

#[test]
fn a_reset_gives_up() {
    for actual in [BROKEN, UNREADY] {
        let mut node = resetting();
        ticks(&mut node, RESET_PERIODS - 1);
        node.read(&actual, false);
        let mut late = node.clone();
        node.tick();
        node.read(&actual, false);
        node.read(&MOVES, false);
        assert_eq!((node.state(), told(&mut node)), (State::Fault, Vec::new()));
        reset(&mut node);
        assert!(node.reset_requested());

        late.tick();
        late.read(&MOVES, false);
        assert_eq!(late.state(), State::SwitchOnDisabled);
    }
}

#[test]
fn a_fault_of_the_bus_is_reset_without_the_joint() {
    for code in [0x8250, 0x8130, 0x8100, 0x8700] {
        let mut node = enabled();
        match code {
            0x8130 => {
                node.receive(&frame(0x605, &[0x23, 0x16, 0x10, 1, 1, 0, 127, 0]));
                ticks(&mut node, 20);
            }
            0x8100 => [0x80, 1].map(nmt).iter().for_each(|frame| node.receive(frame)),
            0x8700 => (0..5).for_each(|_| node.receive(&sync())),
            _ => ticks(&mut node, PARAMS.timeout),
        }
        ticks(&mut node, PARAMS.longest_stop);
        assert_eq!((node.state(), told(&mut node)), (State::Fault, [code].to_vec()));
        reset(&mut node);
        assert!(!node.reset_requested(), "{code:#x}");
        assert_eq!((node.state(), told(&mut node)), (State::SwitchOnDisabled, [0].to_vec()));
        node.read(&MOVES, true);
        for word in [0x06, 0x07, 0x0f] {
            command(&mut node, word);
        }
        assert_eq!(node.wanted(), Wanted::On);
    }
}

#[test]
fn a_fault_of_the_joint_takes_the_place_of_one_of_the_bus() {
    for stopped in [0, PARAMS.longest_stop] {
        let mut node = enabled();
        ticks(&mut node, PARAMS.timeout + stopped);
        node.read(&BROKEN, false);
        assert_eq!((node.state(), node.wanted()), (State::Fault, Wanted::Off));
        assert_eq!(told(&mut node), [0x8250, 0x4210]);
        assert_eq!(node.machine.error(), 0x4210);
        // It is the joint's from now on.
        node.read(&Actual { fault: 0x2310, ..MOVES }, false);
        node.read(&MOVES, false);
        assert_eq!((node.state(), node.machine.error()), (State::Fault, 0x4210));
        reset(&mut node);
        assert!(node.reset_requested());
        node.read(&MOVES, false);
        assert_eq!((node.state(), told(&mut node)), (State::SwitchOnDisabled, [0].to_vec()));
    }
}

#[test]
fn emergency_messages_wait_in_order() {
    let mut node = started();
    for fault in [0x4210, 0x2310, 0x3210] {
        node.read(&Actual { fault, ..MOVES }, false);
        reset(&mut node);
        assert!(node.reset_requested());
        node.read(&MOVES, false);
    }
    // Four wait; without room the newest replaces the last.
    assert_eq!(told(&mut node), [0x4210, 0, 0x2310, 0]);
    assert_eq!(told(&mut node), []);
}

#[test]
fn values_from_before_the_sync_do_not_answer_it() {
    let mut node = started();
    node.receive(&sync());
    node.read(&BROKEN, false);
    assert!(node.reading_wanted());
    assert_eq!(node.state(), State::Fault);
    assert_eq!(sent_as(&mut node, 0x185), None);
    node.read(&BROKEN, true);
    assert!(!node.reading_wanted());
    assert_eq!(sent_as(&mut node, 0x185).unwrap()[..2], [0x18, 0x02]);
    node.read(&BROKEN, true);
    assert_eq!(sent(&mut node), []);
}
