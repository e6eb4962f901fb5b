//! The motor encoder on SPI1.

use stm32g4xx_hal::gpio::{Output, PA5, PA6, PA7, PB6, PinState, Pull, Speed};
use stm32g4xx_hal::pac::SPI1;
use stm32g4xx_hal::rcc::Rcc;
use strainwave_controller::MotorEncoder;
use strainwave_controller::spi::Bus;
use strainwave_drivers::SpiEncoder;

use crate::clock::{FULL, G474};
use crate::spi::{DIVIDER, Spi};

// 170 MHz / 16 = 10.6 MHz: 6 us for an angle with its pauses.
const _: () = assert!(FULL / DIVIDER <= Part::FASTEST);

/// The encoder on the board.
pub type Part = strainwave_controller::Part<G474, Bus<Spi>, PB6<Output>>;

/// The encoder, if it answers and its magnet is where it should be; else says what is wrong.
pub fn start(spi: SPI1, pins: (PA5, PA6, PA7), select: PB6, rcc: &mut Rcc) -> Option<MotorEncoder<Part>> {
    let select = select.into_push_pull_output_in_state(PinState::High);
    let (clock, miso, mosi) = pins;
    // Slow edges end at 5 MHz.
    let clock = clock.into_alternate().speed(Speed::High);
    let mosi = mosi.into_alternate().speed(Speed::High);
    // A line that nobody drives reads as ones, not as an angle of zero.
    let miso = miso.into_alternate().internal_resistor(Pull::Up);
    let spi = Spi::new(spi, (clock, miso, mosi), Part::MODE, rcc);
    MotorEncoder::on(Bus::new(spi), select)
}
