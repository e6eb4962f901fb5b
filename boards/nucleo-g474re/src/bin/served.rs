//! The joint controller on a Nucleo-G474RE with its tuning link, and a store in its flash. Wiring only.
//!
//! As `main`, but for the serial port and the joint's target: the joint holds the position in which it starts, and the one that it has after a
//! reset over the link.
//!
//! | pin | on the board | function |
//! | --- | --- | --- |
//! | PA2, PA3 | serial port of the ST-LINK | USART2, 921600 Bd: the tuning link |
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
#[path = "../serial.rs"]
mod serial;
#[path = "../spi.rs"]
mod spi;
#[path = "../store.rs"]
mod store;

use clock::G474;
use serial::Serial;
use stm32g4xx_hal::pac::{Interrupt, interrupt};
use strainwave_controller::served::Service;
use strainwave_stm32::flash::{self, Flash};
use strainwave_stm32::linked::{self, Linked};
use strainwave_stm32::usart;

fn service() -> Service<Linked<Serial>, Flash<G474>> {
    flash::service(Linked::begin())
}

strainwave_controller::served_controller!(G474, board::Board, board::start, service, interrupt TIM2, USART2, linked::serve::<Serial>, usart::send::<Serial>);
