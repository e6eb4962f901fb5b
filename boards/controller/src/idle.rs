//! The idle loop: reports, and does what else there is to do: it plans the moves that an operator wants.

use strainwave_app::Log;
use strainwave_app::jog::{Jog, Planner};

use crate::lost;

/// Moves of the joint, which the idle loop plans for the control interrupt.
pub(crate) static JOG: Jog = Jog::new();

/// The planner of moves; `None`, after saying why, where none can be planned.
pub(crate) fn planner() -> Option<Planner> {
    let planner = Planner::new(&JOG);
    if planner.is_err() {
        defmt::error!("no moves can be planned with the joint's control period");
    }
    planner.ok()
}

/// Reports, and does the rest of the `work` in each period. Never returns: what ends the control is an interrupt.
pub(crate) fn run(mut log: Log, mut work: impl FnMut()) -> ! {
    let mut warned = false;
    loop {
        log.drain();
        work();
        if lost() && !warned {
            defmt::error!("motor encoder lost: the drive is released until the next reset");
            warned = true;
        }
        cortex_m::asm::wfi();
    }
}
