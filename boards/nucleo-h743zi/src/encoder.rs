//! The motor encoder on SPI1.

use stm32h7::stm32h743v::{GPIOD, SPI1};
use strainwave_controller::MotorEncoder;
use strainwave_controller::spi::Bus;
use strainwave_drivers::SpiEncoder;

use crate::clock::{self, H743};
use crate::pins::Select;
use crate::spi::{DIVIDER, Spi};

// 100 MHz / 8 = 12.5 MHz: 5 us for an angle with its pauses.
const _: () = assert!(clock::SPI / DIVIDER <= Part::FASTEST);

/// The encoder on the board.
pub type Part = strainwave_controller::Part<H743, Bus<Spi>, Select>;

/// The encoder, if it answers and its magnet is where it should be; else says what is wrong.
pub fn start(spi: SPI1, select: GPIOD) -> Option<MotorEncoder<Part>> {
    let bus = Bus::new(Spi::new(spi, Part::MODE));
    MotorEncoder::on(bus, Select::new(select))
}
