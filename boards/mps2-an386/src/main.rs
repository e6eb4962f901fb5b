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

use core::cell::RefCell;
use cortex_m_semihosting::debug;
use critical_section::Mutex;
use link::{Board, Link};
use strainwave_app::{Control, Log, Telemetry};

static CONTROL: Mutex<RefCell<Option<Control<Board>>>> = Mutex::new(RefCell::new(None));

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut TELEMETRY: Telemetry = Telemetry::new();
    let (sender, log) = TELEMETRY.split();
    uart::enable();
    match Link::open().map(|link| Control::new(Board::new(link), sender)) {
        Some(Ok(control)) => run(control, log),
        Some(Err(strainwave_app::Error::OutOfRange(name))) => {
            defmt::error!("joint: {=str} is out of range", name)
        }
        None => defmt::error!("sensors.fifo or command.fifo does not open"),
    }
    fault::exit(debug::EXIT_FAILURE)
}

/// Hands the control to its interrupt, then reports from the idle loop until the host closes the link.
fn run(control: Control<Board>, mut log: Log) -> ! {
    with_control(|slot| *slot = Some(control));
    watchdog::start();
    timer::start();
    while !link::ended() {
        log.drain();
        cortex_m::asm::wfi();
    }
    watchdog::stop();
    log.drain();
    defmt::info!("stack {=usize} dropped {=u32}", stack::high_water_mark(), log.dropped());
    fault::exit(if link::failed() { debug::EXIT_FAILURE } else { debug::EXIT_SUCCESS })
}

/// The 10 kHz interrupt.
extern "C" fn control_interrupt() {
    timer::acknowledge();
    with_control(|slot| {
        if let Some(control) = slot {
            control.tick();
        }
    });
}

/// The control, which `run` puts in place before the timer starts and only the interrupt uses after that.
fn with_control(action: impl FnOnce(&mut Option<Control<Board>>)) {
    critical_section::with(|section| {
        // Not `borrow_mut`: it could panic. It is never borrowed twice, as nothing nests in `action`.
        if let Ok(mut slot) = CONTROL.borrow(section).try_borrow_mut() {
            action(&mut slot);
        }
    });
}
