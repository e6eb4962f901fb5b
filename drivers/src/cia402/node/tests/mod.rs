//! A small master and a joint for the tests, and one walk through everything.

mod bus;
mod drive;
mod eds;
mod fault;
mod laws;
mod period;
mod power;
mod sdo;

use embedded_can::{Frame, Id};
use std::vec::Vec;

use super::{Actual, Node, Params, State, Target, Wanted};
use crate::testing::{Sent, frame};

const PARAMS: Params = Params {
    node: 5,
    rated_torque: 50.0,
    rate: 20_000,
    timeout: 40,
    longest_stop: 100,
    identity: [0x10, 0x20, 0x30],
};

/// Control periods of the bus's period, as it is by default.
const PERIOD: u32 = 20;

const SYNC: u16 = 0x080;

// Modes of operation.
const POSITION: i8 = 8;
const VELOCITY: i8 = 9;
const TORQUE: i8 = 10;

fn rpdo1(controlword: u16, mode: i8, position: i32) -> Sent {
    let data = [&controlword.to_le_bytes()[..], &mode.to_le_bytes(), &position.to_le_bytes()].concat();
    frame(0x205, &data)
}

fn rpdo2(velocity: i32, torque: i16) -> Sent {
    frame(0x305, &[&velocity.to_le_bytes()[..], &torque.to_le_bytes()].concat())
}

fn sync() -> Sent {
    frame(SYNC, &[])
}

fn nmt(command: u8) -> Sent {
    frame(0x000, &[command, 5])
}

/// All that waits: identifiers and data.
fn sent(node: &mut Node) -> Vec<(u16, Vec<u8>)> {
    core::iter::from_fn(|| node.send::<Sent>())
        .map(|Sent(id, data)| match id {
            Id::Standard(id) => (id.as_raw(), data),
            Id::Extended(id) => panic!("{id:?}"),
        })
        .collect()
}

/// The data of the one frame with this identifier that waits; all others are lost.
fn sent_as(node: &mut Node, id: u16) -> Option<Vec<u8>> {
    let mut found = sent(node).into_iter().filter(|frame| frame.0 == id);
    let first = found.next().map(|frame| frame.1);
    assert_eq!(found.next(), None);
    first
}

/// A joint without faults that moves.
const MOVES: Actual = Actual {
    ready: true,
    powered: true,
    position: 1_000_000,
    velocity: -2000,
    torque: 12.5,
    fault: 0,
    at_rest: false,
    follows: true,
};

/// The node in NMT operational, its joint's values known, nothing waiting.
fn started() -> Node {
    let mut node = PARAMS.build().unwrap();
    node.read(&MOVES, true);
    node.receive(&nmt(1));
    sent(&mut node);
    node
}

/// One cycle of the bus in which these frames come before the SYNC: the statusword.
fn cycle(node: &mut Node, frames: &[Sent], actual: &Actual) -> u16 {
    frames.iter().for_each(|frame| node.receive(frame));
    node.receive(&sync());
    assert!(node.reading_wanted());
    node.read(actual, true);
    assert!(!node.reading_wanted());
    let data = sent_as(node, 0x185).unwrap();
    u16::from_le_bytes([data[0], data[1]])
}

/// One cycle with a controlword, in position mode.
fn command(node: &mut Node, controlword: u16) -> u16 {
    cycle(node, &[rpdo1(controlword, POSITION, 7)], &MOVES)
}

/// The node in operation enabled.
fn enabled() -> Node {
    let mut node = started();
    for controlword in [0x06, 0x07, 0x0f] {
        command(&mut node, controlword);
    }
    assert_eq!((node.state(), node.wanted()), (State::OperationEnabled, Wanted::On));
    node
}

fn ticks(node: &mut Node, periods: u32) {
    (0..periods).for_each(|_| node.tick());
}

#[test]
fn a_master_walks_from_boot_up_to_motion_quick_stop_fault_and_reset() {
    let mut node = PARAMS.build().unwrap();
    assert_eq!(sent(&mut node), [(0x705, [0].to_vec())]);
    node.tick();
    node.read(&MOVES, true);
    node.receive(&nmt(1));

    assert_eq!(command(&mut node, 0x00), 0x0250);
    assert_eq!(command(&mut node, 0x06), 0x0231);
    assert_eq!(command(&mut node, 0x07), 0x0233);
    assert_eq!(command(&mut node, 0x0f), 0x0237);
    assert_eq!(node.target(), None);
    for position in [1_000_000, 1_000_100, 1_000_200] {
        ticks(&mut node, 20);
        let status = cycle(&mut node, &[rpdo1(0x0f, POSITION, position)], &MOVES);
        assert_eq!((status, node.wanted()), (0x1237, Wanted::On));
        assert_eq!(node.target(), Some(Target::Position(position)));
        assert_eq!(node.target(), None);
    }

    assert_eq!(command(&mut node, 0x02), 0x0217);
    assert_eq!((node.target(), node.wanted()), (None, Wanted::Brake));
    let at_rest = Actual { at_rest: true, ..MOVES };
    assert_eq!(cycle(&mut node, &[rpdo1(0x02, POSITION, 0)], &at_rest), 0x0617);
    node.tick();
    assert_eq!((command(&mut node, 0x02), node.wanted()), (0x0250, Wanted::Off));

    for controlword in [0x06, 0x07, 0x0f] {
        command(&mut node, controlword);
    }
    let broken = Actual { fault: 0x2310, ..MOVES };
    assert_eq!(cycle(&mut node, &[rpdo1(0x0f, POSITION, 0)], &broken), 0x0218);
    assert_eq!(node.wanted(), Wanted::Off);
    assert_eq!(cycle(&mut node, &[rpdo1(0x00, POSITION, 0)], &broken), 0x0218);
    assert!(!node.reset_requested());
    assert_eq!(cycle(&mut node, &[rpdo1(0x80, POSITION, 0)], &broken), 0x0218);
    assert!(node.reset_requested());
    assert!(!node.reset_requested());
    assert_eq!(command(&mut node, 0x00), 0x0250);
    for controlword in [0x06, 0x07, 0x0f, 0x0f] {
        command(&mut node, controlword);
    }
    assert_eq!(node.target(), Some(Target::Position(7)));
}

#[test]
fn parameters_out_of_range_build_no_node() {
    let bad = [
        Params { node: 0, ..PARAMS },
        Params { node: 128, ..PARAMS },
        Params { rated_torque: 0.0, ..PARAMS },
        Params { rated_torque: -1.0, ..PARAMS },
        Params { rated_torque: f32::NAN, ..PARAMS },
        Params { rated_torque: f32::INFINITY, ..PARAMS },
        Params { rate: 0, ..PARAMS },
        Params { rate: 1000, ..PARAMS },
        Params { rate: 20_500, ..PARAMS },
        Params { rate: 2_000_000, ..PARAMS },
        Params { timeout: 0, ..PARAMS },
        Params { timeout: 39, ..PARAMS },
        Params { rate: 21_000, ..PARAMS },
        Params { longest_stop: 0, ..PARAMS },
    ];
    assert!(bad.iter().all(|params| params.build().is_none()));
    assert!(Params { node: 127, rate: 2000, ..PARAMS }.build().is_some());
}

/// A remote frame.
struct Remote(Sent);

impl Frame for Remote {
    fn new(_: impl Into<Id>, _: &[u8]) -> Option<Self> {
        None
    }

    fn new_remote(id: impl Into<Id>, _: usize) -> Option<Self> {
        Some(Self(Sent(id.into(), Vec::new())))
    }

    fn is_extended(&self) -> bool {
        self.0.is_extended()
    }

    fn is_remote_frame(&self) -> bool {
        true
    }

    fn id(&self) -> Id {
        self.0.id()
    }

    fn dlc(&self) -> usize {
        0
    }

    fn data(&self) -> &[u8] {
        &[]
    }
}
