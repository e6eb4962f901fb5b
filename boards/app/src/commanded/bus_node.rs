//! The node with its bus, and the drive behind it.

use embedded_can::nb::Can;
use strainwave::compensator::words::{LAYOUT, identity};
use strainwave_drivers::cia402::node::{Node, Params};

use crate::commanded::Exchange;
use crate::commanded::drive::{Drive, Wired};
use crate::control::RATE;
use crate::{Compensator, joint};

/// Frames that are taken or sent in a poll, at most: more than the bus carries in a control period.
const FRAMES: usize = 6;
/// Control periods that are made up for in a poll, at most: what has come meanwhile is taken behind them.
const MADE_UP: u32 = 10;
/// Polls in which a frame waits for room, at most: what is sent is not to be old.
const LONGEST_WAIT: u32 = 50;

/// Without a SYNC and a target for so long the joint brakes (s).
const TIMEOUT: f32 = 0.05;
/// It is switched off when it rests, or after this time (s).
const LONGEST_STOP: f32 = 1.0;

/// The joint of this firmware as node `number`, 1 to 127.
pub fn node(number: u8, compensator: &Compensator) -> Option<Node> {
    Params {
        node: number,
        rated_torque: compensator.limits().output_torque,
        rate: RATE,
        timeout: (TIMEOUT * RATE as f32) as u32,
        longest_stop: (LONGEST_STOP * RATE as f32) as u32,
        identity: [LAYOUT, 1, identity(&joint::WORDS)],
    }
    .build()
}

/// The node on a bus, with the drive that the control does not command itself.
pub struct BusNode<C: Can, D = Wired> {
    node: Node,
    can: C,
    drive: D,
    exchange: &'static Exchange,
    /// The last values were of a joint in a fault of its own, and not of its drive's.
    in_fault: bool,
    /// A frame for which there was no room, and since how many polls.
    waits: Option<C::Frame>,
    waited: u32,
    /// Periods of the control at the last poll.
    periods: u32,
}

impl<C: Can, D: Drive> BusNode<C, D> {
    /// A node on its bus, whose control is at the exchange's other end.
    pub fn new(node: Node, can: C, drive: D, exchange: &'static Exchange) -> Self {
        Self { node, can, drive, exchange, in_fault: false, waits: None, waited: 0, periods: 0 }
    }

    /// Once in every control period, from one place below the control's priority: takes and sends frames, never waits.
    pub fn poll(&mut self) {
        let periods = self.exchange.periods();
        let passed = periods.wrapping_sub(self.periods);
        for _ in 0..passed.min(MADE_UP) {
            self.node.tick();
        }
        self.periods = periods;
        self.drive(passed);
        for _ in 0..FRAMES {
            let Ok(frame) = self.can.receive() else { break };
            self.node.receive(&frame);
        }
        let resets = self.resets();
        self.exchange.leave(&mut self.node, resets);
        self.send();
    }

    /// Takes the control's values and hands its torque to the drive: before the frames of the bus, so that the torque is not late.
    fn drive(&mut self, passed: u32) {
        let reported = self.drive.listen(passed);
        let given = self.exchange.given();
        if let Some(given) = given {
            self.in_fault = given.actual.fault != 0;
            self.node.read(&reported.joined(given.actual), given.answers);
        }
        self.drive.command(self.node.wanted(), given.map(|given| given.torque));
    }

    /// The control is to be reset. A fault of the drive alone leaves the control, and with it the position, as it is.
    fn resets(&mut self) -> bool {
        let requested = self.node.reset_requested();
        if requested {
            self.drive.reset();
        }
        requested && self.in_fault
    }

    fn send(&mut self) {
        for _ in 0..FRAMES {
            let Some(frame) = self.waits.take().or_else(|| self.node.send()) else { return };
            if self.can.transmit(&frame).is_err() {
                self.waited += 1;
                self.waits = (self.waited <= LONGEST_WAIT).then_some(frame);
                return;
            }
            self.waited = 0;
        }
    }
}
