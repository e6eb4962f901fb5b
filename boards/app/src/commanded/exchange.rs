//! Between the bus's interrupt and the control's, which interrupts it.

use core::cell::Cell;
use core::sync::atomic::{AtomicU32, Ordering};
use critical_section::Mutex;
use strainwave_drivers::cia402::node::{Actual, Node, Target, Wanted};

/// What the bus wants of the control.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Order {
    pub wanted: Wanted,
    /// One that has come since the last period.
    pub target: Option<Target>,
    /// Cycle of the bus (control periods).
    pub cycle: u32,
    /// Values are to be read.
    pub reads: bool,
    pub resets: bool,
}

/// Orders one way, values the other. Neither side waits: what is copied with interrupts masked is 10 words at most.
pub struct Exchange {
    order: Mutex<Cell<Order>>,
    actual: Mutex<Cell<Option<Actual>>>,
    periods: AtomicU32,
}

impl Exchange {
    /// The drive off, nothing to read.
    #[expect(clippy::new_without_default, reason = "only ever a static")]
    pub const fn new() -> Self {
        let order = Order { wanted: Wanted::Off, target: None, cycle: 0, reads: false, resets: false };
        Self {
            order: Mutex::new(Cell::new(order)),
            actual: Mutex::new(Cell::new(None)),
            periods: AtomicU32::new(0),
        }
    }

    /// Leaves what the node wants; a target that the control has not taken yet stays where there is no newer one.
    pub(super) fn leave(&self, node: &mut Node) {
        let target = node.target();
        let (wanted, cycle) = (node.wanted(), node.period());
        let (reads, resets) = (node.reading_wanted(), node.reset_requested());
        critical_section::with(|section| {
            let place = self.order.borrow(section);
            let last = place.get();
            place.set(Order {
                wanted,
                target: target.or(last.target),
                cycle,
                reads,
                resets: resets || last.resets,
            });
        });
    }

    /// Takes the order of this period; what is ordered once is taken once.
    pub(super) fn take(&self) -> Order {
        // The control is the only writer: a load and a store make no race.
        self.periods.store(self.periods().wrapping_add(1), Ordering::Relaxed);
        critical_section::with(|section| {
            let place = self.order.borrow(section);
            let order = place.get();
            place.set(Order { target: None, reads: false, ..order });
            order
        })
    }

    /// Takes a reset, if one is ordered.
    pub(super) fn take_reset(&self) -> bool {
        critical_section::with(|section| {
            let place = self.order.borrow(section);
            let order = place.get();
            place.set(Order { resets: false, ..order });
            order.resets
        })
    }

    pub(super) fn give(&self, actual: Actual) {
        critical_section::with(|section| self.actual.borrow(section).set(Some(actual)));
    }

    pub(super) fn actual(&self) -> Option<Actual> {
        critical_section::with(|section| self.actual.borrow(section).take())
    }

    /// Periods of the control so far; wraps.
    pub(super) fn periods(&self) -> u32 {
        self.periods.load(Ordering::Relaxed)
    }
}
