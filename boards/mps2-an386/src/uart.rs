//! CMSDK UART 0, transmit only: the telemetry (Arm DDI 0479, CMSDK APB UART).

use super::register::Register;

// SAFETY: UART 0 of this board is at 0x4000_4000; these are its registers.
const DATA: Register = unsafe { Register::at(0x4000_4000) };
// SAFETY: as above.
const STATE: Register = unsafe { Register::at(0x4000_4004) };
// SAFETY: as above.
const CONTROL: Register = unsafe { Register::at(0x4000_4008) };
// SAFETY: as above.
const DIVISOR: Register = unsafe { Register::at(0x4000_4010) };

const TRANSMIT_FULL: u32 = 1 << 0;
const TRANSMIT_ENABLE: u32 = 1 << 0;
/// The smallest divisor: 25 MHz / 16 = 1.5625 MBd.
const FASTEST: u32 = 16;

/// Switches the transmitter on.
pub fn enable() {
    DIVISOR.write(FASTEST);
    CONTROL.write(TRANSMIT_ENABLE);
}

/// Sends bytes, waiting for room for each.
pub fn send(bytes: &[u8]) {
    for byte in bytes {
        while STATE.read() & TRANSMIT_FULL != 0 {}
        DATA.write(u32::from(*byte));
    }
}
