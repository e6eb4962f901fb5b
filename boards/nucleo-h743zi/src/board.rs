//! The board's parts put together.

use crate::clock::{self, H743};
use crate::drive::Drive;
use crate::encoder::{self, Part};
use crate::{pins, serial};
use stm32h7::stm32h743v::Peripherals;
use strainwave_controller::control::Parts;
use strainwave_controller::joint;
use strainwave_stm32::reset;

/// The board as the control sees it.
pub type Board = strainwave_controller::Board<H743, Part, Drive>;

/// Brings the board up; `None`, after saying why, when it is not fit to control a joint.
pub fn start() -> Option<Parts<Board>> {
    let device = Peripherals::take()?;
    let mut core = cortex_m::Peripherals::take()?;
    // Without it each branch waits for the flash. The data cache stays off: all data is in memory that is coupled to the core.
    core.SCB.enable_icache();
    let restarted = reset::by_itself::<H743>();
    let clock = clock::start(&device.RCC, &device.FLASH, &device.PWR);
    clock::distribute(&device.RCC);
    pins::start(&device.GPIOA, &device.GPIOB, &device.GPIOD);
    serial::start(device.USART3, clock);
    if clock != clock::FULL {
        defmt::error!("no 8 MHz from the ST-LINK: the control does not fit into its period");
        return None;
    }
    let compensator = joint::compensator()?;
    let drive = Drive::new(device.DAC, device.GPIOB, compensator.limits().motor_torque);
    let encoder = encoder::start(device.SPI1, device.GPIOD)?;
    let board = Board::new(encoder, drive, restarted);
    Some(Parts { board, compensator, interrupts: core.NVIC })
}
