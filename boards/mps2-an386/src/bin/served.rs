//! The joint controller on the emulated board with its tuning link at the second UART, and a store in a file of the host. Wiring only.
#![no_std]
#![no_main]

#[path = "../machine.rs"]
mod machine;

use machine::An386;
use strainwave_app::served::{Exchange, Served};
use strainwave_app::{Control, Slot, Telemetry};
use strainwave_mps::serial::Tunable;
use strainwave_mps::static_cell::StaticCell;
use strainwave_mps::{Board, Machine, Uart, served, timer, uart};

// SAFETY: the address is that of UART 1, which nothing else uses.
unsafe impl Tunable for An386 {
    const TUNING: Uart = Uart { address: 0x4000_5000 };
}

static EXCHANGE: Exchange = Exchange::new();
static CONTROL: StaticCell<Control<Served<Board<An386>>>> = StaticCell::new();
static SLOT: Slot<Served<Board<An386>>> = Slot::new();

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut TELEMETRY: Telemetry = Telemetry::new();
    served::start::<An386>(&CONTROL, &SLOT, TELEMETRY, &EXCHANGE)
}

/// The 10 kHz interrupt.
extern "C" fn control_interrupt() {
    timer::acknowledge::<An386>();
    SLOT.tick();
}

strainwave_mps::vectors!(<An386 as Machine>::TIMER.interrupt(), control_interrupt);
strainwave_app::global_logger!(uart::send::<An386>);
