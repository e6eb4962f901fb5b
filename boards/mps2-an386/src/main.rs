//! The joint controller on Arm's MPS2+ AN386, emulated by QEMU. Wiring only.
//!
//! The joint's constants are read in flash, which has no wait states here: they take no RAM.
#![no_std]
#![no_main]

mod fault;
mod link;
mod logger;
mod register;
mod stack;
mod timer;
mod uart;
mod vectors;
mod watchdog;

use link::{Board, Link};
use static_cell::StaticCell;
use strainwave_app::telemetry::Sender;
use strainwave_app::{Compensator, Control, Log, Slot, Telemetry, joint};

static CONTROL: StaticCell<Control<Board>> = StaticCell::new();
static SLOT: Slot<Board> = Slot::new();

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut TELEMETRY: Telemetry = Telemetry::new();
    let (sender, log) = TELEMETRY.split();
    uart::enable();
    let Some(link) = Link::open() else {
        defmt::error!("sensors.fifo or command.fifo does not open");
        fault::fail();
    };
    match Compensator::from_words(&joint::WORDS) {
        Ok(compensator) => run(Board::new(link), compensator, sender, log),
        Err(bad) => defmt::error!("joint {=str}: {=str}", joint::GEAR, bad.reason()),
    }
    fault::fail()
}

/// Hands the control to its interrupt, then reports from the idle loop until the host closes the link.
fn run(board: Board, compensator: &'static Compensator, sender: Sender, mut log: Log) -> ! {
    if let Some(place) = CONTROL.try_uninit() {
        SLOT.put(place.write(Control::new(board, compensator, sender)));
    }
    watchdog::start();
    timer::start();
    while !link::ended() {
        log.drain();
        cortex_m::asm::wfi();
    }
    watchdog::stop();
    log.drain();
    defmt::info!("stack {=usize} dropped {=u32}", stack::high_water_mark(), log.dropped());
    if link::failed() { fault::fail() } else { fault::succeed() }
}

/// The 10 kHz interrupt.
extern "C" fn control_interrupt() {
    timer::acknowledge();
    SLOT.tick();
}
