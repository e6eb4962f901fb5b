//! What waits to be sent: of each kind the newest frame, of emergency messages all, in a fixed order.

use core::mem::take;

use embedded_can::{Frame, StandardId};

use super::nmt::Nmt;
use super::objects::error_register;
use super::{ANSWER, EMCY, HEARTBEAT, Node, TPDO1, TPDO2};

/// What waits to be sent, besides the machine's emergency messages.
#[derive(Clone, Debug, Default)]
pub(super) struct Outbox {
    pub(super) boot_up: bool,
    pub(super) tpdo1: Option<[u8; 7]>,
    pub(super) tpdo2: Option<[u8; 6]>,
    pub(super) answer: Option<[u8; 8]>,
    pub(super) heartbeat: bool,
}

impl Node {
    /// The next frame that waits to be sent: at most nine, boot-up first, heartbeat last.
    pub fn send<F: Frame>(&mut self) -> Option<F> {
        if take(&mut self.outbox.boot_up) {
            return self.frame(HEARTBEAT, &[0]);
        }
        if self.nmt != Nmt::Stopped
            && let Some(code) = self.machine.take_emergency()
        {
            let [c0, c1] = code.to_le_bytes();
            return self.frame(EMCY, &[c0, c1, error_register(code), 0, 0, 0, 0, 0]);
        }
        if let Some(data) = self.outbox.tpdo1.take() {
            return self.frame(TPDO1, &data);
        }
        if let Some(data) = self.outbox.tpdo2.take() {
            return self.frame(TPDO2, &data);
        }
        if let Some(data) = self.outbox.answer.take() {
            return self.frame(ANSWER, &data);
        }
        if take(&mut self.outbox.heartbeat) {
            return self.frame(HEARTBEAT, &[self.nmt as u8]);
        }
        None
    }

    fn frame<F: Frame>(&self, function: u16, data: &[u8]) -> Option<F> {
        F::new(StandardId::new(function | self.node)?, data)
    }
}
