//! The time of a peripheral that is brought up to date when it is accessed.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

use rsemu::core::sched::{AccessKind, LazyHandle};
use rsemu::core::space::MemAttrs;

/// Its time, in its own clocks.
#[derive(Debug, Default)]
pub struct Time {
    tick: AtomicU64,
    clock: OnceLock<LazyHandle>,
}

impl Time {
    /// Until when it has come.
    pub fn now(&self) -> u64 {
        self.tick.load(Ordering::Relaxed)
    }

    /// Comes until then, never back.
    pub fn advance_to(&self, tick: u64) {
        self.tick.fetch_max(tick, Ordering::Relaxed);
    }

    /// What brings it up to date.
    pub fn attach(&self, handle: LazyHandle) {
        self.clock.get_or_init(|| handle);
    }

    /// The time of an access. That of a debugger stands still.
    pub fn sync(&self, attributes: MemAttrs) -> u64 {
        if let (Some(clock), false) = (self.clock.get(), attributes.debug) {
            // Refused where it is being brought up to date already: then it is.
            let _ = clock.sync(AccessKind::Guest);
        }
        self.now()
    }
}
