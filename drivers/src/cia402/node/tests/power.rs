//! States of the power: the standard's table, faults, braking.

use super::*;

const STATES: [State; 8] = [
    State::NotReady,
    State::SwitchOnDisabled,
    State::ReadyToSwitchOn,
    State::SwitchedOn,
    State::OperationEnabled,
    State::QuickStopActive,
    State::FaultReactionActive,
    State::Fault,
];

/// A node in NMT operational that has just come to this state, bit 7 of its controlword low.
fn node_in(state: State) -> Node {
    let mut node = match state {
        State::NotReady => {
            let mut node = PARAMS.build().unwrap();
            node.receive(&nmt(1));
            node
        }
        State::OperationEnabled | State::QuickStopActive | State::FaultReactionActive => enabled(),
        _ => started(),
    };
    let words: &[u16] = match state {
        State::ReadyToSwitchOn => &[0x06],
        State::SwitchedOn => &[0x06, 0x07],
        State::QuickStopActive => &[0x02],
        _ => &[],
    };
    for &word in words {
        command(&mut node, word);
    }
    match state {
        State::FaultReactionActive => ticks(&mut node, PARAMS.timeout),
        State::Fault => node.read(&Actual { fault: 0x4210, ..MOVES }, true),
        _ => {}
    }
    assert_eq!(node.state(), state);
    node
}

/// The state behind a controlword, before the joint's values are read.
fn after(state: State, controlword: u16) -> State {
    let mut node = node_in(state);
    node.receive(&rpdo1(controlword, POSITION, 0));
    node.receive(&sync());
    node.state()
}

#[test]
fn commands_lead_where_the_standard_says() {
    use State::*;
    // Columns: shutdown, switch on (disable operation), enable operation, disable voltage, quick stop.
    let table = [
        (NotReady, [NotReady; 5]),
        (
            SwitchOnDisabled,
            [ReadyToSwitchOn, SwitchOnDisabled, SwitchOnDisabled, SwitchOnDisabled, SwitchOnDisabled],
        ),
        (ReadyToSwitchOn, [ReadyToSwitchOn, SwitchedOn, SwitchedOn, SwitchOnDisabled, SwitchOnDisabled]),
        (SwitchedOn, [ReadyToSwitchOn, SwitchedOn, OperationEnabled, SwitchOnDisabled, SwitchOnDisabled]),
        (
            OperationEnabled,
            [ReadyToSwitchOn, SwitchedOn, OperationEnabled, SwitchOnDisabled, QuickStopActive],
        ),
        (
            QuickStopActive,
            [QuickStopActive, QuickStopActive, QuickStopActive, SwitchOnDisabled, QuickStopActive],
        ),
        (FaultReactionActive, [FaultReactionActive; 5]),
        (Fault, [Fault; 5]),
    ];
    assert_eq!(table.map(|row| row.0), STATES);
    // Words of each column with every value of the bits that do not matter, the fault reset among them.
    let columns: [&[u16]; 5] = [
        &[0x06, 0x0e, 0x86, 0x106],
        &[0x07, 0x87, 0x107],
        &[0x0f, 0x8f, 0x10f],
        &[0x00, 0x01, 0x04, 0x05, 0x08, 0x0d, 0x80, 0x100],
        &[0x02, 0x03, 0x0a, 0x0b, 0x82],
    ];
    for (state, row) in table {
        for (words, expected) in columns.iter().zip(row) {
            for &word in *words {
                assert_eq!(after(state, word), expected, "{state:?} {word:#x}");
            }
        }
    }
}

#[test]
fn power_is_on_in_operation_enabled_only() {
    for state in STATES {
        let wanted = match state {
            State::OperationEnabled => Wanted::On,
            State::QuickStopActive | State::FaultReactionActive => Wanted::Brake,
            _ => Wanted::Off,
        };
        assert_eq!(node_in(state).wanted(), wanted, "{state:?}");
    }
}

#[test]
fn a_fault_of_the_joint_leads_to_fault_from_every_state() {
    for state in STATES.into_iter().filter(|state| *state != State::Fault) {
        let mut node = node_in(state);
        sent(&mut node);
        node.read(&Actual { fault: 0x4210, ..MOVES }, true);
        assert_eq!((node.state(), node.wanted()), (State::Fault, Wanted::Off), "{state:?}");
        let emergency = [0x10, 0x42, 0x09, 0, 0, 0, 0, 0].to_vec();
        assert_eq!(sent(&mut node), [(0x085, emergency)], "{state:?}");
        node.read(&Actual { fault: 0x4210, ..MOVES }, true);
        node.read(&Actual { fault: 0x2310, ..MOVES }, true);
        assert_eq!(sent(&mut node), [], "{state:?}");
    }
}

#[test]
fn a_stop_ends_at_rest_or_after_the_longest_time() {
    for (state, end) in
        [(State::QuickStopActive, State::SwitchOnDisabled), (State::FaultReactionActive, State::Fault)]
    {
        let mut node = node_in(state);
        ticks(&mut node, PARAMS.longest_stop - 1);
        assert_eq!(node.state(), state);
        node.tick();
        assert_eq!(node.state(), end);

        let mut node = node_in(state);
        ticks(&mut node, 3);
        node.read(&Actual { at_rest: true, ..MOVES }, true);
        assert_eq!(node.state(), state);
        node.tick();
        assert_eq!(node.state(), end);
    }
}

#[test]
fn rest_from_before_a_stop_does_not_end_it() {
    let mut node = enabled();
    let at_rest = Actual { at_rest: true, ..MOVES };
    assert_eq!(cycle(&mut node, &[rpdo1(0x0f, POSITION, 0)], &at_rest), 0x1237);
    node.receive(&rpdo1(0x02, POSITION, 0));
    node.receive(&sync());
    node.tick();
    assert_eq!(node.state(), State::QuickStopActive);
}

#[test]
fn a_fault_is_reset_by_a_rising_edge_only() {
    let mut node = enabled();
    command(&mut node, 0x8f);
    node.read(&Actual { fault: 0x4210, ..MOVES }, true);
    for word in [0x8f, 0x80, 0x00] {
        command(&mut node, word);
        assert!(!node.reset_requested(), "{word:#x}");
    }
    command(&mut node, 0x80);
    assert_eq!(node.state(), State::Fault);
    assert!(node.reset_requested());
    sent(&mut node);
    node.read(&MOVES, true);
    assert_eq!(node.state(), State::SwitchOnDisabled);
    assert_eq!(sent(&mut node), [(0x085, [0; 8].to_vec())]);
    // The next fault needs an edge of its own.
    node.read(&Actual { fault: 0x4210, ..MOVES }, true);
    node.read(&MOVES, true);
    assert_eq!(node.state(), State::Fault);
}

#[test]
fn a_fault_that_stays_after_the_reset_waits_for_another_edge() {
    let mut node = node_in(State::Fault);
    sent(&mut node);
    node.receive(&rpdo1(0x80, POSITION, 0));
    node.receive(&sync());
    assert!(node.reset_requested());
    for _ in 0..2000 {
        node.tick();
        node.read(&Actual { fault: 0x4210, ..MOVES }, true);
    }
    node.read(&MOVES, true);
    assert_eq!(node.state(), State::Fault);
    assert_eq!(sent_as(&mut node, 0x085), None);
    for word in [0x00, 0x80] {
        command(&mut node, word);
    }
    assert!(node.reset_requested());
    node.read(&MOVES, true);
    assert_eq!(node.state(), State::SwitchOnDisabled);
}

#[test]
fn another_fault_behind_the_reset_is_told() {
    let mut node = node_in(State::Fault);
    node.receive(&rpdo1(0x80, POSITION, 0));
    node.receive(&sync());
    assert!(node.reset_requested());
    sent(&mut node);
    ticks(&mut node, 2000);
    node.read(&Actual { fault: 0x3210, ..MOVES }, true);
    assert_eq!(sent_as(&mut node, 0x085).unwrap(), [0x10, 0x32, 0x05, 0, 0, 0, 0, 0]);
}

#[test]
fn operation_is_enabled_when_the_drive_is_powered_and_not_before() {
    let unpowered = Actual { powered: false, ..MOVES };
    let enable = |node: &mut Node| cycle(node, &[rpdo1(0x0f, POSITION, 7)], &unpowered);
    let awaiting = || {
        let mut node = node_in(State::SwitchedOn);
        node.read(&unpowered, true);
        assert_eq!((node.wanted(), enable(&mut node)), (Wanted::Off, 0x0233));
        assert_eq!((node.state(), node.wanted(), node.target()), (State::SwitchedOn, Wanted::Standby, None));
        node
    };
    let mut node = awaiting();
    assert_eq!(enable(&mut node), 0x0233);
    assert_eq!(node.wanted(), Wanted::Standby);
    node.read(&MOVES, false);
    assert_eq!((node.state(), node.wanted(), node.target()), (State::OperationEnabled, Wanted::On, None));
    assert_eq!(command(&mut node, 0x0f), 0x1237);
    // Its end in operation is a fault, which the joint tells.
    assert_eq!(enable(&mut node), 0x1237);

    for (word, state) in [
        (0x07, State::SwitchedOn),
        (0x06, State::ReadyToSwitchOn),
        (0x02, State::SwitchOnDisabled),
        (0x00, State::SwitchOnDisabled),
    ] {
        let mut node = awaiting();
        command(&mut node, word);
        assert_eq!((node.state(), node.wanted()), (state, Wanted::Off), "{word:#x}");
        node.read(&MOVES, false);
        assert_eq!(node.state(), state, "{word:#x}");
    }
    let mut node = awaiting();
    node.read(&Actual { fault: 0x5400, ..unpowered }, false);
    node.read(&MOVES, false);
    assert_eq!((node.state(), node.wanted()), (State::Fault, Wanted::Off));
}
