//! The joint controller on a Raspberry Pi Pico 2 with its tuning link. Wiring only.
//!
//! As `main`, but for the serial port and the joint's target: the joint holds the position in which it starts, and the one that it has after a
//! reset over the link. There is no store: the flash is a chip of its own, which the boot ROM would write.
//!
//! | pin | on the board | function |
//! | --- | --- | --- |
//! | GP0, GP1 | 1, 2 | UART0, 921600 Bd: the tuning link |
#![no_std]
#![no_main]

#[path = "../board.rs"]
mod board;
#[path = "../boot.rs"]
mod boot;
#[path = "../chip.rs"]
mod chip;
#[path = "../clock.rs"]
mod clock;
#[path = "../drive.rs"]
mod drive;
#[path = "../encoder.rs"]
mod encoder;
#[path = "../line.rs"]
mod line;
#[path = "../pins.rs"]
mod pins;
#[path = "../serial.rs"]
mod serial;
#[path = "../spi.rs"]
mod spi;
#[path = "../timer.rs"]
mod timer;
#[path = "../watchdog.rs"]
mod watchdog;

use cortex_m_rt::exception;
use line::Fifo;
use rp235x_pac::{Interrupt, interrupt};
use strainwave_controller::served::{NoFlash, Service};

fn service() -> Service<Fifo, NoFlash> {
    Service { line: Fifo::begin(), store: None, writes_beside: true }
}

strainwave_controller::served_controller!(
    chip::Rp2350,
    board::Board,
    board::start,
    service,
    exception SysTick,
    UART0_IRQ,
    line::serve,
    serial::send
);
