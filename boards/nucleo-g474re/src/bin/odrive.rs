//! The joint controller on a Nucleo-G474RE whose joint a controller commands over CAN, and whose drive is an ODrive on a second bus. Wiring only.
//!
//! As `can`, but for the drive: there is no voltage of the torque, and the enable stays low.
//!
//! | pin | on the board | function |
//! | --- | --- | --- |
//! | PA11, PA12 | CN10-14, CN10-12 | FDCAN1 receive, transmit, 1 Mbit/s; a transceiver outside |
//! | PB12, PB13 | CN10-16, CN10-30 | FDCAN2 receive, transmit, 1 Mbit/s, to the ODrive; a transceiver outside |
//! | PA2, PA3 | serial port of the ST-LINK | USART2, 921600 Bd: telemetry (defmt) out |
#![no_std]
#![no_main]

#[path = "../board.rs"]
mod board;
#[path = "../can.rs"]
mod can;
#[path = "../clock.rs"]
mod clock;
#[path = "../behind_node.rs"]
mod drive;
#[path = "../encoder.rs"]
mod encoder;
#[path = "../odrive.rs"]
mod odrive;
#[path = "../serial.rs"]
mod serial;
#[path = "../spi.rs"]
mod spi;

use can::Can;
use clock::G474;
use drive::Drive;
use encoder::Part;
use odrive::Can2;
use stm32g4xx_hal::pac::{Interrupt, interrupt};
use strainwave_controller::strainwave_app::commanded::Odrive;
use strainwave_stm32::fdcan::Bus;
use strainwave_stm32::usart;

strainwave_controller::commanded_controller!(G474, Part, Drive, Bus<Can>, Odrive<Bus<Can2>>, board::start, odrive::start, interrupt TIM2, FDCAN1_IT0, usart::send::<serial::Serial>);
