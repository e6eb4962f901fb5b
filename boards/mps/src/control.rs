//! The control on an emulated board: from the link to the control interrupt.

use crate::link::{self, Link};
use crate::{Machine, fault, stack, timer, uart, watchdog};
use core::marker::PhantomData;
use static_cell::StaticCell;
use strainwave_app::telemetry::Sender;
use strainwave_app::{Compensator, Control, Input, Log, Output, Slot, Telemetry, joint};

/// The emulated board, as the control sees it.
pub struct Board<M> {
    link: Link,
    machine: PhantomData<M>,
}

impl<M: Machine> strainwave_app::Board for Board<M> {
    const REPORT_EVERY: u32 = 1;

    fn input(&mut self, input: &mut Input<f32>) -> bool {
        self.link.input(input)
    }

    // The host finds it in the report.
    fn command(&mut self, _torque: f32) {}

    fn report(&mut self, output: impl FnOnce() -> Output<f32>) {
        self.link.report(&mut output());
    }

    // Nobody is listening any more.
    fn release(&mut self) {}

    fn feed_watchdog(&mut self) {
        watchdog::feed::<M>();
    }

    fn overran(&mut self) -> bool {
        timer::waiting::<M>()
    }
}

/// Takes the joint over: hands the control to its interrupt, then reports from the idle loop until the host closes the link.
///
/// The joint's constants are read in flash, which has no wait states here: they take no RAM.
#[inline]
pub fn start<M: Machine>(
    place: &'static StaticCell<Control<Board<M>>>,
    slot: &'static Slot<Board<M>>,
    telemetry: &'static mut Telemetry,
) -> ! {
    let (sender, log) = telemetry.split();
    let (board, compensator) = prepare();
    put(place, slot, board, compensator, sender);
    idle::<M>(log, || ())
}

/// The board and its joint's compensator; without one of them the image ends, after saying why.
// Always inlined: a call of its own costs the image 40 bytes.
#[inline(always)]
pub(crate) fn prepare<M: Machine>() -> (Board<M>, &'static Compensator) {
    uart::enable::<M>();
    let Some(link) = Link::open() else {
        defmt::error!("sensors.fifo or command.fifo does not open");
        fault::fail();
    };
    let board = Board { link, machine: PhantomData };
    match Compensator::from_words(&joint::WORDS) {
        Ok(compensator) => return (board, compensator),
        Err(bad) => defmt::error!("joint {=str}: {=str}", joint::GEAR, bad.reason()),
    }
    fault::fail()
}

fn put<M: Machine>(
    place: &'static StaticCell<Control<Board<M>>>,
    slot: &'static Slot<Board<M>>,
    board: Board<M>,
    compensator: &'static Compensator,
    sender: Sender,
) {
    if let Some(place) = place.try_uninit() {
        slot.put(place.write(Control::new(board, compensator, sender)));
    }
}

/// Starts the control, and reports and does what else there is to do in each period until the host closes the link.
pub(crate) fn idle<M: Machine>(mut log: Log, mut work: impl FnMut()) -> ! {
    watchdog::start::<M>();
    timer::start::<M>();
    while !link::ended() {
        log.drain();
        work();
        cortex_m::asm::wfi();
    }
    watchdog::stop::<M>();
    log.drain();
    defmt::info!("stack {=usize} dropped {=u32}", stack::high_water_mark(), log.dropped());
    if link::failed() { fault::fail() } else { fault::succeed() }
}
