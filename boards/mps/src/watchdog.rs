//! CMSDK watchdog: fires the non-maskable interrupt when the control misses its periods
//! (Arm DDI 0479, CMSDK APB watchdog).

use crate::Machine;
use crate::register::Register;
use strainwave_app::control::RATE;

/// Periods that the control may miss before the watchdog fires.
const PATIENCE: u32 = 5;

const LOAD: usize = 0x0;
const CONTROL: usize = 0x8;
/// A write clears the interrupt and reloads the counter.
const CLEAR: usize = 0xc;

const INTERRUPT_ENABLE: u32 = 1 << 0;

/// A CMSDK watchdog.
#[derive(Clone, Copy, Debug)]
pub struct Watchdog {
    /// Address of its first register.
    pub address: usize,
    /// Its clock (Hz).
    pub clock: u32,
}

impl Watchdog {
    /// Clock cycles until it fires, rounded up: a slow clock's are longer than a control period.
    const fn count(&self) -> u32 {
        (PATIENCE * self.clock).div_ceil(RATE)
    }
}

fn register<M: Machine>(offset: usize) -> Register {
    // SAFETY: `Machine` promises a watchdog at the address, and the offsets are those of its registers.
    unsafe { Register::at(M::WATCHDOG.address, offset) }
}

/// Starts the countdown.
pub fn start<M: Machine>() {
    register::<M>(LOAD).write(const { M::WATCHDOG.count() });
    register::<M>(CONTROL).write(INTERRUPT_ENABLE);
}

/// Restarts the countdown.
pub fn feed<M: Machine>() {
    register::<M>(CLEAR).write(1);
}

/// Stops the countdown: the control has ended as it should.
pub fn stop<M: Machine>() {
    register::<M>(CONTROL).write(0);
}
