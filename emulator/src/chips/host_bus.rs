//! A bus of a node on the host: queues; and beside that of a chip.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::convert::Infallible;
use std::rc::Rc;

use embedded_can::nb::Can;
use strainwave_app::commanded::Frame;

use crate::target::Agreement;

/// Frames that a chip may not have sent yet when the host's build of the same code has.
const ON_THEIR_WAY: usize = 3;

/// The bus; a clone is the same one.
#[derive(Clone, Debug, Default)]
pub struct HostBus(Rc<RefCell<Queues>>);

#[derive(Debug, Default)]
struct Queues {
    come: VecDeque<Frame>,
    sent: Vec<Frame>,
}

impl HostBus {
    /// Frames that come to the node.
    pub fn put(&self, frames: impl IntoIterator<Item = Frame>) {
        self.0.borrow_mut().come.extend(frames);
    }

    /// How many frames the node has sent.
    pub fn count(&self) -> usize {
        self.0.borrow().sent.len()
    }

    /// All that the node has sent.
    pub fn sent(&self) -> Vec<Frame> {
        self.0.borrow().sent.clone()
    }
}

/// A bus of a chip and the same of the host's build of its code.
#[derive(Debug, Default)]
pub struct Beside {
    /// The host's.
    pub host: HostBus,
    /// Frames of the chip.
    pub sent: Vec<Frame>,
}

impl Beside {
    /// Frames, and those unlike the host's; what is on its way at the end counts for neither.
    pub fn agreement(&self) -> Agreement {
        let hosts = self.host.sent();
        let alike = self.sent.iter().zip(&hosts).filter(|(chip, host)| chip == host).count();
        let steps = self.sent.len().max(hosts.len().saturating_sub(ON_THEIR_WAY)) as u64;
        Agreement { steps, different: steps - (alike as u64).min(steps) }
    }
}

impl Can for HostBus {
    type Frame = Frame;
    type Error = Infallible;

    fn transmit(&mut self, frame: &Frame) -> nb::Result<Option<Frame>, Infallible> {
        self.0.borrow_mut().sent.push(*frame);
        Ok(None)
    }

    fn receive(&mut self) -> nb::Result<Frame, Infallible> {
        self.0.borrow_mut().come.pop_front().ok_or(nb::Error::WouldBlock)
    }
}
