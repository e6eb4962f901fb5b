//! The pins, as the table in `main` has them (RP2350 datasheet, 3.1, 9.4 and 9.11).

use core::convert::Infallible;
use embedded_hal::digital::{ErrorType, OutputPin};
use rp235x_pac::io_bank0::gpio::gpio_ctrl::FUNCSEL_A as Function;
use rp235x_pac::{IO_BANK0, PADS_BANK0, SIO};

/// Telemetry and keys.
const TELEMETRY: usize = 0;
const KEYS: usize = 1;
/// Drive's enable.
const ENABLE: u8 = 14;
/// Torque command.
const TORQUE: usize = 15;
/// Encoder: MISO, select, clock, MOSI.
const MISO: usize = 16;
const SELECT: u8 = 17;
const CLOCK: usize = 18;
const MOSI: usize = 19;

/// The outputs that the firmware switches itself.
pub struct Pins {
    /// Drive's enable.
    pub enable: Output<ENABLE>,
    /// Encoder's select.
    pub select: Output<SELECT>,
}

/// Gives each pin its function. The drive is disabled, the encoder not selected.
pub fn start(functions: &IO_BANK0, pads: &PADS_BANK0, outputs: &SIO) -> Pins {
    let mut pins = Pins { enable: Output(()), select: Output(()) };
    pins.enable.clear();
    pins.select.set();
    // SAFETY: two outputs of their own bits.
    outputs.gpio_oe_set().write(|w| unsafe { w.bits(bit(ENABLE) | bit(SELECT)) });
    let connect = |pin: usize, function| {
        functions.gpio(pin).gpio_ctrl().write(|w| w.funcsel().variant(function));
        // Isolated until here: the pin has its function first.
        pads.gpio(pin).modify(|_, w| w.ie().set_bit().od().clear_bit().iso().clear_bit());
    };
    // A line that nobody drives reads as ones: the serial port is idle, and an angle is not zero.
    let pull_up = |pin: usize| pads.gpio(pin).modify(|_, w| w.pde().clear_bit().pue().set_bit());
    [KEYS, MISO].iter().for_each(|pin| pull_up(*pin));
    [TELEMETRY, KEYS].iter().for_each(|pin| connect(*pin, Function::UART));
    [ENABLE, SELECT].iter().for_each(|pin| connect(usize::from(*pin), Function::SIO));
    [MISO, CLOCK, MOSI].iter().for_each(|pin| connect(*pin, Function::SPI));
    connect(TORQUE, Function::PWM);
    pins
}

const fn bit(pin: u8) -> u32 {
    1 << pin
}

/// An output that is switched by itself.
pub struct Output<const PIN: u8>(());

impl<const PIN: u8> Output<PIN> {
    /// Takes it high.
    pub fn set(&mut self) {
        // SAFETY: `start` has made the output one of SIO's; the register changes its bit alone, whoever else writes it.
        unsafe { (*SIO::ptr()).gpio_out_set().write(|w| w.bits(bit(PIN))) };
    }

    /// Takes it low.
    pub fn clear(&mut self) {
        // SAFETY: as above.
        unsafe { (*SIO::ptr()).gpio_out_clr().write(|w| w.bits(bit(PIN))) };
    }
}

impl<const PIN: u8> ErrorType for Output<PIN> {
    type Error = Infallible;
}

impl<const PIN: u8> OutputPin for Output<PIN> {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.clear();
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.set();
        Ok(())
    }
}

/// The pin of the drive's enable.
pub type Enable = Output<ENABLE>;
/// The pin of the encoder's select.
pub type Select = Output<SELECT>;
