//! The motor encoder on SPI1.

use stm32f4xx_hal::gpio::{Output, PA5, PA6, PA7, PB6, PinState, Speed};
use stm32f4xx_hal::pac::SPI1;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::spi::Spi;
use stm32f4xx_hal::time::Hertz;
use strainwave_controller::MotorEncoder;
use strainwave_drivers::SpiEncoder;

use crate::clock::{F405, FULL, INTERNAL, PERIPHERAL_DIVISOR};

/// SPI1's clock divider: 84 MHz / 8 = 10.5 MHz, 6 us for an angle with its pauses.
const DIVIDER: u32 = 8;
const _: () = assert!(FULL / PERIPHERAL_DIVISOR / DIVIDER <= Part::FASTEST);

/// The encoder on the board.
pub type Part = strainwave_controller::Part<F405, Spi<SPI1>, PB6<Output>>;

/// The encoder, if it answers and its magnet is where it should be; else says what is wrong.
pub fn start(spi: SPI1, pins: (PA5, PA6, PA7), select: PB6, rcc: &mut Rcc) -> Option<MotorEncoder<Part>> {
    let select = select.into_push_pull_output_in_state(PinState::High);
    let (clock, miso, mosi) = pins;
    // Slow edges end at 2 to 8 MHz.
    let clock = clock.into_alternate().speed(Speed::High);
    let mosi = mosi.into_alternate().speed(Speed::High);
    // A line that nobody drives reads as ones, not as an angle of zero.
    let miso = miso.into_alternate().internal_pull_up(true);
    // The HAL assumes 16 MHz: this gives the right divider.
    let frequency = Hertz::from_raw(INTERNAL / DIVIDER);
    let bus = Spi::new(spi, (Some(clock), Some(miso), Some(mosi)), Part::MODE, frequency, rcc);
    MotorEncoder::on(bus, select)
}
