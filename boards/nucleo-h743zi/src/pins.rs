//! The pins, as the table in `main` has them (ST RM0433, chapter 11).
//!
//! Here as a whole: there is no HAL that hands them out one by one without the clocks that it would set up itself.

use core::convert::Infallible;
use embedded_hal::digital::{ErrorType, OutputPin};
use stm32h7::stm32h743v::{GPIOA, GPIOB, GPIOD};

/// Gives each pin its function. The drive is disabled, the encoder not selected.
pub fn start(a: &GPIOA, b: &GPIOB, d: &GPIOD) {
    analog_and_encoder(a);
    encoder_and_enable(b);
    select_and_serial(d);
}

/// PA4 analog; PA5 and PA6 the encoder's clock and MISO.
fn analog_and_encoder(port: &GPIOA) {
    // Slow edges end at 12 MHz.
    port.ospeedr().modify(|_, w| w.ospeedr5().medium_speed());
    // A line that nobody drives reads as ones, not as an angle of zero.
    port.pupdr().modify(|_, w| w.pupdr6().pull_up());
    port.afrl().modify(|_, w| w.afr5().af5().afr6().af5());
    port.moder().modify(|_, w| w.moder4().analog().moder5().alternate().moder6().alternate());
}

/// PB5 the encoder's MOSI; PB1 the drive's enable.
fn encoder_and_enable(port: &GPIOB) {
    port.ospeedr().modify(|_, w| w.ospeedr5().medium_speed());
    port.afrl().modify(|_, w| w.afr5().af5());
    port.bsrr().write(|w| w.br1().set_bit());
    port.moder().modify(|_, w| w.moder1().output().moder5().alternate());
}

/// PD14 the encoder's select; PD8 and PD9 the USART.
fn select_and_serial(port: &GPIOD) {
    port.pupdr().modify(|_, w| w.pupdr9().pull_up());
    port.afrh().modify(|_, w| w.afr8().af7().afr9().af7());
    port.bsrr().write(|w| w.bs14().set_bit());
    port.moder().modify(|_, w| w.moder8().alternate().moder9().alternate().moder14().output());
}

/// The encoder's select.
pub struct Select(GPIOD);

impl Select {
    /// On its port, which [`start`] has set up.
    pub fn new(port: GPIOD) -> Self {
        Self(port)
    }
}

impl ErrorType for Select {
    type Error = Infallible;
}

impl OutputPin for Select {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.bsrr().write(|w| w.br14().set_bit());
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.bsrr().write(|w| w.bs14().set_bit());
        Ok(())
    }
}
