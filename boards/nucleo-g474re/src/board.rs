//! The board's parts put together.

use crate::clock::{self, G474};
use crate::drive::Drive;
use crate::encoder::{self, Part};
use crate::serial;
use stm32g4xx_hal::gpio::GpioExt;
use stm32g4xx_hal::pac::{Peripherals, TIM2};
use stm32g4xx_hal::rcc::{Enable, RccExt};
use strainwave_controller::control::Parts;
use strainwave_controller::joint;
use strainwave_stm32::reset;

/// The board as the control sees it.
pub type Board = strainwave_controller::Board<G474, Part, Drive>;

/// Brings the board up; `None`, after saying why, when it is not fit to control a joint.
pub fn start() -> Option<Parts<Board>> {
    let device = Peripherals::take()?;
    let core = cortex_m::Peripherals::take()?;
    let mut rcc = device.RCC.constrain();
    let restarted = reset::by_itself::<G474>();
    let clock = clock::start(&rcc, &device.FLASH, &device.PWR);
    let a = device.GPIOA.split(&mut rcc);
    let b = device.GPIOB.split(&mut rcc);
    serial::start(device.USART2, a.pa2, a.pa3, clock, &mut rcc);
    if clock != clock::FULL {
        defmt::error!("no 24 MHz crystal: the control does not fit into its period");
        return None;
    }
    let compensator = joint::compensator()?;
    let drive = Drive::new(device.DAC1, a.pa4, b.pb0, compensator.limits().motor_torque, &mut rcc);
    let encoder = encoder::start(device.SPI1, (a.pa5, a.pa6, a.pa7), b.pb6, &mut rcc)?;
    TIM2::enable(&mut rcc);
    let board = Board::new(encoder, drive, restarted);
    Some(Parts { board, compensator, interrupts: core.NVIC })
}
