//! The joint controller on an STM32F405RG with its tuning link, and a store in its flash. Wiring only.
//!
//! As `main`, but for the serial port and the joint's target: the joint holds the position in which it starts, and the one that it has after a
//! reset over the link.
//!
//! | pin | function |
//! | --- | --- |
//! | PA9, PA10 | USART1, 921600 Bd: the tuning link |
#![no_std]
#![no_main]

#[path = "../board.rs"]
mod board;
#[path = "../clock.rs"]
mod clock;
#[path = "../drive.rs"]
mod drive;
#[path = "../encoder.rs"]
mod encoder;
#[path = "../line.rs"]
mod line;
#[path = "../serial.rs"]
mod serial;
#[path = "../store.rs"]
mod store;

use clock::F405;
use line::Dma;
use stm32f4xx_hal::pac::{Interrupt, interrupt};
use strainwave_controller::served::Service;
use strainwave_stm32::flash::{self, Flash};

fn service() -> Service<Dma, Flash<F405>> {
    flash::service(Dma::begin())
}

strainwave_controller::served_controller!(F405, board::Board, board::start, service, interrupt TIM2, USART1, line::serve, serial::send);
