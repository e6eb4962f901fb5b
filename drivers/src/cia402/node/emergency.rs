//! Emergency messages that wait to be sent, in order.

/// Error codes; the bus may not have carried the last ones when the next comes.
#[derive(Clone, Debug)]
pub(super) struct Emergencies([Option<u16>; 4]);

impl Emergencies {
    pub(super) const fn new() -> Self {
        Self([None; 4])
    }

    /// Behind those that wait. Without room it takes the place of the last one: how things are now counts more than how they came so.
    pub(super) fn push(&mut self, code: u16) {
        let [first @ .., last] = &mut self.0;
        *first.iter_mut().find(|place| place.is_none()).unwrap_or(last) = Some(code);
    }

    pub(super) fn take(&mut self) -> Option<u16> {
        let [next, second, third, fourth] = self.0;
        self.0 = [second, third, fourth, None];
        next
    }
}
