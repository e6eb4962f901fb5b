//! The board's parts put together.

use rp235x_pac::Peripherals;
use strainwave_controller::control::Parts;
use strainwave_controller::joint;

use crate::chip::Rp2350;
use crate::drive::Drive;
use crate::encoder::{self, Part};
use crate::{clock, pins, serial, watchdog};

/// The board as the control sees it.
pub type Board = strainwave_controller::Board<Rp2350, Part, Drive>;

/// Brings the board up; `None`, after saying why, when it is not fit to control a joint.
pub fn start() -> Option<Parts<Board>> {
    let device = Peripherals::take()?;
    let core = cortex_m::Peripherals::take()?;
    let full = clock::start(&device.CLOCKS, &device.XOSC, &device.PLL_SYS, &device.RESETS);
    let pins = pins::start(&device.IO_BANK0, &device.PADS_BANK0, &device.SIO);
    serial::start(&device.UART0);
    if !full {
        defmt::error!("no 12 MHz crystal: the control does not fit into its period");
        return None;
    }
    let restarted = watchdog::prepare(&device.WATCHDOG, &device.TICKS, &device.PSM);
    let compensator = joint::compensator()?;
    let drive = Drive::new(device.PWM, pins.enable, compensator.limits().motor_torque);
    let encoder = encoder::start(device.SPI0, pins.select)?;
    let board = Board::new(encoder, drive, restarted);
    Some(Parts { board, compensator, interrupts: core.NVIC })
}
