//! Slot in which the control waits for its interrupt.

use crate::control::{Board, Control};
use core::cell::RefCell;
use critical_section::Mutex;

/// The control, which start-up puts in before the interrupt is unmasked and only the interrupt uses after that.
///
/// It holds a reference so that the empty slot is all zeros: the control itself then takes no flash.
pub struct Slot<B: 'static>(Mutex<RefCell<Option<&'static mut Control<B>>>>);

impl<B: Board> Slot<B> {
    /// Nothing yet.
    #[expect(clippy::new_without_default, reason = "only ever a static")]
    pub const fn new() -> Self {
        Self(Mutex::new(RefCell::new(None)))
    }

    /// Puts the control in.
    pub fn put(&self, control: &'static mut Control<B>) {
        self.with(|slot| *slot = Some(control));
    }

    /// One control period, if there is a control: to be called from the interrupt.
    #[inline]
    pub fn tick(&self) {
        self.with(|slot| {
            if let Some(control) = slot {
                control.tick();
            }
        });
    }

    #[inline]
    fn with(&self, action: impl FnOnce(&mut Option<&'static mut Control<B>>)) {
        critical_section::with(|section| {
            // Not `borrow_mut`: it could panic. It is never borrowed twice, as nothing nests in `action`.
            if let Ok(mut slot) = self.0.borrow(section).try_borrow_mut() {
                action(&mut slot);
            }
        });
    }
}
