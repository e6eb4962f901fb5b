//! The joint controller on a Nucleo-H743ZI2 with its tuning link, and a store in its flash. Wiring only.
//!
//! As `main`, but for the serial port and the joint's target: the joint holds the position in which it starts, and the one that it has after a
//! reset over the link.
//!
//! | pin | on the board | function |
//! | --- | --- | --- |
//! | PD8, PD9 | serial port of the ST-LINK | USART3, 921600 Bd: the tuning link |
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
#[path = "../pins.rs"]
mod pins;
#[path = "../serial.rs"]
mod serial;
#[path = "../spi.rs"]
mod spi;
#[path = "../store.rs"]
mod store;

use clock::H743;
use serial::Serial;
use stm32h7::stm32h743v::{Interrupt, interrupt};
use strainwave_controller::served::Service;
use strainwave_stm32::flash::{self, Flash};
use strainwave_stm32::linked::{self, Linked};
use strainwave_stm32::usart;

fn service() -> Service<Linked<Serial>, Flash<H743>> {
    flash::service(Linked::begin())
}

strainwave_controller::served_controller!(H743, board::Board, board::start, service, interrupt TIM2, USART3, linked::serve::<Serial>, usart::send::<Serial>);
