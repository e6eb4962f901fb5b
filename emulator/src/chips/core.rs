//! The core, with a fault of the emulator's mended: what it saves of the state of an IT block when an exception comes in its midst is nothing, so
//! that after the exception all instructions of the block are executed, whatever their condition.
//!
//! Interrupts come between two runs of the core, or from its own timer. In an IT block, and shortly before that timer's end, it therefore
//! goes on by one instruction at a time, and what the exception's frame lacks is put there.

use std::sync::Arc;

use rsemu::core::device::{Device, DeviceClass, RealizeCtx, ResetKind, SinkPin};
use rsemu::core::error::Result;
use rsemu::core::props::Props;
use rsemu::core::sched::{Budget, Consumed, TickCursor};
use rsemu::core::space::MemAttrs;
use rsemu::core::value::Width;
use rsemu::core::wire::WireId;
use rsemu::cpu::arm::v7m::ArmV7m;
use rsemu::machine::realize::{BindCtx, Instance};

/// The state of an IT block in the program status, and where an exception's frame has that.
const IT: u32 = 0x0600_fc00;
const STATUS: u32 = 28;
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

    /// Cycles that it may go on for at once, of so many.
    fn piece(&self, left: u64) -> u64 {
        if self.0.xpsr() & IT != 0 {
            return 1;
        }
        let (control, count) = self.0.with_sys(|sys| (sys.syst_csr, u64::from(sys.syst_cvr)));
        if control & INTERRUPTS != INTERRUPTS { left } else { left.min(count.saturating_sub(MARGIN).max(1)) }
    }

    /// Completes the frame of an exception that came in an IT block with this status.
    fn mend(&self, status: u32) {
        let entered = self.0.current_exception().0 != 0 && self.0.xpsr() & IT == 0;
        let frame =
            self.0.space().filter(|_| entered && u32::from(self.0.current_exception().0) != status & 0x1ff);
        let Some(memory) = frame else { return };
        let place = u64::from(self.0.msp() + STATUS);
        let Ok(saved) = memory.read(place, Width::U32, MemAttrs::DEBUG) else { return };
        // A stack that cannot be written has raised a fault of its own.
        let _ = memory.write(place, Width::U32, saved | u64::from(status & IT), MemAttrs::DEFAULT);
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

    fn reset(&self, kind: ResetKind) {
        self.0.reset(kind);
    }

    fn is_runnable(&self) -> bool {
        true
    }

    fn run(&self, budget: Budget) -> Consumed {
        let mut left = budget.ticks;
        while left > 0 {
            let (status, piece) = (self.0.xpsr(), self.piece(left));
            let used = self.0.run_budget(piece);
            if status & IT != 0 {
                self.mend(status);
            }
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
