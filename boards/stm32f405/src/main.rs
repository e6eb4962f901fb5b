//! The joint controller on an STM32F405RG at 168 MHz. Wiring only.
//!
//! | pin | function |
//! | --- | --- |
//! | PA5, PA6, PA7, PB6 | motor encoder MT6835: SPI1 clock, MISO, MOSI, select |
//! | PA4 | torque command to the motor's drive: 0..3.3 V, 1.65 V is none, the rails are the peak torque |
//! | PB0 | drive enable, high while the joint is controlled; pull it down outside |
//! | PA9, PA10 | USART1, 921600 Bd: telemetry (defmt) out, operator's keys in |
//! | PH0, PH1 | 8 MHz crystal |
//!
//! The encoder's count has to grow with a positive torque command. The drive has a current loop of
//! its own, so the motor's torque is taken to be the last command. The joint holds the position in which it
//! starts; `+` and `-` on the USART move its target by 10 mrad at the output, `0` moves it back.
#![no_std]
#![no_main]

mod board;
mod clock;
mod drive;
mod encoder;
mod fault;
mod joint;
mod logger;
mod serial;
mod timer;
mod watchdog;

use board::{Board, Hardware};
use static_cell::StaticCell;
use stm32f4xx_hal::pac::interrupt;
use strainwave_app::jog::Planner;
use strainwave_app::telemetry::Sender;
use strainwave_app::{Compensator, Control, Log, Slot, Telemetry};

static CONTROL: StaticCell<Control<Board>> = StaticCell::new();
static SLOT: Slot<Board> = Slot::new();

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut TELEMETRY: Telemetry = Telemetry::new();
    let (sender, log) = TELEMETRY.split();
    match board::start() {
        Some((board, planner, compensator, hardware)) => {
            run(board, planner, compensator, hardware, sender, log)
        }
        None => fault::halt(),
    }
}

/// Hands the control to its interrupt, then reports and plans moves in the idle loop.
fn run(
    board: Board,
    mut planner: Planner,
    compensator: &'static Compensator,
    mut hardware: Hardware,
    sender: Sender,
    mut log: Log,
) -> ! {
    if let Some(place) = CONTROL.try_uninit() {
        SLOT.put(place.write(Control::new(board, compensator, sender)));
    }
    serial::listen(&mut hardware.interrupts);
    watchdog::start(&hardware.watchdog);
    timer::start(&hardware.timer, &mut hardware.interrupts);
    let mut warned = false;
    loop {
        log.drain();
        planner.plan(serial::target());
        if encoder::lost() && !warned {
            defmt::error!("motor encoder lost: the drive is released until the next reset");
            warned = true;
        }
        cortex_m::asm::wfi();
    }
}

/// The 10 kHz interrupt.
#[interrupt]
fn TIM2() {
    timer::acknowledge();
    SLOT.tick();
}

/// A key from the operator.
#[interrupt]
fn USART1() {
    serial::receive();
}
