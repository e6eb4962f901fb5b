//! A bus of a node on the host: queues.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::convert::Infallible;
use std::rc::Rc;

use embedded_can::nb::Can;
use strainwave_app::commanded::Frame;

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

    /// All that the node has sent.
    pub fn sent(&self) -> Vec<Frame> {
        self.0.borrow().sent.clone()
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
