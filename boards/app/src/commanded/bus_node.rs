//! The node with its bus.

use embedded_can::nb::Can;
use strainwave::compensator::words::{LAYOUT, identity};
use strainwave_drivers::cia402::node::{Node, Params};

use crate::commanded::Exchange;
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

/// The node on a bus.
pub struct BusNode<C: Can> {
    node: Node,
    can: C,
    exchange: &'static Exchange,
    /// A frame for which there was no room, and since how many polls.
    waits: Option<C::Frame>,
    waited: u32,
    /// Periods of the control at the last poll.
    periods: u32,
}

impl<C: Can> BusNode<C> {
    /// A node on its bus, whose control is at the exchange's other end.
    pub fn new(node: Node, can: C, exchange: &'static Exchange) -> Self {
        Self { node, can, exchange, waits: None, waited: 0, periods: 0 }
    }

    /// Once in every control period, from one place below the control's priority: takes and sends frames, never waits.
    pub fn poll(&mut self) {
        let periods = self.exchange.periods();
        for _ in 0..periods.wrapping_sub(self.periods).min(MADE_UP) {
            self.node.tick();
        }
        self.periods = periods;
        if let Some((actual, answers)) = self.exchange.actual() {
            self.node.read(&actual, answers);
        }
        for _ in 0..FRAMES {
            let Ok(frame) = self.can.receive() else { break };
            self.node.receive(&frame);
        }
        self.exchange.leave(&mut self.node);
        self.send();
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
