//! CMSDK watchdog: fires the non-maskable interrupt when the control misses its periods
//! (Arm DDI 0479, CMSDK APB watchdog).

use crate::register::Register;
use crate::timer::PERIOD;

/// Periods that the control may miss before the watchdog fires.
const PATIENCE: u32 = 5;

// SAFETY: the watchdog of this board is at 0x4000_8000; these are its registers.
const LOAD: Register = unsafe { Register::at(0x4000_8000) };
// SAFETY: as above.
const CONTROL: Register = unsafe { Register::at(0x4000_8008) };
// SAFETY: as above. A write clears the interrupt and reloads the counter.
const CLEAR: Register = unsafe { Register::at(0x4000_800c) };

const INTERRUPT_ENABLE: u32 = 1 << 0;

/// Starts the countdown.
pub fn start() {
    LOAD.write(PATIENCE * PERIOD);
    CONTROL.write(INTERRUPT_ENABLE);
}

/// Restarts the countdown.
pub fn feed() {
    CLEAR.write(1);
}

/// Stops the countdown: the control has ended as it should.
pub fn stop() {
    CONTROL.write(0);
}
