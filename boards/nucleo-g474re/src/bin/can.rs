//! The joint controller on a Nucleo-G474RE whose joint a controller commands over CAN. Wiring only.
//!
//! As `main`, but for the joint's target: the joint is off until it is switched on over the bus. There are no keys.
//!
//! | pin | on the board | function |
//! | --- | --- | --- |
//! | PA11, PA12 | CN10-14, CN10-12 | FDCAN1 receive, transmit, 1 Mbit/s; a transceiver outside |
//! | PA2, PA3 | serial port of the ST-LINK | USART2, 921600 Bd: telemetry (defmt) out |
#![no_std]
#![no_main]

#[path = "../board.rs"]
mod board;
#[path = "../can.rs"]
mod can;
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

use can::Can;
use clock::G474;
use drive::Drive;
use encoder::Part;
use stm32g4xx_hal::pac::{Interrupt, interrupt};
use strainwave_controller::strainwave_app::commanded::Wired;
use strainwave_stm32::fdcan::Bus;
use strainwave_stm32::usart;

strainwave_controller::commanded_controller!(G474, Part, Drive, Bus<Can>, Wired, board::start, can::start, interrupt TIM2, FDCAN1_IT0, usart::send::<serial::Serial>);
