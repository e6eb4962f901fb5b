//! The joint controller on Arm's MPS2+ AN386, emulated by QEMU. Wiring only.
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
use strainwave_app::{Control, Error, Log, Slot, Telemetry};

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
    match Control::new(Board::new(link), sender) {
        Ok(control) => run(control, log),
        Err(Error::OutOfRange(name)) => defmt::error!("joint: {=str} is out of range", name),
    }
    fault::fail()
}

/// Hands the control to its interrupt, then reports from the idle loop until the host closes the link.
fn run(control: Control<Board>, mut log: Log) -> ! {
    if let Some(place) = CONTROL.try_uninit() {
        SLOT.put(place.write(control));
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
