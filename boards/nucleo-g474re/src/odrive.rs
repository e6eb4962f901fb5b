//! FDCAN2 on PB12 and PB13, with an ODrive at it.

use stm32g4xx_hal::pac::Peripherals;
use strainwave_controller::strainwave_app::Compensator;
use strainwave_controller::strainwave_app::commanded::{ODRIVE, Odrive};
use strainwave_stm32::fdcan::{Bus, FdCan, Filter};

use crate::can::{self, Can, set};

/// The peripheral.
pub enum Can2 {}

// SAFETY: its clock is that of FDCAN1, which `start` switches on first, from the crystal; nothing else uses it.
unsafe impl FdCan for Can2 {
    const ADDRESS: usize = 0x4000_6800;
    const MESSAGE_RAM: usize = 0x4000_a750;
    const FIFOS: usize = 1;
}

/// PB12 and PB13 in the registers of port B: their mode, and their function among the last eight pins, 9 is FDCAN2.
const PINS_AS_FUNCTION: (u32, u32) = (0b1111 << 24, 0b1010 << 24);
const FUNCTION: (u32, u32) = (0xff << 16, 0x99 << 16);

/// Joins both buses, as node `number` and in front of the drive; `None` where a peripheral does not answer.
pub fn start(number: u8, compensator: &Compensator) -> Option<(Bus<Can>, Odrive<Bus<Can2>>)> {
    let (bus, _) = can::start(number, compensator)?;
    // SAFETY: the board's start has let these pins go.
    let device = unsafe { Peripherals::steal() };
    // SAFETY: any function is allowed.
    device.GPIOB.afrh().modify(|old, w| unsafe { w.bits(set(old.bits(), FUNCTION)) });
    // SAFETY: any mode is allowed.
    device.GPIOB.moder().modify(|old, w| unsafe { w.bits(set(old.bits(), PINS_AS_FUNCTION)) });
    // The drive's heartbeat.
    let heartbeat = Filter { id: u16::from(ODRIVE) << 5 | 0x01, mask: 0x7ff, fifo: 0 };
    let drive = Odrive::new(ODRIVE, Bus::start([heartbeat])?, compensator)?;
    Some((bus, drive))
}
