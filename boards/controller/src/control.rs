//! From the start of the image to its idle loop.

use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;
use static_cell::StaticCell;
use strainwave_app::jog::Planner;
use strainwave_app::telemetry::Sender;
use strainwave_app::{Board, Compensator, Control, Slot, Telemetry};

use crate::{Chip, Timer, Watchdog, fault, idle, keys};

/// What a board brings up.
pub struct Parts<B> {
    /// The board as the control sees it.
    pub board: B,
    /// The joint's compensator.
    pub compensator: &'static Compensator,
    /// The interrupts, all of them masked.
    pub interrupts: NVIC,
}

/// Brings a board up; `None`, after saying why, when it is not fit to control a joint.
pub type Start<B> = fn() -> Option<Parts<B>>;

/// Brings the board up by `parts`, hands the control to its interrupt, then reports and plans moves; `port` is the interrupt of the keys.
/// Ends with the drive off where the board is not fit to control a joint.
pub fn run<C: Chip, B: Board>(
    place: &'static StaticCell<Control<B>>,
    slot: &Slot<B>,
    telemetry: &'static mut Telemetry,
    parts: Start<B>,
    port: impl InterruptNumber,
) -> ! {
    let (sender, log) = telemetry.split();
    match start::<C, B>(place, slot, sender, parts, port) {
        Some(mut planner) => idle::run(log, move || planner.plan(keys::target())),
        None => fault::halt::<C>(),
    }
}

// Not inlined: its stack is not the idle loop's.
#[inline(never)]
fn start<C: Chip, B: Board>(
    place: &'static StaticCell<Control<B>>,
    slot: &Slot<B>,
    sender: Sender,
    parts: Start<B>,
    port: impl InterruptNumber,
) -> Option<Planner> {
    let Parts { board, compensator, mut interrupts } = parts()?;
    let planner = idle::planner()?;
    slot.put(place.try_uninit()?.write(Control::new(board, compensator, sender)));
    keys::listen(&mut interrupts, port);
    C::Watchdog::start();
    C::Timer::start(&mut interrupts);
    Some(planner)
}
