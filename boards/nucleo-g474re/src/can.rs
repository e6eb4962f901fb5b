//! FDCAN1 on PA11 and PA12.
//!
//! Through the registers: the HAL would take its bit times from the clock that it assumes.

use stm32g4xx_hal::pac::Peripherals;
use strainwave_controller::strainwave_app::Compensator;
use strainwave_controller::strainwave_app::commanded::Wired;
use strainwave_stm32::fdcan::{Bus, FdCan, Filter};

/// The peripheral.
pub enum Can {}

// SAFETY: `start` switches it on, from the crystal, which runs at `CLOCK`; nothing else uses it.
unsafe impl FdCan for Can {
    const ADDRESS: usize = 0x4000_6400;
    const MESSAGE_RAM: usize = 0x4000_a400;
}

/// PA11 and PA12 in the registers of port A: their mode, and their function among the last eight pins, 9 is FDCAN1.
const PINS_AS_FUNCTION: (u32, u32) = (0b1111 << 22, 0b1010 << 22);
const FUNCTION: (u32, u32) = (0xff << 12, 0x99 << 12);

/// The bits of a register with a field set.
pub fn set(old: u32, (mask, bits): (u32, u32)) -> u32 {
    old & !mask | bits
}

/// Joins the bus as node `number`, after the board's start; `None` where the peripheral does not answer. The control commands the drive itself.
pub fn start(number: u8, _compensator: &Compensator) -> Option<(Bus<Can>, Wired)> {
    // SAFETY: the board's start has let these pins go, and the clock control is no longer written by anything else.
    let device = unsafe { Peripherals::steal() };
    // SAFETY: any function is allowed.
    device.GPIOA.afrh().modify(|old, w| unsafe { w.bits(set(old.bits(), FUNCTION)) });
    // SAFETY: any mode is allowed.
    device.GPIOA.moder().modify(|old, w| unsafe { w.bits(set(old.bits(), PINS_AS_FUNCTION)) });
    device.RCC.ccipr().modify(|_, w| w.fdcansel().hse());
    device.RCC.apb1enr1().modify(|_, w| w.fdcanen().set_bit());
    // A peripheral answers two cycles after its clock is on.
    let _ = device.RCC.apb1enr1().read();
    let node = u16::from(number);
    let exactly = |id, fifo| Filter { id, mask: 0x7ff, fifo };
    let bus = Bus::start([
        // What commands the node, in its order: NMT, SYNC, both RPDOs.
        exactly(0x000, 0),
        exactly(0x080, 0),
        exactly(0x200 + node, 0),
        exactly(0x300 + node, 0),
        // SDO, and all heartbeats.
        exactly(0x600 + node, 1),
        Filter { id: 0x700, mask: 0x780, fifo: 1 },
    ]);
    Some((bus?, Wired))
}
