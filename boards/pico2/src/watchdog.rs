//! The watchdog, and whether it has reset the chip (RP2350 datasheet, 7.4, 8.5 and 12.9).
//!
//! It counts the ring oscillator, which the core does not need: where the crystal stops, and the core with it, the chip is reset.

use rp235x_pac::{PSM, TICKS, WATCHDOG, watchdog};
use strainwave_controller::Watchdog;

/// Periods of the ring oscillator in a tick: a microsecond at its nominal 11 MHz.
const TICK: u16 = 11;
/// Ticks of the countdown: 2 ms, which process, supply and temperature make 1 to 4 ms.
const COUNTS: u32 = 2000;

/// In a register that a reset by the watchdog keeps: the control had begun.
const BEGUN: u32 = 0x5354_5257;

/// The watchdog, which counts ticks.
pub enum Ticked {}

/// Has it tick, and reset all but the oscillators; whether it has reset the chip while the joint was controlled. Power, the reset pin and
/// a debugger do not count, nor does what has flashed the chip.
pub fn prepare(dog: &WATCHDOG, ticks: &TICKS, stages: &PSM) -> bool {
    // SAFETY: the field has 9 bits.
    ticks.tickwatchdog().cycles().write(|w| unsafe { w.proc0_cycles().bits(TICK) });
    ticks.tickwatchdog().ctrl().write(|w| w.enable().set_bit());
    // SAFETY: a bit for each stage of the start.
    stages.wdsel().write(|w| unsafe { w.bits(0x01ff_ffff) }.rosc().clear_bit().xosc().clear_bit());
    let reset = dog.reason().read().bits() != 0 && dog.scratch0().read().bits() == BEGUN;
    dog.scratch0().reset();
    reset
}

impl Watchdog for Ticked {
    fn start() {
        // SAFETY: the register keeps any word.
        registers().scratch0().write(|w| unsafe { w.bits(BEGUN) });
        Self::feed();
        // It goes on while a debugger has halted the core, too: the drive would keep its last torque.
        // SAFETY: only the enable is set.
        registers().ctrl().write(|w| unsafe { w.bits(0) }.enable().set_bit());
    }

    fn feed() {
        // SAFETY: the field has 24 bits.
        registers().load().write(|w| unsafe { w.bits(COUNTS) });
    }
}

fn registers() -> &'static watchdog::RegisterBlock {
    // SAFETY: `board` has prepared the peripheral and gives it up: from then on nothing else uses it.
    unsafe { &*WATCHDOG::ptr() }
}
