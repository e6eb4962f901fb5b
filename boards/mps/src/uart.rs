//! CMSDK UART, transmit only: the telemetry (Arm DDI 0479, CMSDK APB UART).

use crate::Machine;
use crate::register::Register;

pub(crate) const DATA: usize = 0x0;
pub(crate) const STATE: usize = 0x4;
pub(crate) const CONTROL: usize = 0x8;
pub(crate) const DIVISOR: usize = 0x10;

pub(crate) const TRANSMIT_FULL: u32 = 1 << 0;
pub(crate) const TRANSMIT_ENABLE: u32 = 1 << 0;
/// The smallest divisor: a sixteenth of the peripherals' clock, in bits a second.
pub(crate) const FASTEST: u32 = 16;

/// A CMSDK UART.
#[derive(Clone, Copy, Debug)]
pub struct Uart {
    /// Address of its first register.
    pub address: usize,
}

fn register<M: Machine>(offset: usize) -> Register {
    // SAFETY: `Machine` promises a UART at the address, and the offsets are those of its registers.
    unsafe { Register::at(M::UART.address, offset) }
}

/// Switches the transmitter on.
pub fn enable<M: Machine>() {
    register::<M>(DIVISOR).write(FASTEST);
    register::<M>(CONTROL).write(TRANSMIT_ENABLE);
}

/// Sends bytes, waiting for room for each.
pub fn send<M: Machine>(bytes: &[u8]) {
    for byte in bytes {
        while register::<M>(STATE).read() & TRANSMIT_FULL != 0 {}
        register::<M>(DATA).write(u32::from(*byte));
    }
}
