//! The motor encoder on SPI0.

use rp235x_pac::SPI0;
use strainwave_controller::MotorEncoder;
use strainwave_controller::spi::Bus;
use strainwave_drivers::SpiEncoder;

use crate::chip::Rp2350;
use crate::clock::FULL;
use crate::pins::Select;
use crate::spi::{DIVIDER, Spi};

// 150 MHz / 12 = 12.5 MHz: 5 us for an angle with its pauses.
const _: () = assert!(FULL / DIVIDER as u32 <= Part::FASTEST);

/// The encoder on the board.
pub type Part = strainwave_controller::Part<Rp2350, Bus<Spi>, Select>;

/// The encoder, if it answers and its magnet is where it should be; else says what is wrong.
pub fn start(spi: SPI0, select: Select) -> Option<MotorEncoder<Part>> {
    MotorEncoder::on(Bus::new(Spi::new(spi, Part::MODE)), select)
}
