//! A control that the tuning link serves: a board around a board, which takes its orders, and the joint that the link sees.
//!
//! [`Served`] runs in the control interrupt. It takes the order that waits in the [`Exchange`] where its step needs it: a reset before the step, gains
//! with the step's input, a reading out of its report. [`ServedJoint`] runs in the idle loop and writes the store there. Neither waits for the other:
//! an order or an answer, 40 words at most, is copied with interrupts masked.
//!
//! An order but a reset is taken by a step only: without sensors it stays, and the link tells so.
//!
//! A flash whose writing holds the control up is written with interrupts masked, and only while the drive is off: the control cannot switch it on
//! meanwhile. It then misses its periods, each write or erasure by itself; the board's flash sees to the watchdog.

use core::cell::Cell;
use core::ffi::CStr;
use core::ops::Range;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use critical_section::Mutex;
use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};
use strainwave::compensator::adapt::learning::Learnt;
use strainwave::compensator::words::{LAYOUT, LEARNT_LAYOUT, LEARNT_WORDS, identity};
use strainwave_service::store::{self, Owner, Store};
use strainwave_service::tuning::{Answer, Hello, Joint, Order, Reading, StoreState, Trial};

use crate::control::RATE;
use crate::{Board, Input, Output, joint};

/// Bytes of the flash that an emulated board has in a file of the host, two pages, and the file's name in the emulator's folder.
pub const STORE_BYTES: usize = 8192;
/// See [`STORE_BYTES`].
pub const STORE_FILE: &CStr = c"store.bin";

/// Between the control and its link.
pub struct Exchange {
    order: Mutex<Cell<Option<Order>>>,
    answer: Mutex<Cell<Option<Answer>>>,
    periods: AtomicU32,
    drives: AtomicBool,
}

impl Exchange {
    /// Without an order.
    #[expect(clippy::new_without_default, reason = "only ever a static")]
    pub const fn new() -> Self {
        Self {
            order: Mutex::new(Cell::new(None)),
            answer: Mutex::new(Cell::new(None)),
            periods: AtomicU32::new(0),
            drives: AtomicBool::new(false),
        }
    }

    /// Leaves an order; false when the last one has not been taken.
    fn leave(&self, order: Order) -> bool {
        critical_section::with(|section| {
            let place = self.order.borrow(section);
            let free = place.get().is_none();
            if free {
                place.set(Some(order));
            }
            free
        })
    }

    /// Takes the order, if it is one that `wanted` wants.
    fn take(&self, wanted: impl FnOnce(&Order) -> bool) -> Option<Order> {
        critical_section::with(|section| {
            let place = self.order.borrow(section);
            let order = place.get().filter(wanted);
            if order.is_some() {
                place.set(None);
            }
            order
        })
    }

    fn give(&self, answer: Answer) {
        critical_section::with(|section| self.answer.borrow(section).set(Some(answer)));
    }

    fn answer(&self) -> Option<Answer> {
        critical_section::with(|section| self.answer.borrow(section).take())
    }

    /// The drive was commanded in the last period.
    fn drives(&self) -> bool {
        self.drives.load(Ordering::Relaxed)
    }
}

/// A board whose control takes orders.
pub struct Served<B> {
    board: B,
    exchange: &'static Exchange,
    trial: Trial,
    /// Order of this period's step.
    order: Option<Order>,
}

impl<B> Served<B> {
    /// The board as the control sees it.
    pub fn new(board: B, exchange: &'static Exchange) -> Self {
        Self { board, exchange, trial: Trial::NONE, order: None }
    }
}

impl<B: Board> Board for Served<B> {
    const REPORT_EVERY: u32 = B::REPORT_EVERY;

    fn input(&mut self, input: &mut Input<f32>) -> bool {
        if !self.board.input(input) {
            return false;
        }
        self.order = self.exchange.take(|order| *order != Order::Reset);
        if let Some(Order::Try(trial)) = self.order {
            self.trial = trial;
        }
        input.gains = self.trial.in_place_of(input.gains);
        true
    }

    fn command(&mut self, torque: f32) {
        self.exchange.drives.store(true, Ordering::Relaxed);
        self.board.command(torque);
    }

    fn report(&mut self, output: impl FnOnce() -> Output<f32>) {
        if self.order != Some(Order::Read) {
            return self.board.report(output);
        }
        let output = output();
        let period = self.exchange.periods.load(Ordering::Relaxed);
        self.exchange.give(Answer::Reading(Reading::new(period, &output)));
        self.board.report(|| output);
    }

    fn learnt(&mut self, learnt: impl FnOnce() -> Learnt<f32>) {
        if self.order == Some(Order::Learnt) {
            self.exchange.give(Answer::Learnt(learnt()));
        }
    }

    fn release(&mut self) {
        self.exchange.drives.store(false, Ordering::Relaxed);
        self.board.release();
    }

    fn feed_watchdog(&mut self) {
        self.board.feed_watchdog();
    }

    fn overran(&mut self) -> bool {
        self.board.overran()
    }

    fn restarted(&self) -> bool {
        self.board.restarted()
    }

    fn reset_requested(&mut self) -> bool {
        // The interrupt is the only writer: a load and a store make no race.
        let periods = self.exchange.periods.load(Ordering::Relaxed).wrapping_add(1);
        self.exchange.periods.store(periods, Ordering::Relaxed);
        let ordered = self.exchange.take(|order| *order == Order::Reset).is_some();
        self.board.reset_requested() || ordered
    }

    fn reset(&mut self) {
        self.board.reset();
    }
}

/// A flash that is written while the drive is off, unless that does not hold the control up.
struct Guarded<F> {
    flash: F,
    exchange: &'static Exchange,
    writes_beside: bool,
}

impl<F: NorFlash> Guarded<F> {
    fn change(
        &mut self,
        change: impl FnOnce(&mut F) -> Result<(), F::Error>,
    ) -> Result<(), NorFlashErrorKind> {
        let changed = || change(&mut self.flash).map_err(|error| error.kind());
        if self.writes_beside {
            return changed();
        }
        // The control could switch the drive on.
        critical_section::with(
            |_| if self.exchange.drives() { Err(NorFlashErrorKind::Other) } else { changed() },
        )
    }
}

impl<F> ErrorType for Guarded<F> {
    type Error = NorFlashErrorKind;
}

impl<F: NorFlash> ReadNorFlash for Guarded<F> {
    const READ_SIZE: usize = F::READ_SIZE;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        self.flash.read(offset, bytes).map_err(|error| error.kind())
    }

    fn capacity(&self) -> usize {
        self.flash.capacity()
    }
}

impl<F: NorFlash> NorFlash for Guarded<F> {
    const WRITE_SIZE: usize = F::WRITE_SIZE;
    const ERASE_SIZE: usize = F::ERASE_SIZE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        self.change(|flash| flash.erase(from, to))
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        self.change(|flash| flash.write(offset, bytes))
    }
}

/// The joint as its link sees it, with a store in a flash of the board.
pub struct ServedJoint<F> {
    exchange: &'static Exchange,
    store: Option<Store<Guarded<F>, LEARNT_WORDS>>,
    /// Writing the flash does not hold the control up.
    writes_beside: bool,
}

impl<F: NorFlash> ServedJoint<F> {
    /// With a store in a region of a flash, if the board has one; `writes_beside` tells that writing it does not hold the control up.
    pub fn new(exchange: &'static Exchange, flash: Option<(F, Range<u32>)>, writes_beside: bool) -> Self {
        let owner = Owner { layout: LEARNT_LAYOUT, joint: identity(&joint::WORDS) };
        // A region that does not fit is no store.
        let store = flash.and_then(|(flash, region)| {
            Store::new(Guarded { flash, exchange, writes_beside }, region, owner).ok()
        });
        Self { exchange, store, writes_beside }
    }

    /// What was learnt before, for the control to start from.
    pub fn learnt_before(&mut self) -> Option<Learnt<f32>> {
        self.stored().ok().map(|(_, learnt)| learnt)
    }
}

/// State of a store that gives this error.
fn state_of(error: store::Error) -> StoreState {
    match error {
        store::Error::Layout => StoreState::OtherLayout,
        store::Error::Joint => StoreState::OtherJoint,
        store::Error::Region | store::Error::Flash => StoreState::Broken,
    }
}

impl<F: NorFlash> Joint for ServedJoint<F> {
    fn hello(&mut self) -> Hello {
        let store = self.stored().map_or_else(|state| state, |_| StoreState::Sound);
        Hello {
            gear: Hello::name(joint::GEAR),
            layout: LAYOUT,
            joint: identity(&joint::WORDS),
            rate: RATE,
            store,
        }
    }

    fn now(&self) -> u32 {
        self.exchange.periods.load(Ordering::Relaxed)
    }

    fn order(&mut self, order: Order) -> bool {
        self.exchange.leave(order)
    }

    fn answer(&mut self) -> Option<Answer> {
        self.exchange.answer()
    }

    fn may_write(&self) -> bool {
        self.writes_beside || !self.exchange.drives()
    }

    fn stored(&mut self) -> Result<(u32, Learnt<f32>), StoreState> {
        let store = self.store.as_mut().ok_or(StoreState::Missing)?;
        let record = store.read().map_err(state_of)?.ok_or(StoreState::Empty)?;
        Ok((record.sequence, Learnt::from_words(&record.words)))
    }

    fn keep(&mut self, learnt: &Learnt<f32>) -> Result<u32, StoreState> {
        let store = self.store.as_mut().ok_or(StoreState::Missing)?;
        store.write(&learnt.to_words()).map_err(state_of)
    }

    fn erase(&mut self) -> Result<(), StoreState> {
        let store = self.store.as_mut().ok_or(StoreState::Missing)?;
        store.erase().map_err(state_of)
    }
}
