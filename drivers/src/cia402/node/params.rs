//! Parameters of the node, checked once.

use super::Node;

/// How the joint is on the bus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// Node, 1 to 127.
    pub node: u8,
    /// Rated torque of the joint at its output (N m), 0.001 to 10^6.
    pub rated_torque: f32,
    /// Control periods per second, a multiple of 1000 from 2000 to 10^6.
    pub rate: u32,
    /// Control periods without a SYNC with new data after which the bus is lost, at least 2 ms: two periods of the bus.
    pub timeout: u32,
    /// Control periods that the joint brakes at most.
    pub longest_stop: u32,
    /// Product code, revision and serial number, object 0x1018.
    pub identity: [u32; 3],
}

impl Params {
    /// The node, pre-operational, its boot-up message waiting.
    ///
    /// `None` when the node, the rated torque, the rate or the time-out is out of range, or there is no time to stop.
    pub fn build(&self) -> Option<Node> {
        let Self { node, rated_torque, rate, timeout, longest_stop, .. } = *self;
        let torque = (0.001..=1e6).contains(&rated_torque);
        let rates = (2000..=1_000_000).contains(&rate) && rate.is_multiple_of(1000);
        // Two periods of the bus by default, which are 1 ms.
        let patient = timeout >= 2 * (rate / 1000);
        let valid = (1..=127).contains(&node) && torque && rates && patient && longest_stop > 0;
        valid.then(|| Node::new(*self))
    }
}
