//! Between the bus's interrupt and the control's, which interrupts it.

use core::cell::Cell;
use core::sync::atomic::{AtomicU32, Ordering};
use critical_section::Mutex;
use strainwave_drivers::cia402::node::{Actual, Node, Target, Wanted};

/// Periods after which an order that was not renewed is none: the drive is off.
const LONGEST: u32 = 100;

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
}

/// What a step of the control gives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Given {
    pub actual: Actual,
    /// It answers that values are to be read.
    pub answers: bool,
    /// Torque for the drive (N m), 0 where that is released.
    pub torque: f32,
}

/// Orders one way, values the other. Neither side waits: what is copied with interrupts masked is 12 words at most.
pub struct Exchange {
    order: Mutex<Cell<Order>>,
    /// Periods since the order was left.
    age: AtomicU32,
    resets: Mutex<Cell<bool>>,
    given: Mutex<Cell<Option<Given>>>,
    periods: AtomicU32,
}

impl Exchange {
    /// The drive off, nothing to read.
    #[expect(clippy::new_without_default, reason = "only ever a static")]
    pub const fn new() -> Self {
        let order = Order { wanted: Wanted::Off, target: None, cycle: 0, reads: false };
        Self {
            order: Mutex::new(Cell::new(order)),
            age: AtomicU32::new(0),
            resets: Mutex::new(Cell::new(false)),
            given: Mutex::new(Cell::new(None)),
            periods: AtomicU32::new(0),
        }
    }

    /// Leaves what the node wants, and whether the control is to be reset; a target that the control has not taken yet stays where there is no
    /// newer one.
    pub(super) fn leave(&self, node: &mut Node, resets: bool) {
        let target = node.target();
        let (wanted, cycle, reads) = (node.wanted(), node.period(), node.reading_wanted());
        critical_section::with(|section| {
            let place = self.order.borrow(section);
            place.set(Order { wanted, target: target.or(place.get().target), cycle, reads });
            self.age.store(0, Ordering::Relaxed);
            let place = self.resets.borrow(section);
            place.set(place.get() || resets);
        });
    }

    /// Takes the order of this period, a target once.
    pub(super) fn take(&self) -> Order {
        // The control is the only writer: a load and a store make no race.
        self.periods.store(self.periods().wrapping_add(1), Ordering::Relaxed);
        critical_section::with(|section| {
            let place = self.order.borrow(section);
            let order = place.get();
            place.set(Order { target: None, ..order });
            let age = self.age.load(Ordering::Relaxed).saturating_add(1);
            self.age.store(age, Ordering::Relaxed);
            // Nobody hears the bus any more.
            let wanted = if age > LONGEST { Wanted::Off } else { order.wanted };
            Order { wanted, ..order }
        })
    }

    /// Takes a reset, if one is ordered.
    pub(super) fn take_reset(&self) -> bool {
        critical_section::with(|section| self.resets.borrow(section).take())
    }

    /// Gives a step's values.
    pub(super) fn give(&self, given: Given) {
        critical_section::with(|section| self.given.borrow(section).set(Some(given)));
    }

    /// Values that were not taken yet.
    pub(super) fn given(&self) -> Option<Given> {
        critical_section::with(|section| self.given.borrow(section).take())
    }

    /// Periods of the control so far; wraps.
    pub(super) fn periods(&self) -> u32 {
        self.periods.load(Ordering::Relaxed)
    }
}
