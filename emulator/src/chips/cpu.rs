//! The core, around a fault of the emulator: an exception that comes in an IT block loses the block's state, so that after it all instructions of
//! the block are executed, whatever their condition. So none comes there: the core goes on to the block's end with its exceptions masked.
//!
//! Interrupts come between two runs of the core, or from its own timer, shortly before whose end it goes on by one instruction at a time;
//! the timer's first one, after it is switched on, no sooner than the end of that run.

use std::sync::Arc;

use rsemu::core::device::{Device, DeviceClass, RealizeCtx, ResetKind, SinkPin};
use rsemu::core::error::Result;
use rsemu::core::props::Props;
use rsemu::core::sched::{Budget, Consumed, TickCursor};
use rsemu::core::wire::WireId;
use rsemu::cpu::arm::v7m::{ArmV7m, Regs};
use rsemu::machine::realize::{BindCtx, Instance};

/// The state of an IT block in the program status.
const IT: u32 = 0x0600_fc00;
/// In the control of the core's timer: it counts, and interrupts.
const INTERRUPTS: u32 = 0b11;
/// Cycles before its end: more than an instruction takes.
const MARGIN: u64 = 64;

/// The core.
#[derive(Debug)]
pub struct Core(Arc<ArmV7m>);

impl Core {
    /// Of its properties.
    ///
    /// # Errors
    /// As [`ArmV7m::from_props`].
    pub fn from_props(props: &Props) -> Result<Self> {
        Ok(Self(Arc::new(ArmV7m::from_props(props)?)))
    }

    /// As the emulator has it.
    pub fn inner(&self) -> &Arc<ArmV7m> {
        &self.0
    }

    fn in_block(&self) -> bool {
        self.0.xpsr() & IT != 0
    }

    /// Goes on to the end of an IT block; cycles that it takes, of so many.
    fn past_block(&self, left: u64) -> u64 {
        let mask = |masks| self.0.set_regs(Regs { primask: masks, ..self.0.regs() });
        let (masked, mut used) = (self.0.regs().primask, 0);
        mask(true);
        while used < left && self.in_block() {
            used += self.0.run_budget(1);
        }
        mask(masked);
        used
    }

    /// Cycles that it may go on for at once, of so many.
    fn piece(&self, left: u64) -> u64 {
        let (control, count) = self.0.with_sys(|sys| (sys.syst_csr, u64::from(sys.syst_cvr)));
        if control & INTERRUPTS != INTERRUPTS { left } else { left.min(count.saturating_sub(MARGIN).max(1)) }
    }
}

impl Device for Core {
    fn class(&self) -> &'static DeviceClass {
        self.0.class()
    }

    fn realize(&self, context: &mut RealizeCtx<'_>) -> Result<()> {
        self.0.realize(context)
    }

    fn attach_cursor(&self, cursor: TickCursor) {
        Device::attach_cursor(&*self.0, cursor);
    }

    fn sink(&self, port: &str, sources: &[WireId]) -> Option<SinkPin> {
        self.0.sink(port, sources)
    }

    // A reset of the chip is one of the core with all that is in it: rsemu's warm one leaves its interrupts and its timer on.
    fn reset(&self, _kind: ResetKind) {
        self.0.reset(ResetKind::Cold);
    }

    fn is_runnable(&self) -> bool {
        true
    }

    fn run(&self, budget: Budget) -> Consumed {
        let mut left = budget.ticks;
        while left > 0 {
            if self.in_block() {
                left -= self.past_block(left);
                continue;
            }
            let piece = self.piece(left);
            let used = self.0.run_budget(piece);
            left -= used;
            if used < piece {
                break;
            }
        }
        Consumed::new(budget.ticks - left)
    }
}

impl Instance for Core {
    fn bind(&self, context: &BindCtx<'_>) -> Result<()> {
        self.0.bind(context)
    }
}
